"""What one log shows of itself without the other's motion: channels that never change, noise,
steps and range."""
from dataclasses import dataclass

import numpy as np

from ...experiment.block_measures import SUBMEAN_S
from ...experiment.signal_measures import MEDIAN_OF_SQUARE
from . import convention_findings, log_rests

# Standard error of a deviation taken from the median of squares of a standard normal, times the
# root of the number [Rousseeuw, Croux, J. Am. Stat. Assoc. 88 (1993)].
MEDIAN_SIGMA = 1.17
NEIGHBOURS = 0.87  # the same of one taken from white differences of neighbours: half of 3^0.5
SETTLING = 4.0  # times the usual power: five means of one noise differ by as much in 0.3 %
# Share of the liveliest channel's standard deviation: a channel that says nothing varies by less
# than DEAD, where the real one varies by more than ALIVE, five times as much.
DEAD, ALIVE = 0.03, 0.15
# Times its power at rest: on its way a channel that says nothing has that (SAME: the power of a
# hundred independent samples errs by 14 %), and what moves a robot moves its other channels by
# MORE.
SAME, MORE = 1.3, 10.0
CROOKED = 0.08  # of another axis, in a channel: twice a cross axis (hypotheses.SHAPE)
SHORTEST_MEAN = 2  # samples
FULL = 32767.0 / 32768.0  # of a limit: 32767 counts are as far as -32768
# Times as often as any value next to a limit a channel reads the limit: a sine, which slows down
# at its peaks, reads them 2.4 times as often (the roots of 1 and of 2 less 1).
OFTEN = 10
# Chance of noise to have a line in one channel of a rest; hertz below which what warms up or what
# settles has as much: of a rest of ten seconds the first four ordinates.
NO_LINE, SLOWEST_LINE_HZ = 1e-4, 0.5
# Chi squared of three axes that are as loud in an octave as below, in 99 of 100: what a filter
# takes away it takes from all of them.
FLAT = 11.3
STILL = 0.9  # of a log: what rests for longer, and does not turn besides, was not moved
DROWNED = 0.3  # of a count: noise below it hardly ever crosses one


@dataclass(frozen=True)
class Noise:
    """Of each axis (3,): density (unit per root Hz; two-sided: white noise of a sample over the
    root of the rate) and per_sample, the standard deviation of a sample, each with its relative
    standard error; moving: of what moves, which may shake it, so that it is this at most."""

    density: np.ndarray
    relative_sigma: float
    per_sample: np.ndarray
    sample_sigma: float
    moving: bool = False


def live(trace):
    """{sensor: (3,) bool}: channels that change at all."""
    channels = {"accel": np.ptp(trace.force, axis=0) > 0}
    channels["gyro"] = np.zeros(3, bool) if trace.rate is None else np.ptp(trace.rate, axis=0) > 0
    return channels


def dead(real, sim):
    """{sensor: (3,) bool}: channels of the simulator that hardly change where the real ones do,
    and no other does in their place: of what turns about one axis another one may answer."""
    channels = {"accel": np.zeros(3, bool), "gyro": np.zeros(3, bool)}
    for kind, name in (("accel", "force"), ("gyro", "rate")):
        if getattr(real, name) is None or getattr(sim, name) is None:
            continue
        still = [at_rest(x, getattr(x, name), x.quantum[kind == "gyro"]) for x in (real, sim)]
        ours, theirs = (getattr(x, name).var(axis=0) for x in (real, sim))
        # What the real one has at rest, too, is noise, which a simulator may lack; of what never
        # rests it is no more than what changes from row to row.
        quiet = still[0]
        if quiet is None:
            quiet = 0.5 * (np.diff(getattr(real, name), axis=0) ** 2).mean(axis=0)
        moved, moves = np.maximum(ours - quiet, 0.0), ours > SAME * quiet
        shares = [np.sqrt(x / max(x.max(), 1e-24)) for x in (moved, theirs)]
        alive = moves & (shares[0] > ALIVE), shares[1] > ALIVE
        if alive[0].sum() > alive[1].sum():
            channels[kind] |= alive[0] & (shares[1] < DEAD)
        if still[0] is not None and still[1] is not None:
            own = beyond_cross_axes(getattr(real, name)).var(axis=0)
            alive = own > MORE * np.maximum(*still), theirs > MORE * still[1]
            if alive[0].sum() > alive[1].sum():
                channels[kind] |= alive[0] & (theirs < SAME * still[1]) & alive[1].any()
    return channels


