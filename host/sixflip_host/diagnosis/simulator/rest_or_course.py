"""Whether a sensor rests where its log is calm, or moves slowly: hypothesis against hypothesis.

What is calm beside the rest of a log need not rest: a boat is as calm on every crest, and a car
where it drives straight on. At rest the gyro's means over a quarter of a second are white noise of
any size about one level, beside flicker and a bias that drifts in a straight line; on its way they
follow a course, of which neighbouring means say nearly the same [Rasmussen & Williams, Gaussian
Processes for Machine Learning (2006), sections 2.2 and 4.2]. What a hand or a gait swings by is as
good as white in such means, but not between one sample and the next: a rest is white as far as it
is read, or a filter takes its quick end away, and then it is as loud as parts are. The
accelerometer has no say: what creeps in it alone is a fault of that sensor, and no motion.
"""
from functools import lru_cache

import numpy as np
from scipy import linalg

from ...experiment.block_measures import SUBMEAN_S
from ...experiment.noise_arrays import flicker_kernel
from .. import odds

# s that are judged at once; which may be begun or ended by a move that was cut too late; and to
# which what moves is cut at most, in search of a part that rests.
PIECE_S, EDGE_S, LEAST_PIECE_S = 8.0, 1.0, 1.0
PIECE_MEANS = 32  # means of a piece: of fewer rows a second it is longer
# deg/s of a course, from what no gyro's bias does within seconds to what swings; s for which it
# goes one way, from a step of a walk to a ship's roll.
COURSES_DPS, LASTS_S = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0), (0.5, 1.0, 2.0, 4.0)
# Of the flicker at rest, times what is usual of a chip (adequacy.usual): a gyro of which nobody
# wrote a data sheet has more.
FLICKERS = (1.0, 4.0, 16.0)
# deg/s per s of a bias that drifts: an ITG-3205's, 0.3 deg/s per degree [product specification
# rev. 1.0, table 3.1], of a board that warms up by a degree in ten seconds.
DRIFTS = 0.03
# Times the noise by the differences of neighbouring means, of which a course is a part.
WHITES = 2.0 ** np.arange(-6, 2)
LEVEL_DPS = 1e3  # of a bias: any
FEWEST = 4  # means that can show a course, and what swings
# deg/s per root Hz of a gyro's noise, and natural logarithms by which parts differ in it, a factor
# of three (0.005 of an MPU-6050, 0.03 of an ITG-3205 in their data sheets, 0.1 of a phone's), and
# what is set in simulators or shakes what stands, a factor of four.
DENSITY, PARTS, SET = 0.02, 1.1, 1.4
# Natural logarithm, by which the white noise by means differs from that by neighbouring samples:
# 1.0 to 1.25 times as much in power was measured at rest, 1.5 behind a filter near the end.
FLAT = 0.4
# deg/s per root Hz of what swings where a log is calm, its natural logarithm's standard deviation
# (0.2 to 3 were measured of hands, gaits and roads), and that of how many times as loud it may be
# in means as between samples.
SWINGS, SWAYS, SLOWER = 0.7, 1.2, np.log(30.0)


def resting(rate, runs, rate_hz, usual, quantum):
    """[(first, end)] of the parts of runs, spans of samples, in which the gyro's rate (n, 3)
    rests; usual: its flicker, quantum: of one count; all in deg/s."""
    @lru_cache(maxsize=None)
    def nats(first, end):
        """By which a span follows a course, or None where it is too short to."""
        length = max(1, round(SUBMEAN_S * rate_hz))
        number = (end - first) // length
        swings = swing_nats(rate[first:end], rate_hz, quantum)
        if number < FEWEST:
            moves = moving(swings)
            return moves if moves > odds.PRESENT else None
        means = rate[first:first + number * length].reshape(number, length, 3).mean(axis=1)
        return course_nats(means, length / rate_hz, usual, quantum, swings)

    def rests_in(span, prior=0.0):
        """[(first, end)] of what rests in a span, or None where it is too short to tell."""
        found = nats(*span)
        if found is not None and found + prior < odds.PRESENT:
            return [span]
        return found if found is None else _parts(span, rate_hz, nats, -odds.PRESENT - prior)

    whole = max(int(PIECE_S * rate_hz), PIECE_MEANS * max(1, round(SUBMEAN_S * rate_hz)))
    cut = [pieces(*run, whole) for run in runs]
    told = [(span, found) for spans in cut for span in spans
            for found in [rests_in(span)] if found is not None]
    # Where most of what is calm in a log moves, the rest of it is not taken to rest [Laplace's
    # rule of succession, a piece for a case].
    calm, still = (sum(end - first for first, end in spans) / whole for spans in (
        [span for span, _ in told], [part for _, found in told for part in found]))
    prior = max(0.0, float(np.log((calm - still + 1.0) / (still + 1.0))))
    kept = []
    for spans in cut:
        parts = [rests_in(span, prior) for span in spans]
        kept += joined([part for span, found in zip(spans, parts) for part in (
            ([] if prior else [span]) if found is None else found)])
    return kept


