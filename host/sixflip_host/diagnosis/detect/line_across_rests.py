"""A line too slow for the rests that a capture has, by all of them together: a sine goes on in
phase from rest to rest, which neither what settles after a move nor a hand does.

A periodogram of samples with gaps between them, what each rest has for itself taken off [Lomb,
Astrophysics and Space Science 39 (1976) 447; Scargle, Astrophysical Journal 263 (1982) 835].
"""
import math
from dataclasses import replace

import numpy as np
from scipy import fft, ndimage

from ...capture.registers import unit_of_count
from ...experiment.block_measures import EDGE_S
from .. import odds
from .line_frequency import HALVES, SLOW_CHANCE, SLOW_SHARE, Line

FEWEST, SHORTEST_S = 12, 1.0  # rests, and seconds of each (a protocol has twelve poses or more)
# s from the first rest on that are looked at: a line of 0.7 Hz has 400 periods there, and more
# would ask of a fan or a pump that it keeps its frequency to better than a part in a thousand.
LONGEST_S = 600.0
LEAST_CYCLES = 0.5  # of a line in a rest: less is a course that is taken off
# And in all rests together: half a cycle is a bend, of which each rest has one, and to a dozen of
# them the sine of some frequency comes close whatever they are.
ALL_CYCLES = 12.0
RATE_HZ = 10.0  # of the means that are looked at: ten times line_frequency.FASTEST_HZ
GRID_HZ = 40.0  # of the times that they are taken to be at: a tenth of a radian at most
OVER = 4  # frequencies for each that rests so far apart can tell
FINER = 8  # of their distance, that a line's is told to
SEEN_AT = 48  # frequencies: between two of them a rest has a twentieth of a period more
WIDTH = 41  # frequencies of the floor's running median: ten lobes of a line
BESIDE = 64  # on either side, of the mean that a peak is held against, but for its own lobe


def strongest(session, sensor, axis, fastest_hz):
    """The strongest Line of a Session's axis up to a frequency, or None."""
    t, x, rest, lengths = _means(session, sensor, axis)
    if len(lengths) < FEWEST:
        return None
    span = t[-1] - t[0]
    slowest = max(LEAST_CYCLES, ALL_CYCLES / len(lengths)) / np.median(lengths)
    x, weight = _left(t, x, rest)
    ratio, near, looked_at, beside = _highest(t, x, rest, weight, slowest, fastest_hz)
    if not looked_at:
        return None
    beside *= sum(lengths) / span / OVER  # of which so many tell anything of their own
    # Of a power over the mean of so many others, all exponential: Fisher's F of 2 and twice them.
    nats = beside * math.log1p(ratio / beside) - math.log(3.0 * looked_at)
    hz, size = _nearest(t, x, rest, weight, near)
    amplitude = float(np.hypot(*size))
    halves = [_fitted(t[part], x[part], rest[part], weight[part], hz, t[0])
              for part in (rest < rest.max() / 2, rest >= rest.max() / 2)]
    if nats < -math.log(SLOW_CHANCE) or amplitude < SLOW_SHARE * float(np.std(x * weight)) \
            or halves[0] @ halves[1] < HALVES ** 2 * amplitude ** 2:
        return None
    # Of a frequency [Rife & Boorstyn, IEEE Trans. IT 20 (1974) 591], the samples being gaps apart.
    half = odds.Z_90 * math.sqrt(12.0 * float(np.var(x * weight)) / len(x)) / (
        2.0 * math.pi * span * amplitude)
    return Line(axis, float(hz), 1.0 / span, min(nats, 999.0), amplitude,
                1.0 / math.sqrt(2.0 * ratio), steady=True, low=float(hz - half),
                high=float(hz + half), files=((session.name, float(hz), float(hz - half),
                                               float(hz + half)),))


def _highest(t, x, rest, weight, slowest, fastest):
    """(power over the floor, Hz, peaks looked at, frequencies that the floor is the mean of) of
    the highest peak of x (n,), noughts where there are too few frequencies for a floor.

    With gaps between the rests a line leaks all over the spectrum, so that what stands highest
    above its surroundings may be a part of it: it is what takes most of the power with it. Noise
    that is slow has most power where it is slowest, and no line. The floor is what is there
    without the line."""
    hz, power = _spectrum(t, _for_itself(t, weight ** 2 * x, rest), slowest, fastest)
    if len(hz) < 2 * WIDTH:
        return 0.0, 0.0, 0, 0
    by = power / _floor(power), power / _passed(t, rest, weight, hz)
    looked = []
    for k in {int(height.argmax()) for height in by}:
        left = x - _wave(t, rest, hz[k]) @ _fitted(t, x, rest, weight, hz[k])
        _, floor = _spectrum(t, _for_itself(t, weight ** 2 * left, rest), slowest, fastest)
        beside = np.concatenate([floor[max(k - BESIDE, 0):max(k - OVER, 0)],
                                 floor[k + OVER + 1:k + BESIDE + 1]])
        ratio = float(power[k] / max(beside.mean(), odds.SMALLEST))
        looked.append((ratio, float(hz[k]), len(beside)))
    ratio, near, beside = max(looked)
    return ratio, near, len(by) * len(hz), beside


