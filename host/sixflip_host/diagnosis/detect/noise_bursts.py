"""Noise that is not the same all the while: seconds or whole rests far louder than the others,
noise that grows or dies down from rest to rest, goes with the end of an axis that is up or is
another one in another session; and noise that two axes have in common.

No effect of the library does that, and no touch does it often: it is said where, not what.
"""
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import special

from ...capture import registers
from ...capture.rests import joined
from .. import odds
from . import louder_alone, noise_level
from .detection import present
from .ringing import LIFTS_S, SETTLES_S

WINDOW_S = 0.5  # a touch or a step on the floor rings for less
LOUD = 9.0  # times the usual variance: three times as loud, which no touch is mistaken for
ROUNDING = 1.0 / 6.0  # steps²: of differences of readings that nothing but rounding moves
BETWEEN_CODES = 0.5  # steps²: of a reading without noise that is as often the one as the other
FEWEST_WINDOWS = 8  # of a session: four seconds at rest
FEWEST, FEWEST_RESTS = 4, 3  # windows, rests with one: a single event rings in one rest, or in two
FEWEST_SAMPLES = 64  # of a rest, whose noise is known to a tenth
GROWN = 1.5  # times as loud at one end of a session, or of an axis, as at the other
# Times the variance of the median rest that one has from its begin to its end, and correlation of
# two axes from which on it is worth a word: half of either's noise. What rests of the recordings
# have of both prints `python -m tests.studies.robustness.tails`.
LOUDER_REST, SHARED = 2.5, 0.5
FEWEST_CORRELATED = 24  # half seconds
FEWEST_COMPARED = 10  # rests whose noise is compared


def loud(power, place, step):
    """(loud windows, rests with one, windows) of a session's windows(), whose counts lie on steps
    (3,)."""
    if not len(power):
        return 0, 0, 0
    usual = np.maximum(np.median(power, axis=0), ROUNDING * step ** 2)
    high = (power > LOUD * usual).any(axis=1)
    return int(high.sum()), len(np.unique(place[high])), len(high)


def window(session):
    """Samples of half a second."""
    return max(8, int(WINDOW_S * session.rate))


def windows(session, sensor):
    """((w, 3) counts², (w,) number of the rest, (w,) first sample) of a session's half seconds at
    rest, once the box has settled and before a hand takes it up: the mean square of the
    differences from one sample to the next. Where nobody labelled the poses of a box that was
    turned over, those are at rest as well in which it is only louder; a vehicle may move without
    a turn. Where one sensor alone is louder, nothing moves."""
    counts = getattr(session.capture, sensor)
    m = window(session)
    settles, lifts = (int(seconds * session.rate) for seconds in (SETTLES_S, LIFTS_S))
    power, place, begins = [np.zeros((0, 3))], [np.zeros(0, int)], [np.zeros(0, int)]
    runs = session.runs
    if not session.labelled and session.turned_over:
        runs = joined(session.capture, runs)
    for number, (_, first, end) in enumerate(runs):
        settled = first + settles
        x = np.diff(counts[settled:max(settled, end - lifts)].astype(float), axis=0)
        k = len(x) // m
        power.append((x[:k * m].reshape(k, m, 3) ** 2).mean(axis=1))
        place.append(np.full(k, number))
        begins.append(settled + m * np.arange(k))
    alone = louder_alone.windows(session, runs, sensor, m + 1)
    x = np.diff(counts[alone[:, :1] + np.arange(m + 1)].astype(float), axis=1)
    return (np.concatenate([*power, (x ** 2).mean(axis=1)]),
            np.concatenate([*place, alone[:, 1]]), np.concatenate([*begins, alone[:, 0]]))


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


def correlations(sessions, but=()):
    """([(sensor, axis letter)], (k, k) correlations of their noise in the median half second, how
    many samples they are of) of all Sessions, but of some sensors: a knock, or a hand that takes
    the box away, is not in the median."""
    names = [(sensor, axis) for sensor in registers.SENSORS for axis in "xyz" if sensor not in but
             and all(getattr(s.capture, sensor) is not None for s in sessions)]
    found = [_by_window(s, names, *run[1:]) for s in sessions for run in s.runs if names]
    every = np.concatenate(found) if found else np.zeros((0, 0, 0))
    if len(every) < FEWEST_CORRELATED:
        return [], np.zeros((0, 0)), 0
    return names, np.median(every, axis=0), len(every) * WINDOW_S * min(s.rate for s in sessions)


def in_common(sessions, but=()):
    """[sentence] of the two axes whose noise has most in common, more than SHARED: a supply or a
    reference that both are on. Of the usual size noise may have any shape, so it is no gap."""
    names, median, number = correlations(sessions, but)
    if not names:
        return []
    pairs = list(itertools.combinations(range(len(names)), 2))
    first, second = max(pairs, key=lambda pair: abs(median[pair]))
    size = min(abs(float(median[first, second])), 1.0 - 1e-9)
    # Fisher's z, with as many samples' worth as in louder_rests.
    z = (math.atanh(size) - math.atanh(SHARED)) * math.sqrt(number / 3.0 / (0.5 * math.pi))
    p = min(1.0, len(pairs) * 2.0 * float(special.ndtr(-z)))
    if not present(-np.log(max(p, odds.SMALLEST))):
        return []
    return ["the noise of the %s axis of the %s and of the %s axis of the %s goes together: a "
            "correlation of %.2g" % (names[first][1], registers.SENSORS[names[first][0]],
                                     names[second][1], registers.SENSORS[names[second][0]],
                                     median[first, second])]


def _by_window(session, names, first, end):
    """(w, k, k) correlations of what the axes of a rest change by from sample to sample in its
    half seconds, 0 of those that never change."""
    begin, m = first + int(SETTLES_S * session.rate), max(8, int(WINDOW_S * session.rate))
    steps = np.diff(np.stack([getattr(session.capture, sensor)[begin:end, "xyz".index(axis)]
                              for sensor, axis in names], 1).astype(float), axis=0)
    steps = steps[:len(steps) // m * m].reshape(-1, m, len(names))
    size = np.sqrt((steps ** 2).mean(axis=1, keepdims=True))
    steps = steps / np.where(size > 0.0, size, 1.0)
    return steps.transpose(0, 2, 1) @ steps / m


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
    if session.capture.accel is not None:
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


def comes_and_goes(sessions, measured):
    """(times as loud, p) of the gyro's noise that comes and goes at rest, where that of the
    accelerometer does not: what shakes a box shakes both. A floor that shakes may move the
    accelerometer alone, so that nothing follows from its noise, nor from a gyro's alone.
    measured: {sensor: of each session its windows() with the steps that its counts lie on}."""
    if "accel" not in measured:
        return 1.0, 1.0
    found = {}
    for sensor, of_sessions in measured.items():
        every = [noise_level.changes(power, first, window(session), BETWEEN_CODES * step ** 2)
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
