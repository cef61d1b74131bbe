"""Noise at rest that is not normal: pulses that come again, a skew, far heavier tails than a
sensor's noise has, and the lines that give way to them; and noise that two axes have in common.
No effect of the library does that: it is said where, not what.

Of each piece of a rest, less a slow course: how large the mean square is beside what the middle
half of the samples says, and their skewness. Both are those of the median piece, so that knocks on
a table are nothing. The readings are spread over the step that they were rounded to.
"""
import itertools
import math

import numpy as np
from numpy.polynomial import legendre
from scipy import special

from ...capture import registers
from .. import odds
from . import spectral_lines
from .detection import odd_axes, present
from .rest_parts import LIFTS_S, SETTLES_S, WINDOW_S, window

PIECE_S, LEAST_S = 8.0, 2.0  # of a rest: a slow pulse is in each
SAMPLES = 40  # of a piece, at least: of ten, normal noise has 1.14 times what its middle half says
COURSE = 3  # degree of what is taken off a piece, which settles or fades
# Of a step: narrower noise is mostly of one code, and of one of its neighbours. The error of
# rounding is noise itself from there on [Widrow & Kollar, Quantization Noise (2008)].
DITHERED = 0.5
FEWEST = 8  # pieces
QUARTILES = float(np.ptp(special.ndtri([0.25, 0.75])))  # apart, of a standard deviation of 1
# Variances over the normal one of the same middle half, and skewness, that noise may have: in the
# recordings up to 1.17 and 0.07 (`python -m tests.studies.robustness.tails`), by Laplace's
# distribution 1.9, by the exponential one 2.
HEAVY, SKEW = 1.4, 0.5
MORE = 2.0  # times what is known: what shakes an axis in turns is beyond its middle half, too
TESTS = 24  # of 6 axes, both ways of a skew and of the size
# Correlation of two axes from which on it is worth a word: half of either's noise. What rests of
# the recordings have of it prints `python -m tests.studies.robustness.tails`.
SHARED = 0.5
FEWEST_CORRELATED = 24  # half seconds
OWN_SHAPE = {"torn_reads", "dead_band", "saturation"}  # what makes samples anything but normal


def shapes(session, sensor):
    """((p, 3) mean squares over those that the middle half says, (p, 3) skewness, (p, 3) counts²
    beyond what the middle half says) of the pieces of the rests of a sensor."""
    counts, found = getattr(session.capture, sensor), []
    spread = np.random.default_rng(20261127)
    step = np.array([max(1, int(np.gcd.reduce(np.diff(registers.codes(column)))))
                     for column in counts.T])
    for run in session.runs:
        first = run.first + int(SETTLES_S * session.rate)
        rest = counts[first:max(first, run.end - int(LIFTS_S * session.rate))].astype(float)
        if len(rest) < max(LEAST_S * session.rate, SAMPLES):
            continue
        number = max(1, round(len(rest) / max(PIECE_S * session.rate, SAMPLES)))
        for x in np.array_split(rest, number):
            x = _without_course(x)
            narrow = (x ** 2).mean(axis=0) < (DITHERED ** 2 + 1.0 / 12.0) * step ** 2
            x = x + (spread.random(x.shape) - 0.5) * step
            square = (x ** 2).mean(axis=0)
            middle = (np.subtract(*np.quantile(x, [0.75, 0.25], axis=0)) / QUARTILES) ** 2
            shape = np.array([square / middle, (x ** 3).mean(axis=0) / square ** 1.5,
                              square - middle])
            found.append(np.where(narrow, [[1.0], [0.0], [0.0]], shape))
    return np.array(found).reshape(-1, 3, 3).transpose(1, 0, 2)