def beyond_cross_axes(values):
    """values (n, 3) without what each has of the others by how askew a sensor may be."""
    x = values - values.mean(axis=0)
    others = (np.delete(x, i, axis=1) for i in range(3))
    return np.stack([own - other @ np.clip(np.linalg.lstsq(other, own, rcond=None)[0], -CROOKED,
                                           CROOKED) for own, other in zip(x.T, others)], 1)


def constant_channels(real, sim):
    """({sensor: (3,) bool} of the simulator's channels that change and answer, [Convention] of
    those that do not)."""
    answer, findings = live(sim), []
    for kind, still in dead(real, sim).items():
        if still.any():
            axes = [a for a, x in zip("xyz", still) if x]
            findings.append(convention_findings.finding(
                "constant_channel", kind, 1.0, 100.0, "its %s says nothing of the motion" %
                " and ".join(axes), value=dict.fromkeys(axes, 0.0), unit="1"))
            answer[kind] = answer[kind] & ~still
    return answer, findings


def at_rest(trace, values, quantum):
    """(3,): power of values (n, 3) within the rests, a count's at least; None without a rest."""
    rests = [values[a:b] for a, b in trace.rests]
    if not rests:
        return None
    still = np.concatenate([x - x.mean(axis=0) for x in rests]).var(axis=0)
    return np.maximum(still, quantum ** 2 / 12.0)


def turns(trace):
    """Whether the gyro of a Trace reads more than it does at rest: what only drives does not turn.
    Where there is no rest nobody knows."""
    if trace.rate is None:
        return False
    still = at_rest(trace, trace.rate, trace.quantum[1])
    return still is None or bool((trace.rate.var(axis=0) > SAME * still).any())


def lies_still(trace):
    """Whether a Trace rests nearly all the time, and turns no more than its noise."""
    resting = sum(end - first for first, end in trace.rests)
    return resting > STILL * len(trace.t) and not turns(trace)


def noise(trace, values):
    """Noise of values (n, 3) at the Trace's rests; where there is none that is long enough, of the
    quick end of their spectrum, or None where that does not show it."""
    for parts in (1, 2, 4):  # of shorter means where the rests are too short for four others
        m = max(SHORTEST_MEAN, int(SUBMEAN_S * trace.rate_hz / parts))
        level = _level(trace, values, m)
        if level is not None:
            power, sigma = _as_far_as_flat(trace, values, m, *level[:2])
            return Noise(np.sqrt(power), sigma, np.sqrt(level[2].mean(axis=0) / 2.0),
                         NEIGHBOURS / np.sqrt(len(level[2])))
    known = log_rests.white(values[~trace.put_in])
    return None if known is None else Noise(
        known[0] / np.sqrt(trace.rate_hz), known[1], known[0], known[1], moving=True)


def _level(trace, values, m):
    """((3,) power of the density of values (n, 3) by means over m samples, the relative standard
    error of its root, squared differences of neighbouring samples (j, 3)) at the Trace's rests;
    None of fewer than four differences."""
    # A line leaks into plain means by as much as their noise, now more and now less.
    window = np.hanning(m + 2)[1:-1]
    window /= window.sum()
    squares, sample = _squares(trace, values, window)
    if len(squares) < 4:
        return None
    # By the median: in a part of a rest one axis may still be moved.
    power = np.median(squares, axis=0) / MEDIAN_OF_SQUARE / 2.0
    return (power / (window ** 2).sum() / trace.rate_hz,
            float(MEDIAN_SIGMA / np.sqrt(len(squares) / 1.5)), sample)


def _as_far_as_flat(trace, values, m, power, sigma):
    """(power, relative standard error) of _level() of means over m samples, sharpened by means
    over half as many and so on for as long as each octave is as loud as those below it: of the
    long ones a short rest has few. Where one is not, a filter begins, or what shakes the robot."""
    longest, low = sigma, np.log(np.maximum(power, 1e-300))
    while m > 1 and longest > log_rests.UNTOLD:
        m //= 2
        power, own, _ = _level(trace, values, m)
        octave = np.log(np.maximum(power, 1e-300))
        if 0.25 * ((octave - low) ** 2).sum() > FLAT * (sigma ** 2 + own ** 2):
            break
        share = own ** -2.0 / (own ** -2.0 + sigma ** -2.0)
        low, sigma = low + share * (octave - low), sigma * np.sqrt(1.0 - share)
    return np.exp(low), min(longest, float(np.hypot(sigma, log_rests.UNTOLD)))


