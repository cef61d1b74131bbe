"""How the samples of the rests are distributed: seconds or whole rests far louder than the others,
noise that grows or dies down from rest to rest, goes with the end of an axis that is up or is
another one in another session, and single samples far off their neighbours.

No effect of the library does that, and no touch does it often: it is said where, not what.
"""
import copy
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import special

from ...capture import registers
from .. import odds
from .detection import present
from .ringing import SETTLES_S
from .torn_reads import student

WINDOW_S = 0.5  # a touch or a step on the floor rings for less
LOUD = 9.0  # times the usual variance: three times as loud, which no touch is mistaken for
ROUNDING = 1.0 / 6.0  # counts²: of differences of readings that nothing but rounding moves
FEWEST_WINDOWS = 8  # of a session: four seconds at rest
FEWEST, FEWEST_RESTS = 4, 3  # windows, rests with one: a single event rings in one rest, or in two
FEWEST_SAMPLES = 64  # of a rest, whose noise is known to a tenth
GROWN = 1.5  # times as loud at one end of a session, or of an axis, as at the other
# Times the variance of the median rest that one has from its begin to its end: of 106 rests of the
# recordings one has 2.7 times, all others less than 1.5 times.
LOUDER_REST = 2.5
FEWEST_COMPARED = 10  # rests whose noise is compared


def loud(power, place):
    """(loud windows, rests with one, windows) of a session's windows()."""
    if not len(power):
        return 0, 0, 0
    usual = np.maximum(np.median(power, axis=0), ROUNDING)
    high = (power > LOUD * usual).any(axis=1)
    return int(high.sum()), len(np.unique(place[high])), len(high)


def windows(session, sensor):
    """((w, 3) counts², (w,) number of the rest) of a session's half seconds at rest, once the box
    has settled: the mean square of the differences from one sample to the next."""
    counts = getattr(session.capture, sensor)
    m = max(8, int(WINDOW_S * session.rate))
    settles = int(SETTLES_S * session.rate)
    power, place = [np.zeros((0, 3))], [np.zeros(0, int)]
    for number, (_, first, end) in enumerate(session.runs):
        x = np.diff(counts[first + settles:end].astype(float), axis=0)
        k = len(x) // m
        power.append((x[:k * m].reshape(k, m, 3) ** 2).mean(axis=1))
        place.append(np.full(k, number))
    return np.concatenate(power), np.concatenate(place)


def louder_rests(session, power, place):
    """(rests, rests louder than most, times as loud the loudest is, p of the most surely louder
    one) of a session's windows(), each rest by its median half second."""
    rests = [number for number in np.unique(place) if (place == number).sum() >= FEWEST]
    if len(rests) < FEWEST_COMPARED:
        return len(rests), 0, 1.0, 1.0
    level = np.array([np.median(power[place == number], axis=0) for number in rests])
    ratio = (level / np.maximum(np.median(level, axis=0), ROUNDING)).max(axis=1)
    # Of differences that share samples three are worth one.
    freedom = np.bincount(place)[rests] * WINDOW_S * session.rate / 3.0
    p = 3.0 * len(rests) * special.chdtrc(freedom, freedom * ratio / LOUDER_REST)
    return len(rests), int((ratio > LOUDER_REST).sum()), math.sqrt(ratio.max()), min(p.min(), 1.0)


def loudest(sessions, powers, sensor):
    """(times as loud, p, name of the loudest session, of the quietest) of the axis whose noise
    differs most between sessions, that of the same time, in the median half second; powers: those
    of the sessions' windows()."""
    levels = []
    for session, power in zip(sessions, powers):
        if len(power) < FEWEST_WINDOWS:
            return 1.0, 1.0, "", ""
        unit = registers.unit_of_count(session.capture.meta, sensor)
        levels.append(np.maximum(np.median(power, axis=0), ROUNDING) * unit ** 2 / session.rate)
    levels = np.array(levels)
    axis = int((levels.max(axis=0) / levels.min(axis=0)).argmax())
    high, low = levels[:, axis].argmax(), levels[:, axis].argmin()
    ratio = levels[high, axis] / levels[low, axis]
    freedom = FEWEST_WINDOWS * WINDOW_S * min(s.rate for s in sessions) / 3.0
    return (float(np.sqrt(ratio)), float(special.fdtrc(freedom, freedom, ratio / LOUD)),
            sessions[high].name, sessions[low].name)


SPIKE = 4.5  # standard deviations of a single sample off its neighbours, which agree
AGREE = 4.0  # standard deviations that the four neighbours may differ by
LEAST_SPIKES = 10  # knocks on a table come singly
# How heavy the tails of noise are, Student's t: rests of the recordings have 6 and more
# (`python -m tests.studies.robustness.tails`). Jumps: so many times the noise wide.
TAILS, WIDTHS = (5.0, 8.0, 15.0, 40.0, 200.0), (10.0, 30.0, 100.0, 1000.0)
SHARES = tuple(10.0 ** np.arange(-4.0, -0.9, 0.25))  # of samples that jump, tried
SCALES = tuple(np.arange(0.7, 1.31, 0.05))  # of the noise, about what its middle says
FINE = 50.0  # steps of the inverse hyperbolic sine in which sizes are counted
PASSES = 6  # of three side by side the one between is seen when the others are gone


