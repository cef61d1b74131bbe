"""Layer two, what each log shows by itself: noise at rest, step, range and rate of the simulator
and of the real sensor side by side; and whether a sample was given the number of a density (or the
reverse)."""
from dataclasses import replace
from itertools import combinations

import numpy as np

from .. import odds
from . import convention_findings, conventions, single_log
from .parameters import MG, Parameter, compared
from .sensor_axes import DEG

# How far a noise that was set by hand may be off, natural logarithm: whoever reads a density off a
# data sheet, typical for the part's, is taken to be right to a fifth.
SETTING = 0.2
ANY = 2.0  # natural logarithm, of a noise that was set to anything: a factor of seven
# Natural logarithm, by which the axes of one chip differ in noise (0.05 to 0.5 were seen), and by
# which those differ that have one number, or each the real one's times one number: rounding, and
# what a motor adds at rest.
AXES, TYPED = 0.25, 0.05
# Probability from which on a noise is said to be the density's number. Less than elsewhere
# (convention_findings.CERTAIN), since it is said only where the densities differ anyhow.
LIKELY = 0.95
# Times its noise, a step in which noise is not told any more: the differences of neighbouring
# samples are then mostly 0 or a whole step.
COARSE = 1.5
COARSER = 1.5  # times the other's step: registers differ by factors of two
RANGE_APART = 1.01  # times the other's: a range that differs; full scales are twofold apart
PEAK = 5.0  # standard deviations of noise, that one in two million samples is from its mean


def noises(real, sim):
    """(Parameters of the noise densities, Conventions on the noise)."""
    numbers, findings, asked = [], [], 0
    for kind in ("accel", "gyro"):
        name = "force" if kind == "accel" else "rate"
        values = [getattr(x, name) for x in (real, sim)]
        if any(v is None for v in values):
            continue
        a, b = (x.noise[kind] for x in (real, sim))
        if a is None or b is None:
            continue
        scale = MG if kind == "accel" else DEG
        unit = "mg/√Hz" if kind == "accel" else "°/s/√Hz"
        floor = [x.quantum[0 if kind == "accel" else 1] for x in (real, sim)]
        silent = single_log.silent(sim, kind)
        # A channel that says nothing is a convention, and in steps that are coarse the noise of
        # either does not show.
        heard = np.ptp(values[1], axis=0) > 0
        for own, count, other in zip(values, floor, (a if silent else b, a)):
            heard &= (single_log.step(own, count) <= COARSE * other.per_sample) | (
                other.per_sample <= 0)
        heard = np.flatnonzero(heard)
        densities = a.density * scale, np.zeros(3) if silent else b.density * scale
        for i, apart in zip(heard, standard_errors_apart(
                a, b, *(np.maximum(x[heard], 1e-12) for x in densities))):
            da, db = (float(x[i]) for x in densities)
            found = in_factors(compared("noise_density", kind, "xyz"[i], unit, da,
                                        da * a.relative_sigma, db, db * b.relative_sigma,
                                        apart=apart), a.relative_sigma, b.relative_sigma)
            # To be set to what the real one has, however little is known of the simulator's.
            numbers.append(replace(found, set_to=found.real) if found.differs else found)
        drowned = (a.per_sample <= single_log.DROWNED * floor[0]).any() or silent
        if not drowned and not (a.moving or b.moving) and (
                np.minimum(b.density, b.per_sample) > 0).all():
            findings += density_convention(kind, a, b, sim.rate_hz)
            asked += 1
    return numbers, merged_noise(findings, asked)


def standard_errors_apart(real, sim, density, simulated):
    """(k,) by how many standard errors densities (k,) of two Noises differ. Noise is known to a
    share of itself: it is the ratio that can be told from one. Any of the axes may be louder, by
    one factor, as all are of another chip or range: the likeliest of these are so many off
    together, which none of them may be alone."""
    def at_most(ratios):  # of what moves it is known how much it is at most
        if real.moving != sim.moving:
            ratios = np.minimum(ratios, 0.0) if real.moving else np.maximum(ratios, 0.0)
        return np.abs(ratios) / np.hypot(real.relative_sigma, sim.relative_sigma)

    ratios = np.log(density / simulated)
    each = at_most(ratios)
    together = {some: float(at_most(ratios[list(some)].mean())) * np.sqrt(len(some))
                for number in range(1, len(ratios) + 1)
                for some in combinations(range(len(ratios)), number)}
    if together:
        likeliest = max(together, key=together.get)
        each[list(likeliest)] = np.maximum(each[list(likeliest)], together[likeliest])
    return each


def in_factors(found, real_sigma, sim_sigma):
    """A Parameter of noises that are known to such shares of themselves with intervals that end
    above nothing, of the difference by those of the two [Zou & Donner, Stat. Med. 27 (2008),
    1693, equations 9 and 10]."""
    ends = [tuple(x * np.exp(sign * odds.Z_90 * sigma) for sign in (-1.0, 1.0))
            for x, sigma in ((found.real, real_sigma), (found.simulated, sim_sigma))]
    (low, high), (least, most) = ends
    difference = found.real - found.simulated
    return replace(found, real_interval=ends[0], simulated_interval=ends[1], difference_interval=(
        float(difference - np.hypot(found.real - low, most - found.simulated)),
        float(difference + np.hypot(high - found.real, found.simulated - least))))