def without(session, sensor, axis, hz, fastest_hz):
    """The Session whose blocks' means are without what a line of about this frequency leaves in
    them: as slow as that it is in the means of some rests and not of others, which is no drift."""
    if hz > fastest_hz or getattr(session, sensor) is None:
        return session
    t, x, rest, lengths = _means(session, sensor, axis)
    if len(lengths) < FEWEST:
        return session
    x, weight = _left(t, x, rest)
    hz, size = _nearest(t, x, rest, weight, hz)
    phase = 2.0 * np.pi * hz * (session.t_s - t[0])
    wave = np.concatenate([[0.0], np.cumsum(
        np.stack([np.sin(phase), np.cos(phase)], 1) @ size)])
    means = np.array(getattr(session, sensor))
    means[:, axis] -= (wave[session.end] - wave[session.first]) / (session.end - session.first)
    return replace(session, **{sensor: means})


def _spectrum(t, x, slowest, fastest):
    """(frequencies (k,), power (k,)) of x (n,) at times t (n,), by a transform on a fine grid."""
    place = np.rint((t - t[0]) * GRID_HZ).astype(int)
    number = fft.next_fast_len(OVER * int((t[-1] - t[0]) * GRID_HZ + 1.0), real=True)
    whole = np.abs(np.fft.rfft(np.bincount(place, x), number)) ** 2
    first, end = (int(f * number / GRID_HZ) for f in (slowest, fastest))
    return np.arange(first, end) * GRID_HZ / number, whole[first:end]


def _means(session, sensor, axis):
    """(t (n,) s, means (n,) in mg or deg/s, number of the rest (n,), seconds of each rest)."""
    m = max(1, int(session.rate / RATE_HZ))
    scale = unit_of_count(session.capture.meta, sensor)
    counts, edge = getattr(session.capture, sensor)[:, axis], int(EDGE_S * session.rate)
    t, x, rest, lengths = [], [], [], []
    last = int(np.searchsorted(session.t_s, session.t_s[0] + LONGEST_S))
    for _, first, end in session.runs:
        first, n = first + edge, (min(end, last) - first - 2 * edge) // m
        if n * m < SHORTEST_S * session.rate:
            continue
        samples = slice(first, first + n * m)
        t.append(session.t_s[samples].reshape(n, m).mean(axis=1))
        x.append(counts[samples].reshape(n, m).mean(axis=1) * scale)
        rest.append(np.full(n, len(rest)))
        lengths.append(n * m / session.rate)
    return (*(np.concatenate(v) if v else np.zeros(0) for v in (t, x, rest)), lengths)


def _left(t, x, rest):
    """(x (n,) less what a rest has for itself and less the course that all rests have since they
    began; weight (n,): rests that are louder than most count as much less)."""
    x = _for_itself(t, x, rest)
    since = np.concatenate([np.arange(n) for n in np.bincount(rest.astype(int))])
    reach = np.bincount(since)
    course = np.bincount(since, x) / reach
    # So long as hardly any rest lasts it is a rest's own, and what settled has settled before.
    course[reach < FEWEST] = course[np.flatnonzero(reach >= FEWEST)[-1]]
    x = _for_itself(t, x - course[since], rest)
    spread = np.sqrt(np.bincount(rest.astype(int), x ** 2) / np.bincount(rest.astype(int)))
    spread = np.maximum(spread, 1e-12)
    return x, np.minimum(1.0, np.median(spread) / spread)[rest.astype(int)]


def _for_itself(t, x, rest):
    """x (n,) or (n, k) less a straight line through each rest."""
    place = rest.astype(int)
    count = np.maximum(np.bincount(place), 1)

    def mean(values):
        return (np.bincount(place, values) / count)[place]
    t = t - mean(t)
    slope = np.bincount(place, t * t)
    x = x - mean(x)
    return x - t * (np.bincount(place, t * x) / np.maximum(slope, 1e-12))[place]


def _floor(power):
    """(k,) mean of the power of noise, where it is a spectrum's."""
    return np.maximum(ndimage.median_filter(power, WIDTH, mode="reflect") / math.log(2.0),
                      odds.SMALLEST)


def _passed(t, rest, weight, hz):
    """(k,) share of the power of a sine of each frequency that what is taken off each rest leaves,
    smooth between SEEN_AT of them."""
    at = np.linspace(hz[0], hz[-1], SEEN_AT)
    return np.interp(hz, at, [float((weight[:, None] ** 2 * _wave(t, rest, frequency) ** 2
                                     ).mean()) for frequency in at])


def _wave(t, rest, hz, start=None):
    """(n, 2) sine and cosine of a frequency from start (None: the first time), less what a rest
    has for itself."""
    phase = 2.0 * np.pi * hz * (t - (t[0] if start is None else start))
    return np.stack([_for_itself(t, wave, rest) for wave in (np.sin(phase), np.cos(phase))], 1)


def _nearest(t, x, rest, weight, hz):
    """(Hz, (2,) sine and cosine) of the sine next to a frequency that takes most of x with it."""
    sines = []
    for frequency in hz + np.arange(-FINER, FINER + 1) / (OVER * FINER * (t[-1] - t[0])):
        size = _fitted(t, x, rest, weight, frequency)
        left = weight * (x - _wave(t, rest, frequency) @ size)
        sines.append((float(left @ left), float(frequency), size))
    return min(sines, key=lambda sine: sine[0])[1:]


def _fitted(t, x, rest, weight, hz, start=None):
    """(2,) sine and cosine of the sine of a frequency that is nearest to x."""
    design = weight[:, None] * _wave(t, rest, hz, start)
    gram, inner = design.T @ design, design.T @ (weight * x)
    return np.linalg.solve(gram + 1e-9 * np.trace(gram) * np.eye(2), inner)