@dataclass(frozen=True, eq=False)
class Spikes:
    """Single samples far off the two before and the two after in a session's rests: wild (N, 3),
    which they are; middle (N, 3) counts, what those beside them read; looked: samples looked at;
    sizes (n,): how far off all of those are whose neighbours agree, in standard deviations.
    Counts within a few steps of their neighbours never are wild."""

    wild: np.ndarray
    middle: np.ndarray
    looked: int
    sizes: np.ndarray

    @property
    def number(self):
        return int(self.wild.any(axis=1).sum())


def spikes(session, sensor, agreeing=4):
    """Spikes of one sensor of a session; agreeing: of the four samples beside one, those that have
    to agree."""
    counts, looked, sizes = getattr(session.capture, sensor), 0, [np.zeros(0)]
    wild, between = np.zeros(counts.shape, bool), np.array(counts, dtype=float)
    narrowest = registers.steps(counts)
    for _, first, end in session.runs:
        x = counts[first:end].astype(float)
        if len(x) < 20:
            continue
        beside = registers.beside(x)
        middle = np.median(beside, axis=0)
        off = np.abs(x[2:-2] - middle)
        sigma = np.maximum(_deviation(off), narrowest)
        agree = np.sort(np.abs(beside - middle), axis=0)[agreeing - 1] < AGREE * sigma
        wild[first + 2:end - 2] = (off > SPIKE * sigma) & agree
        between[first + 2:end - 2] = middle
        looked += len(off)
        sizes.append((off / sigma)[agree])
    return Spikes(wild, between, looked, np.concatenate(sizes))


def jump_nats(sizes):
    """Nats of some samples jumping over noise with tails alone, of how far samples are off, (n,)
    standard deviations: the likeliest tails and scale in either, what was tried paid."""
    if not len(sizes):
        return 0.0
    place, number = np.unique(np.rint(np.arcsinh(sizes) * FINE), return_counts=True)
    z, plain, jumping = np.sinh(place / FINE), [], []
    wide = [np.exp(-0.5 * (z / width) ** 2) / (width * np.sqrt(2.0 * np.pi)) for width in WIDTHS]
    for freedom in TAILS:
        for scale in SCALES:
            sound = student(z / scale, freedom) / scale
            plain.append(number @ np.log(sound))
            jumping += [number @ np.log((1.0 - share) * sound + share * jump)
                        for share in SHARES for jump in wide]
    return float(max(jumping) - max(plain) - np.log(len(SHARES) * len(WIDTHS)))


def _deviation(off):
    """(3,) standard deviation of which off (n, 3) are the sizes, few of them too large. A median
    of half counts is one itself, off by a quarter where noise is two wide; the mean is not."""
    widest = 4.0 * np.maximum(np.median(off, axis=0) / 0.6745, 1.0)
    return np.maximum(np.sqrt(0.5 * np.pi) * np.minimum(off, widest).mean(axis=0), 1.0)


def without_spikes(sessions, leaping=()):
    """(sessions, [(sensor, sentence, p)]): where single samples are far off more often than the
    tails of noise have them, they read as those beside them do. What is wild says nothing of where
    a rest lies, and as much as all others of a mean; of a few that is not worth a sentence.
    leaping: sensors whose counts leap anyhow."""
    sentences = []
    for sensor, words in registers.SENSORS.items():
        if sensor in leaping or any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        each = [spikes(s, sensor) for s in sessions]
        number, looked = sum(spiky.number for spiky in each), sum(spiky.looked for spiky in each)
        nats = jump_nats(np.concatenate([spiky.sizes for spiky in each]))
        if not number or not present(nats):
            continue
        sessions = [_put_right(s, sensor) for s in sessions]
        if number < LEAST_SPIKES:
            continue
        sentences.append((
            sensor, "%d of %d samples of the %s at rest are far off those before and after them: "
            "spikes" % (number, looked, words), odds.chance(nats)))
    return sessions, sentences


def _put_right(session, sensor):
    """The session without spikes, those included that others stand beside."""
    for _ in range(PASSES):
        spiky = spikes(session, sensor, 3)
        if not spiky.number:
            break
        session = _without(session, sensor, spiky)
    return session


def _without(session, sensor, spiky):
    capture = copy.copy(session.capture)
    counts = np.array(getattr(capture, sensor))
    counts[spiky.wild] = np.rint(spiky.middle[spiky.wild]).astype(counts.dtype)
    setattr(capture, sensor, counts)
    return session.of_capture(capture)


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
        level = 0.5 * np.log(np.maximum(power, ROUNDING))
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


def unsteady(sessions):
    """[(sensor, sentence, p)] of noise that comes in bursts, or changes from rest to rest or from
    session to session."""
    sentences = []
    for sensor, words in registers.SENSORS.items():
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        every = [windows(session, sensor) for session in sessions]
        sums = np.sum([loud(*one) for one in every], axis=0)
        if sums[0] >= FEWEST and sums[1] >= FEWEST_RESTS:
            m = max(8, int(WINDOW_S * sessions[0].rate))
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
        times, p, high, low = loudest(sessions, [power for power, _ in every], sensor)
        if present(-np.log(max(p, odds.SMALLEST))):
            sentences.append((
                sensor, "the noise of the %s in %s is %.2g times what it is in %s"
                % (words, Path(high).name, times, Path(low).name), p))
    return sentences