def _squares(trace, values, window):
    """((k, 3) squared differences of neighbouring means of values (n, 3) over a window, (j, 3) of
    neighbouring samples) within the Trace's rests."""
    rests, m = [], len(window)
    for a, b in trace.rests:
        x = values[a:b]
        k = len(x) // m
        if k >= 2:
            quiet = without_line(x, trace.rate_hz)
            means = np.einsum("kmi,m->ki", quiet[:k * m].reshape(k, m, 3), window)
            rests.append((np.diff(means, axis=0) ** 2, np.diff(x, axis=0) ** 2))
    if len(rests) > 2:
        # A rest in which the robot still settles says nothing of the sensor's noise.
        level = [means.mean(axis=0).sum() for means, _ in rests]
        rests = [r for r, own in zip(rests, level) if own <= SETTLING * np.median(level)]
    return tuple(np.concatenate(x) for x in zip(*rests)) if rests else ([], [])


def without_line(x, rate_hz):
    """x (n, 3) of a rest without the line that a channel has: what swings steadily is no noise,
    and means of a quarter of a second have what is slower. A line is told by the largest ordinate
    of the spectrum beside the sum of all of them [Fisher, Proc. R. Soc. A 125 (1929) 54]."""
    t, x = np.arange(len(x)) / rate_hz, x - x.mean(axis=0)
    first = int(np.ceil(SLOWEST_LINE_HZ * len(x) / rate_hz))  # below, it may wander
    power = np.abs(np.fft.rfft(x, axis=0)[first:(len(x) + 1) // 2]) ** 2
    if len(power) < 2:
        return x
    share = 1.0 - (NO_LINE / len(power)) ** (1.0 / (len(power) - 1))
    for i in np.flatnonzero(power.max(axis=0) > share * power.sum(axis=0)):
        middle = (first + power[:, i].argmax()) * rate_hz / len(x)
        swings = [np.exp(2j * np.pi * hz * t) for hz in middle + np.linspace(
            -1.0, 1.0, 21) * rate_hz / len(x)]  # a line lies between two ordinates
        left = [left_of_swing(x[:, i], swing) for swing in swings]
        x[:, i] = min(left, key=lambda rest: float((rest ** 2).sum()))
    return x


def left_of_swing(x, swing):
    """x (n,) without what it has of the real and imaginary parts of swing (n,)."""
    both = np.stack([swing.real, swing.imag, np.ones(len(x))], 1)
    return x - both @ np.linalg.lstsq(both, x, rcond=None)[0]


def step(values, quantum):
    """(3,): the step of what was read, in the unit of values: the common divisor of its counts."""
    counts = np.round(values / quantum).astype(np.int64)
    counts = counts - counts[0]
    return np.gcd.reduce(np.abs(counts), axis=0) * quantum


def limit(x):
    """The value that a channel (n,) stops at, or None: the largest size, read so often that a
    peak of a smooth motion cannot be it."""
    size = np.abs(x)
    top = size.max()
    at = size >= FULL * top
    if at.all():
        return None  # what never changes does not stop there
    runs = at[1:] & at[:-1] & (np.sign(x[1:]) == np.sign(x[:-1]))
    if runs.sum() < 5 or top <= 0:
        return None
    # A log at rest repeats its largest reading by chance; then those next to it are as frequent.
    below = top - size[~at & (size > 0.99 * top)]
    next_to_it = np.bincount((below / ((1.0 - FULL) * top)).astype(int), minlength=1).max()
    stops = at.sum() > 3 * max(len(below), 1) or at.sum() > OFTEN * max(next_to_it, 1)
    return float(size[at].min()) if stops else None


def rounding(kind, logs, number, band_hz):
    """(number, 3) of as much noise as the rounding of both logs leaves in the band: two that were
    made of the same samples, and one that has no noise, which rounds what is slow the same way
    again and again, do not say that they agree any better."""
    power = sum((log.quantum[kind == "gyro"] or 0.0) ** 2 / 12.0 * (
        1.0 if silent(log, kind) else min(1.0, 2.0 * band_hz / log.rate_hz)) for log in logs)
    return np.sqrt(power) * np.random.default_rng(20200517).standard_normal((number, 3))


def silent(log, kind):
    """Whether a sensor's noise in a log hardly ever crosses a count."""
    noise, count = log.noise.get(kind), log.quantum[kind == "gyro"]
    return noise is not None and bool((noise.per_sample < DROWNED * count).all())
