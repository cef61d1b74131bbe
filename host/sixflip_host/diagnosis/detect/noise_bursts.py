"""Noise that is not the same all the while: seconds or whole rests far louder than the others,
noise that grows or dies down from rest to rest, goes with the end of an axis that is up or is
another one in another session; and noise whose level changes from second to second of one rest.

No effect of the library does that, and no touch does it often: it is said where, not what.
"""
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import special

from ...capture import registers
from .. import odds
from .detection import present
from .rest_parts import WINDOW_S, window, windows

LOUD = 9.0  # times the usual variance: three times as loud, which no touch is mistaken for
ROUNDING = 1.0 / 6.0  # steps²: of differences of readings that nothing but rounding moves
BETWEEN_CODES = 0.5  # steps²: of a reading without noise that is as often the one as the other
FEWEST_WINDOWS = 8  # of a session: four seconds at rest
FEWEST, FEWEST_RESTS = 4, 3  # windows, rests with one: a single event rings in one rest, or in two
FEWEST_SAMPLES = 64  # of a rest, whose noise is known to a tenth
GROWN = 1.5  # times as loud at one end of a session, or of an axis, as at the other
# Times the variance of the median rest that one has from its begin to its end. What rests of the
# recordings have prints `python -m tests.studies.robustness.tails`.
LOUDER_REST = 2.5
FEWEST_COMPARED = 10  # rests whose noise is compared
# Windows of a chain, in which each is at most so many lengths after the one before: what changes
# from one chain to the next may be the place that the box was put down on. In fewer windows than
# that, ten seconds, the correlation is not normal so far out as it is judged.
LONGEST_GAP, FEWEST_CHAINED = 4.0, 20


def loud(power, place, step):
    """(loud windows, rests with one, windows) of a session's windows(), whose counts lie on steps
    (3,)."""
    if not len(power):
        return 0, 0, 0
    usual = np.maximum(np.median(power, axis=0), ROUNDING * step ** 2)
    high = (power > LOUD * usual).any(axis=1)
    return int(high.sum()), len(np.unique(place[high])), len(high)


def of_rests(power, place, step):
    """((r,) numbers of the rests, (r,) times the variance of the median rest that the loudest axis
    of each has) of a session's windows(), whose counts lie on steps (3,), each rest by its median
    half second."""
    rests = np.array([number for number in np.unique(place) if (place == number).sum() >= FEWEST],
                     dtype=int)
    if not len(rests):
        return rests, np.zeros(0)
    level = np.array([np.median(power[place == number], axis=0) for number in rests])
    usual = np.maximum(np.median(level, axis=0), BETWEEN_CODES * step ** 2)
    return rests, (level / usual).max(axis=1)


def louder_rests(session, power, place, step):
    """(rests, rests louder than most, times as loud the loudest is, p of the most surely louder
    one) of a session's windows(), whose counts lie on steps (3,)."""
    rests, ratio = of_rests(power, place, step)
    if len(rests) < FEWEST_COMPARED:
        return len(rests), 0, 1.0, 1.0
    # Of differences that share samples three are worth one; a median is less well known than a
    # mean.
    freedom = np.bincount(place)[rests] * WINDOW_S * session.rate / 3.0 / (0.5 * math.pi)
    p = 3.0 * len(rests) * special.chdtrc(freedom, freedom * ratio / LOUDER_REST)
    return len(rests), int((ratio > LOUDER_REST).sum()), math.sqrt(ratio.max()), min(p.min(), 1.0)


def loudest(sessions, every, sensor):
    """(times as loud, p, name of the loudest session, of the quietest) of the axis whose noise
    differs most between sessions, that of the same time, in the median half second; every: the
    sessions' windows() with the steps (3,) that their counts lie on."""
    levels = []
    for session, (power, _, step) in zip(sessions, every):
        if len(power) < FEWEST_WINDOWS:
            return 1.0, 1.0, "", ""
        unit = registers.unit_of_count(session.capture.meta, sensor)
        level = np.maximum(np.median(power, axis=0), BETWEEN_CODES * step ** 2)
        levels.append(level * unit ** 2 / session.rate)
    levels = np.array(levels)
    axis = int((levels.max(axis=0) / levels.min(axis=0)).argmax())
    high, low = levels[:, axis].argmax(), levels[:, axis].argmin()
    ratio = levels[high, axis] / levels[low, axis]
    freedom = FEWEST_WINDOWS * WINDOW_S * min(s.rate for s in sessions) / 3.0
    return (float(np.sqrt(ratio)), float(special.fdtrc(freedom, freedom, ratio / LOUD)),
            sessions[high].name, sessions[low].name)


