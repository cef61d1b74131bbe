"""Layer two, what each log shows by itself: noise at rest, step, range and rate of the simulator
and of the real sensor side by side, and whether a sample was given the number of a density (or
the reverse)."""
import numpy as np

from .. import odds
from . import convention_findings, conventions, single_log
from .hypotheses import DEG
from .parameters import MG, Parameter, compared

# How far a noise that was set by hand may be off, natural logarithm: whoever reads a density off a
# data sheet, typical for the part's, is taken to be right to a fifth.
SETTING = 0.2
ANY = 2.0  # natural logarithm, of a noise that was set to anything: a factor of seven
# Probability from which on a noise is said to be the density's number. Less than elsewhere
# (convention_findings.CERTAIN), since it is said only where the densities differ anyhow.
LIKELY = 0.95
# Times its noise, a step in which noise is not told any more: the differences of neighbouring
# samples are then mostly 0 or a whole step. Noise below DROWNED of a step hardly ever crosses one.
COARSE, DROWNED = 1.5, 0.3
COARSER = 1.5  # times the other's step: registers differ by factors of two
RANGE_APART = 1.01  # times the other's: a range that differs; full scales are twofold apart


def noises(real, sim):
    """(Parameters of the noise densities, Conventions on the noise)."""
    numbers, findings = [], []
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
        silent = bool((b.per_sample < DROWNED * floor[1]).all())
        for i, axis in enumerate("xyz"):
            if not np.ptp(values[1][:, i]):
                continue  # a channel that says nothing is a convention
            if single_log.step(values[0], floor[0])[i] > COARSE * (
                    a if silent else b).per_sample[i] > 0:
                continue  # in steps that coarse the real one's noise does not show
            da, db = a.density[i] * scale, 0.0 if silent else b.density[i] * scale
            # Noise is known to a share of itself: it is the ratio that can be told from one.
            ratio = abs(np.log(max(da, 1e-12) / max(db, 1e-12)))
            numbers.append(compared(
                "noise_density", kind, axis, unit, da, da * a.relative_sigma, db,
                db * b.relative_sigma, apart=ratio / np.hypot(a.relative_sigma, b.relative_sigma)))
        if not silent and (a.per_sample > DROWNED * floor[0]).all() and (b.density > 0).all():
            findings += density_convention(kind, a, b, sim.rate_hz)
    return numbers, merged_noise(findings)


def density_convention(kind, real, sim, rate_hz):
    """Whether the ratio of the densities is that of a sample's noise to a density, hypothesis
    against hypothesis, the nameless one wide."""
    ratio = float(np.mean(np.log(sim.density / np.maximum(real.density, 1e-300))))
    sigma = float(np.hypot(np.hypot(real.relative_sigma, sim.relative_sigma) / np.sqrt(3.0),
                           SETTING))
    half = 0.5 * np.log(rate_hz)
    means = {"healthy": (0.0, sigma, conventions.PRIOR_HEALTHY),
             "too small": (-half, sigma, conventions.PRIOR_EACH),
             "too large": (half, sigma, conventions.PRIOR_EACH),
             "another": (0.0, ANY, conventions.PRIOR_NAMELESS)}
    logs = {n: np.log(p) - np.log(s) - 0.5 * ((ratio - m) / s) ** 2
            for n, (m, s, p) in means.items()}
    shares = odds.shares(logs)
    probability = sum(shares.get(n, 0.0) for n in ("too small", "too large"))
    if probability < LIKELY:
        return []
    factor, half_of_90 = float(np.exp(ratio)), odds.Z_90 * sigma
    return [convention_findings.finding(
        "noise_per_sample", kind, probability, logs["too small" if ratio < 0 else "too large"]
        - logs["healthy"], value={"factor": factor}, unit="1",
        interval_90={"factor": (factor * np.exp(-half_of_90), factor * np.exp(half_of_90))})]


def merged_noise(findings):
    """Both sensors at once are one finding, of the device."""
    if len(findings) < 2:
        return findings
    first = findings[0]
    return [convention_findings.finding(
        "noise_per_sample", "device", min(c.probability for c in findings),
        sum(c.nats for c in findings), value=first.value, unit="1",
        interval_90=first.interval_90)]


def registers(real, sim):
    """Step, range and rate."""
    numbers = []
    noises = {kind: noise.per_sample for kind, noise in real.noise.items() if noise is not None}
    for kind, name, index in (("accel", "force", 0), ("gyro", "rate", 1)):
        a, b = (getattr(x, name) for x in (real, sim))
        if a is None or b is None:
            continue
        scale = MG if kind == "accel" else DEG
        unit = "mg" if kind == "accel" else "°/s"
        for i, axis in enumerate("xyz"):
            steps = [float(single_log.step(v, x.quantum[index])[i]) * scale
                     for v, x in ((a, real), (b, sim))]
            if steps[0] > 0 and steps[1] > 0:
                coarse = steps[0] > COARSER * max(steps[1], real.quantum[index] * scale)
                # A simulator's may be its printed digits, which matter where noise does not
                # drown them.
                coarse |= steps[1] > COARSER * steps[0] and steps[1] > scale * (
                    noises[kind][i] if kind in noises else np.inf)
                numbers.append(Parameter("step", kind, axis, unit, steps[0], None, steps[1], None,
                                         steps[0] - steps[1], None, bool(coarse),
                                         steps[0] if coarse else None))
            numbers += ranges(kind, axis, unit, *(v[:, i] * scale for v in (a, b)))
    numbers.append(Parameter("rate", "device", "", "Hz", real.rate_hz, None, sim.rate_hz, None,
                             real.rate_hz - sim.rate_hz, None, False, None))
    return numbers


def ranges(kind, axis, unit, real, sim):
    """[Parameter] where one channel, real (n,) or sim (m,), stops and the other goes on."""
    ends = [float(np.abs(x).max()) for x in (real, sim)]
    stop, theirs = single_log.limit(real), single_log.limit(sim)
    if stop is not None and ends[1] > stop * RANGE_APART:
        return [Parameter("range", kind, axis, unit, stop, None, theirs, None, stop - ends[1],
                          None, True, stop)]
    if theirs is not None and ends[0] > theirs * RANGE_APART:
        # Where the real one would stop is not known: it goes as far as this at least.
        return [Parameter("range", kind, axis, unit, stop, None, theirs, None, ends[0] - theirs,
                          None, True, stop)]
    return []