def density_convention(kind, real, sim, rate_hz):
    """Whether the ratio of the densities is that of a sample's noise to a density, hypothesis
    against hypothesis. The nameless one is wide, and as likely before: a noise set by hand, or
    that of another chip, whose axes are none of one number."""
    ratio = float(np.mean(np.log(sim.density / np.maximum(real.density, 1e-300))))
    sigma = float(np.hypot(np.hypot(real.relative_sigma, sim.relative_sigma) / np.sqrt(3.0),
                           SETTING))
    half = 0.5 * np.log(rate_hz)
    typed, chip = _axes_nats(real, sim)
    any_axes = np.logaddexp(typed, chip) - np.log(2.0)
    means = {"healthy": (0.0, sigma, conventions.PRIOR_HEALTHY, any_axes),
             "too small": (-half, sigma, conventions.PRIOR_EACH, typed),
             "too large": (half, sigma, conventions.PRIOR_EACH, typed),
             "another": (0.0, ANY, conventions.PRIOR_EACH, any_axes)}
    logs = {n: np.log(p) - np.log(s) - 0.5 * ((ratio - m) / s) ** 2 + axes
            for n, (m, s, p, axes) in means.items()}
    shares = odds.shares(logs)
    probability = sum(shares.get(n, 0.0) for n in ("too small", "too large"))
    if probability < 0.5:
        return []
    factor, half_of_90 = float(np.exp(ratio)), odds.Z_90 * sigma
    return [convention_findings.finding(
        "noise_per_sample", kind, probability, logs["too small" if ratio < 0 else "too large"]
        - logs["healthy"], value={"factor": factor}, unit="1",
        interval_90={"factor": (factor * np.exp(-half_of_90), factor * np.exp(half_of_90))})]


def _axes_nats(real, sim):
    """(nats of how a simulator's axes differ in noise where one number was set for all of them, or
    by which each is larger than the real one's; the same of any two chips)."""
    own, beside = np.log(sim.per_sample), np.log(sim.per_sample / real.per_sample)
    error2 = TYPED ** 2 + sim.sample_sigma ** 2

    def nats(values, variance):  # of two differences between three axes
        return -0.5 * ((values - values.mean()) ** 2).sum() / variance - np.log(variance)

    both = error2 + real.sample_sigma ** 2
    typed = np.logaddexp(nats(own, error2), nats(beside, both)) - np.log(2.0)
    return typed, nats(beside, both + AXES ** 2)


def merged_noise(findings, asked):
    """[Convention] of density_convention() of the sensors asked: at once they are one finding, of
    the device, and one says it of the other; of whoever takes a density for a sample's noise every
    second one is taken to do so in one of two sensors alone."""
    each = [c.probability / max(1.0 - c.probability, 1e-300) for c in findings]
    larger = [c.value["factor"] > 1.0 for c in findings]
    if len(findings) == 2 and larger[0] == larger[1]:
        first = findings[0]
        findings, each = [convention_findings.finding(
            "noise_per_sample", "device", 0.0, sum(c.nats for c in findings), value=first.value,
            unit="1", interval_90=first.interval_90)], [2.0 * each[0] * each[1]]
    told = [replace(c, probability=float(odd / ((2.0 if asked == 2 else 1.0) + odd)))
            for c, odd in zip(findings, each)]
    return [c for c in told if c.probability >= LIKELY]


def registers(real, sim):
    """Step, range and rate."""
    numbers = []
    noises = {kind: noise.per_sample for kind, noise in real.noise.items() if noise is not None}
    for kind, name, index in (("accel", "force", 0), ("gyro", "rate", 1)):
        a, b = (getattr(x, name) for x in (real, sim))
        if a is None or b is None:
            continue
        a, b = a[~real.put_in], b[~sim.put_in]
        scale = MG if kind == "accel" else DEG
        unit = "mg" if kind == "accel" else "°/s"
        for i, axis in enumerate("xyz"):
            steps = [float(single_log.step(v, x.quantum[index])[i]) * scale
                     for v, x in ((a, real), (b, sim))]
            if steps[0] > 0 and steps[1] > 0:
                coarse = steps[0] > COARSER * max(steps[1], real.quantum[index] * scale)
                # A simulator's may be its printed digits, and a chip's counts are finer than
                # most simulators': they matter where noise does not drown them.
                coarse |= max(steps) > COARSER * min(steps) and max(steps) > scale * (
                    noises[kind][i] if kind in noises else np.inf)
                numbers.append(Parameter("step", kind, axis, unit, steps[0], None, steps[1], None,
                                         steps[0] - steps[1], None, bool(coarse),
                                         steps[0] if coarse else None))
            numbers += ranges(kind, axis, unit, *(v[:, i] * scale for v in (a, b)), scale * sum(
                log.noise[kind].per_sample[i] for log in (real, sim) if log.noise[kind]))
    numbers.append(Parameter("rate", "device", "", "Hz", real.rate_hz, None, sim.rate_hz, None,
                             real.rate_hz - sim.rate_hz, None, False, None))
    return numbers


def ranges(kind, axis, unit, real, sim, noise=0.0):
    """[Parameter] where one channel, real (n,) or sim (m,), stops and the other goes on, by more
    than its noise."""
    ends = [float(np.abs(x).max()) for x in (real, sim)]
    stop, theirs = single_log.limit(real), single_log.limit(sim)
    if stop is not None and ends[1] > stop * RANGE_APART + PEAK * noise:
        return [Parameter("range", kind, axis, unit, stop, None, theirs, None, stop - ends[1],
                          None, True, stop)]
    if theirs is not None and ends[0] > theirs * RANGE_APART + PEAK * noise:
        # Where the real one would stop is not known: it goes as far as this at least.
        return [Parameter("range", kind, axis, unit, stop, None, theirs, None, ends[0] - theirs,
                          None, True, stop)]
    return []