@dataclass(frozen=True)
class Following:
    """What the noise of a session's rests goes with: variable, "time" or the axis that points up;
    times as loud at the one end of it as at the other; p of that in noise that is the same."""

    variable: str = "time"
    times: float = 1.0
    p: float = 1.0

    def words(self, sensor):
        """A sentence of a sensor, in words."""
        if self.variable == "time":
            return ("the noise of the %s at the end of a session is %.2g times what it was at its "
                    "begin" % (sensor, self.times))
        return "the noise of the %s with %s up is %.2g times what it is with %s down" % (
            sensor, self.variable, self.times, self.variable)


def following(session, sensor):
    """Following of the axis and the variable that say most: the noise of its rests against their
    order or against an axis' share of gravity, which a loud one does not change by much [Kendall,
    Biometrika 30 (1938) 81; Theil-Sen]. What shakes the surroundings is felt along the vertical,
    whichever end of an axis is up."""
    counts, best = getattr(session.capture, sensor), Following()
    step = registers.steps(counts)
    rests = [(first, end) for _, first, end in session.runs if end - first >= FEWEST_SAMPLES]
    if len(rests) < FEWEST_COMPARED:
        return best
    variables = {"time": np.array([session.t_s[first] for first, _ in rests])}
    # What is worn or driven stands in one pose where nothing shakes it, and in others where it
    # goes on: only what somebody puts down is as still in all of them.
    if session.capture.accel is not None and session.labelled:
        up = np.array([session.capture.accel[first:end].mean(axis=0) for first, end in rests])
        variables |= dict(zip("xyz", (up / session.capture.meta["accel_lsb_per_g"]).T))
    for axis in range(3):
        power = np.array([(np.diff(counts[first:end, axis].astype(float)) ** 2).mean()
                          for first, end in rests])
        level = 0.5 * np.log(np.maximum(power, BETWEEN_CODES * step[axis] ** 2))
        for name, value in variables.items():
            if not np.ptp(value):
                continue
            times = math.exp(_slope(value, level) * np.ptp(value))
            if max(times, 1.0 / times) <= GROWN:
                continue
            from scipy.stats import kendalltau  # it takes a second to import
            p = min(1.0, 3.0 * len(variables) * float(kendalltau(value, level).pvalue))
            if p < best.p:
                best = Following(name, times, p)
    return best


def _slope(x, y):
    """Median of the slopes of all pairs of points x, y (n,): Theil and Sen's."""
    first, second = np.triu_indices(len(x), 1)
    across = x[second] - x[first]
    apart = across != 0.0
    return float(np.median((y[second] - y[first])[apart] / across[apart]))


def level_changes(power, first, length, least):
    """(times as loud in the louder quarter as in the softer one, p of that by steady noise) of the
    axis that says most; power (w, 3) counts² of windows of `length` samples from `first` (w,) on,
    of which less than least (3,) counts² tells how near the mean is to the edge of a code.

    Steady noise has half seconds that are louder and softer by chance, each by itself (two lines
    that beat have not, and are found before). Where the level changes, a loud one is beside a loud
    one: the correlation of the ranks of neighbours is what chance does not make [Wald &
    Wolfowitz, Ann. Math. Stat. 14 (1943) 378]."""
    order = np.argsort(first)
    power, first = power[order], first[order]
    chains = np.split(np.arange(len(first)),
                      1 + np.flatnonzero(np.diff(first) > LONGEST_GAP * length))
    chains = [chain for chain in chains if len(chain) >= FEWEST_CHAINED]
    if not chains:
        return 1.0, 1.0
    from scipy import stats  # it takes a second to import
    found = []
    for axis in range(3):
        level = [np.log(np.maximum(power[chain, axis], least[axis])) for chain in chains]
        level = [x - np.median(x) for x in level]
        every = np.concatenate(level)
        score = special.ndtri((stats.rankdata(every) - 0.5) / len(every))
        score = np.split(score, np.cumsum([len(x) for x in level])[:-1])
        pairs = sum(len(x) - 1 for x in score)
        together = sum(float(x[1:] @ x[:-1]) for x in score) / pairs
        p = 3.0 * float(special.ndtr(-together * math.sqrt(pairs)))
        # What neighbours have in common is the level's.
        spread = np.subtract(*np.quantile(every, [0.75, 0.25])) * math.sqrt(max(together, 0.0))
        found.append((math.exp(0.5 * spread), min(p, 1.0)))
    return min(found, key=lambda one: one[1])