def odd(sessions, sensor, powers):
    """[(axis letter, nats, times the variance, skewness)] of the axes of a sensor whose noise is
    not normal, of all Sessions together. powers: {axis letter: counts²} of what an axis is known
    to be shaken by, which has a shape of its own: only what is more than that is told then."""
    if any(getattr(s.capture, sensor) is None for s in sessions):
        return []
    times, skew, beyond = np.concatenate([shapes(s, sensor) for s in sessions], axis=1)
    found = []
    for axis, letter in enumerate("xyz"):
        known = MORE * powers.get(letter, 0.0)
        if len(times) < FEWEST or known and np.median(beyond[:, axis]) < known:
            continue
        ratio = _nats(np.log(times[:, axis]), math.log(HEAVY))
        leaning = max(_nats(sign * skew[:, axis], SKEW) for sign in (1.0, -1.0))
        nats = max(ratio, leaning) - math.log(TESTS)
        if present(nats):
            found.append((letter, nats, float(np.median(times[:, axis])),
                          float(np.median(skew[:, axis]))))
    return found


def words(sensor, axis, times, skew):
    """A sentence on one of odd(), for people."""
    return ("the noise of the %s axis of the %s is not normal: its square is %.2g times what its "
            "middle half says, its skewness is %.1f" % (axis, registers.SENSORS[sensor], times,
                                                        skew))


def not_normal(sessions, findings, leaping):
    """(findings that stay, [(sensor, axis letter, nats, times the variance, skewness)] whose noise
    is not normal) of Sessions without spikes; leaping: sensors whose codes leap anyhow."""
    odd = _not_normal(sessions, findings, leaping)
    rate = sessions[0].rate
    return [f for f in (_lines_alone(f, odd, rate) for f in findings) if f], odd


def _not_normal(sessions, findings, leaping):
    """Axes whose noise is not normal where neither its codes nor what is found in single samples
    make it so; leaping: sensors whose codes do."""
    not_normal = []
    for sensor in (kind for kind in registers.SENSORS if kind not in leaping):
        own = {f.effect: f for f in findings if f.sensor == sensor}
        if OWN_SHAPE.intersection(own):
            continue
        powers = {}
        if "vibration" in own:
            unit = registers.unit_of_count(sessions[0].capture.meta, sensor)
            powers = {axis: 0.5 * (size / unit) ** 2
                      for axis, size in own["vibration"].value.items()}
        not_normal += [(sensor, *axis) for axis in odd(sessions, sensor, powers)]
    return not_normal


def _lines_alone(finding, shaped, rate):
    """The Finding without lines of axes of which far more is not normal: what comes again as a
    pulse has a line at each multiple. None where none is left."""
    odd = odd_axes(finding, shaped)
    if finding.effect != "vibration" or not odd:
        return finding
    lines = [line for line in finding.lines if line.letter not in odd]
    return spectral_lines.told(lines, finding.sensor, rate) if lines else None


def _without_course(x):
    """x (n, 3) less a polynomial of degree COURSE."""
    course = legendre.legvander(np.linspace(-1.0, 1.0, len(x)), COURSE)
    return x - course @ np.linalg.lstsq(course, x, rcond=None)[0]


def _nats(values, most):
    """Nats of the median of values (n,) being above `most`, as normal as their scatter is."""
    middle = float(np.median(values))
    scatter = math.sqrt(0.5 * math.pi * float(np.var(values, ddof=1)) / len(values))
    return 0.5 * ((middle - most) / max(scatter, 1e-9)) ** 2 if middle > most else 0.0


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
    # Fisher's z, with as many samples' worth as in noise_bursts.louder_rests.
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
    begin, m = first + int(SETTLES_S * session.rate), window(session)
    steps = np.diff(np.stack([getattr(session.capture, sensor)[begin:end, "xyz".index(axis)]
                              for sensor, axis in names], 1).astype(float), axis=0)
    steps = steps[:len(steps) // m * m].reshape(-1, m, len(names))
    size = np.sqrt((steps ** 2).mean(axis=1, keepdims=True))
    steps = steps / np.where(size > 0.0, size, 1.0)
    return steps.transpose(0, 2, 1) @ steps / m