def _parts(span, rate_hz, nats, most):
    """[(first, end)] of the parts of a span that moves for which there are no more nats than
    `most`: without the ends, or else by halves."""
    first, end = span
    edge, least = int(EDGE_S * rate_hz), LEAST_PIECE_S * rate_hz
    middle = (first + end) // 2
    for part in ((first + edge, end), (first, end - edge), (first + edge, end - edge)):
        found = nats(*part) if part[1] - part[0] >= least else None
        if found is not None and found < most:
            return [part]
    if end - first < max(2 * least, 2 * FEWEST):
        return []
    parts = []
    for half in ((first, middle), (middle, end)):
        found = nats(*half)
        rests = found is not None and found < most
        parts += [half] if rests else _parts(half, rate_hz, nats, most)
    return parts


def pieces(first, end, length):
    """[(first, end)] of a span cut into equal ones of about so many samples."""
    cuts = np.linspace(first, end, max(1, round((end - first) / length)) + 1).astype(int)
    return list(zip(cuts[:-1].tolist(), cuts[1:].tolist()))


def joined(parts):
    """The spans, those that follow each other at once made one."""
    whole = []
    for first, end in parts:
        if whole and whole[-1][1] == first:
            first = whole.pop()[0]
        whole.append((first, end))
    return whole


def course_nats(means, seconds, usual, quantum, swings=-np.inf):
    """Nats by which means (k, 3) deg/s over so many seconds each follow a course about one axis or
    several, over a rest: of either the mean over what it may be, about each axis the white noise
    at its likeliest. swings (3,): swing_nats() of the same."""
    floor = max(quantum ** 2 / 12.0, 1e-12)
    # (axes, whites) of the white noise's variance
    white = np.maximum(0.5 * np.var(np.diff(means, axis=0), axis=0)[:, None] * WHITES, floor)
    logs = []
    for values, vectors in _kernels(len(means), round(seconds, 6), usual):
        seen = ((vectors.T @ means) ** 2).T[:, None]
        power = values + white[:, :, None]
        logs.append((-0.5 * (np.log(power) + seen / power).sum(axis=2)).max(axis=1))
    rest, course = (np.logaddexp.reduce(x, axis=0) - np.log(len(x)) for x in (
        logs[:len(FLICKERS)], logs[len(FLICKERS):]))
    return moving(np.logaddexp(course - rest, swings))


def moving(nats):
    """Nats over a rest, of three axes that turn by such nats (3,) each or do not: of the eight
    ways in which they may one is the rest."""
    turn = max(np.logaddexp(0.0, nats).sum(), odds.SMALLEST)
    return float(turn + np.log(-np.expm1(-turn)) - np.log(7.0))


def swing_nats(rate, rate_hz, quantum):
    """(3,) nats by which a span of a rate (n, 3) deg/s swings faster than its means show, over the
    noise of a rest: that is white from its means to neighbouring samples, or has lost its quick
    end and is as loud in its means as that of parts; what swings is as loud as hands are [all by
    how well so many means tell a variance: Wilson & Hilferty, PNAS 17 (1931), 684]."""
    length = max(1, min(round(SUBMEAN_S * rate_hz), len(rate) // FEWEST))
    number = len(rate) // length
    if length < 2 or number < FEWEST:
        return np.full(3, -np.inf)
    means = rate[:number * length].reshape(number, length, 3).mean(axis=1)
    floor = quantum ** 2 / 12.0 / rate_hz
    by_means, by_samples = (0.5 * np.log(np.maximum(0.5 * each * (np.diff(x, axis=0) ** 2).mean(
        axis=0) / rate_hz, floor)) for each, x in ((length, means), (1, rate)))
    known = 1.5 * 0.5 / number  # variance of such a logarithm: of differences, a third is lost

    def log(off, variance):
        return -0.5 * (off ** 2 / (variance + known) + np.log(2.0 * np.pi * (variance + known)))

    white = log(by_means - by_samples, FLAT ** 2) + log(by_samples - np.log(DENSITY), SET ** 2)
    filtered = log(by_means - np.log(DENSITY), PARTS ** 2) - np.log(SLOWER)
    swings = log(by_means - np.log(SWINGS), SWAYS ** 2) - np.log(SLOWER)
    return swings - np.logaddexp(white, filtered) + np.log(2.0)


@lru_cache(maxsize=64)
def _kernels(number, seconds, usual):
    """[(eigenvalues (n,), eigenvectors (n, n))] of the covariances of so many means, without their
    white noise: those of rests, by their flicker, then those of courses (Matern's of order 3/2,
    the least smooth that a turn rate can be)."""
    t = (np.arange(number) - 0.5 * (number - 1)) * seconds
    common = LEVEL_DPS ** 2 + DRIFTS ** 2 * np.outer(t, t)
    flicker = usual ** 2 * flicker_kernel(t, np.full(number, seconds))
    every = [common + times ** 2 * flicker for times in FLICKERS]
    for lasts in LASTS_S:
        x = np.sqrt(3.0) * np.abs(t[:, None] - t) / lasts
        every += [common + flicker + size ** 2 * (1.0 + x) * np.exp(-x) for size in COURSES_DPS]
    return [(np.maximum(values, 0.0), vectors) for values, vectors in map(linalg.eigh, every)]