def comes_and_goes(sessions, measured):
    """(times as loud, p) of the gyro's noise that comes and goes at rest, where that of the
    accelerometer does not: what shakes a box shakes both. A floor that shakes may move the
    accelerometer alone, so that nothing follows from its noise, nor from a gyro's alone.
    measured: {sensor: of each session its windows() with the steps that its counts lie on}."""
    if "accel" not in measured:
        return 1.0, 1.0
    found = {}
    for sensor, of_sessions in measured.items():
        every = [level_changes(power, first, window(session), BETWEEN_CODES * step ** 2)
                 for session, (power, _, first, step) in zip(sessions, of_sessions)]
        times, p = min(every, key=lambda one: one[1])
        found[sensor] = times, min(1.0, p * len(sessions))
    both = present(-np.log(max(found["accel"][1], odds.SMALLEST)))
    return (1.0, 1.0) if both else found["gyro"]


def unsteady(sessions):
    """[(sensor, sentence, p)] of noise that comes in bursts, or changes from rest to rest or from
    session to session."""
    sentences = []
    measured = {sensor: [(*windows(s, sensor), registers.steps(getattr(s.capture, sensor)))
                         for s in sessions] for sensor in registers.SENSORS
                if all(getattr(s.capture, sensor) is not None for s in sessions)}
    for sensor, of_sessions in measured.items():
        words = registers.SENSORS[sensor]
        every = [(power, place, step) for power, place, _, step in of_sessions]
        sums = np.sum([loud(*one) for one in every], axis=0)
        if sums[0] >= FEWEST and sums[1] >= FEWEST_RESTS:
            m = window(sessions[0])
            chance = 3.0 * special.chdtrc(m / 2.0, LOUD * m / 2.0)  # differences share samples
            sentences.append((
                sensor, "the %s is far louder in %d of %d half seconds at rest: noise that comes "
                "in bursts" % (words, sums[0], sums[2]),
                float(special.bdtrc(sums[0] - 1, sums[2], min(chance, 1.0)))))
            continue
        follows = min((following(s, sensor) for s in sessions), key=lambda one: one.p)
        p = follows.p * len(sessions)
        if present(-np.log(max(p, odds.SMALLEST))):
            sentences.append((sensor, follows.words(words), p))
            continue
        of_rests = min((louder_rests(s, *one) for s, one in zip(sessions, every)),
                       key=lambda found: found[-1])
        number, louder, times, p = of_rests
        p = min(1.0, p * len(sessions))
        if present(-np.log(max(p, odds.SMALLEST))):
            sentences.append((sensor, "the noise of the %s in %d of %d rests is up to %.2g times "
                              "what it is in the others" % (words, louder, number, times), p))
            continue
        times, p = comes_and_goes(sessions, measured) if sensor == "gyro" else (1.0, 1.0)
        if times > GROWN and present(-np.log(max(p, odds.SMALLEST))):
            sentences.append((
                sensor, "the noise of the %s comes and goes at rest: for a quarter of the time it "
                "is %.2g times what it is for another" % (words, times), p))
            continue
        times, p, high, low = loudest(sessions, every, sensor)
        if present(-np.log(max(p, odds.SMALLEST))):
            sentences.append((
                sensor, "the noise of the %s in %s is %.2g times what it is in %s"
                % (words, Path(high).name, times, Path(low).name), p))
    return sentences
