"""The frequency of a line: steady to 1 / T or not, file by file; and lines too slow for short
stretches.

A sine goes on in phase: over a stretch T the whole of its power lies within 1 / T. What a hand,
wheels or a motor under load do wanders, and their power spreads over the more bins the longer
one looks. That is shaking, and is no line.
"""
import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg, ndimage

from ...capture.registers import unit_of_count
from .. import odds
from . import line_steadiness, line_wander

# Share of the power of short stretches that has to go on in phase over the whole. All of a sine's
# does; of what wanders by a bin of the short stretches, over two of them and more, half at most.
STEADY = 0.5
PADDED = 4  # times its length: the transform in which a peak is looked for
PAIRED = 1000  # points, half a million pairs: their number grows with the square
SHORT_BINS = 1.5  # bins of a short stretch within which the line lies: Hann's lobe has two
# s of a rest that shows lines slower than rest_spectra.LOWEST_HZ: the slowest has SLOWEST
# periods in it, and up to FASTEST_HZ there are more bins than the floor's median is wide.
SLOW_S = 40.0
SLOWEST, FASTEST_HZ = 8.0, 1.0  # periods in the rest, and what short stretches see
SLOWEST_HZ = 0.05  # GAP: what comes and goes more slowly goes with time, and is no vibration
MULTIPLES = 3  # of that, which may be larger than it
SLOW_RATE = 4.0  # Hz of the means that slow lines are looked for in: four times FASTEST_HZ
SLOW_CHANCE = 1e-6  # of a peak: the floor below it is a guess, noise that is slow has no flat one
SLOW_SHARE = 0.5  # of the standard deviation, as an amplitude: an eighth of the variance
SLOW_WIDTH = 25  # bins of the floor's running median: five times the five of a sine's lobe
MEDIAN_ERROR = 1.0 / math.log(2.0)  # of the median of n exponentials, relative: times 1 / sqrt(n)
# Share of the amplitude that either half of a rest has, in phase with the other: a sine has all of
# it in both, a peak of what wanders is mostly one swing, in one of them.
HALVES = 0.5
LOBE = 0.8  # of the power around a peak in a lobe that has 0.999 of a sine's: the rest is noise


@dataclass(frozen=True)
class Line:
    """axis; hz, known to `bin_hz` in the spectrum; nats; amplitude in mg or deg/s with its
    relative error; narrow: it is as narrow as a sine in short stretches; power of the bump that
    it is the top of and excess, that with all else that stands out of the floor, in one unit;
    bump, bump_error: amplitude of that, as of a sine that wanders or comes and goes, and its
    relative error; left_hz: where most of the excess beside it is, 0 without any; steady: it goes
    on in phase, and from rest to rest; low, high: 90 % interval of the frequency; files: ((name,
    hz, low, high), ...) of those that show it by themselves; spread_hz: standard deviation of the
    frequency between rests, of one that moves."""

    axis: int
    hz: float
    bin_hz: float
    nats: float
    amplitude: float
    error: float
    narrow: bool = True
    power: float = 1.0
    excess: float = 1.0
    bump: float = 0.0
    bump_error: float = 0.0
    left_hz: float = 0.0
    steady: bool = False
    low: float = 0.0
    high: float = 0.0
    files: tuple = ()
    spread_hz: float = 0.0

    @property
    def letter(self):
        return "xyz"[self.axis]


def peak(power, k):
    """Index of a peak between the bins: parabola through the logarithms."""
    if not 0 < k < len(power) - 1:
        return float(k)
    a, b, c = np.log(np.maximum(power[k - 1:k + 2], 1e-300))
    below = a - 2.0 * b + c
    return float(k + (np.clip(0.5 * (a - c) / below, -0.5, 0.5) if below < 0 else 0.0))


def refined(line, sessions, sensor):
    """The Line with its frequency by the longest unbroken stretch of each file, or by all its
    rests where some tell it; where none keeps the phase, or it is no likelier a sine than a hump,
    it is not steady, and its amplitude is that of all its bump; nor is it where it moves from rest
    to rest."""
    seen = [(s.name, *sine) for s in sessions for sine in [_over_whole(line, s, sensor)] if sine]
    if not seen or not line.narrow or line_steadiness.nats(line, sessions, sensor) < 0.0:
        # What wanders has the power of all its bump, no lobe's alone.
        return replace(line, low=line.hz - line.bin_hz, high=line.hz + line.bin_hz,
                       amplitude=line.bump or line.amplitude,
                       error=line.bump_error or line.error)
    rests = line_wander.over_rests(line, sessions, sensor, _sine_nearest)
    if rests:
        seen = [(name, amplitude, *rests.files.get(name, own)) for name, amplitude, *own in seen]
    _, _, hz, half = max(seen, key=lambda file: file[1])
    moves = bool(rests and rests.moves)
    if moves:
        half = math.hypot(half, odds.Z_90 * rests.spread)
    return replace(line, steady=not moves, hz=hz, low=hz - half, high=hz + half,
                   spread_hz=rests.spread if moves else 0.0,
                   files=tuple((name, hz, hz - half, hz + half) for name, _, hz, half in seen))


def longest(session, sensor):
    """(n, 3) counts of the longest rest, or of the whole file where nothing rests."""
    counts = getattr(session.capture, sensor)
    if not session.runs:
        return counts
    _, first, end = max(session.runs, key=lambda run: run[2] - run[1])
    edge = int(0.1 * session.rate)
    return counts[first + edge:end - edge]


def _over_whole(line, session, sensor):
    """(strength, Hz, half of its 90 % interval) of a line over the longest stretch of a file, or
    None where it does not keep its phase."""
    x = longest(session, sensor)[:, line.axis].astype(float)
    short = int(round(session.rate / line.bin_hz))
    if len(x) < 2 * short:  # nothing longer to hold against: as narrow as can be seen
        return _sine_nearest(line, x, session.rate) if len(x) >= short // 2 else None
    parts = len(x) // short
    each = [_sine_nearest(line, x[k * short:(k + 1) * short], session.rate) for k in range(parts)]
    power = np.mean([sine[0] ** 2 for sine in each if sine] or [0.0])
    whole = _sine_nearest(line, x, session.rate)
    if whole is None or whole[0] ** 2 < STEADY * power:
        return None
    halves = [_sine_nearest(line, half, session.rate)
              for half in (x[:len(x) // 2], x[len(x) // 2:])]
    apart = abs(halves[0][1] - halves[1][1]) / 4.0 if all(halves) else 0.0
    return whole[0], whole[1], math.hypot(whole[2], odds.Z_90 * apart)


def _slope(x, y):
    """Median of the slopes of all pairs of points [Sen, JASA 63 (1968) 1379], of PAIRED at most:
    there are half a million pairs of so many."""
    few = np.linspace(0, len(x) - 1, min(len(x), PAIRED)).astype(int)
    x, y = x[few], y[few]
    first, second = np.triu_indices(len(x), 1)
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))


def _sine_nearest(line, x, rate):
    """(amplitude in counts, Hz, half of its 90 % interval) of the sine nearest to a line."""
    n = len(x)
    if n < 16:
        return None
    window = np.hanning(n)
    course = np.stack([np.ones(n), np.linspace(-1.0, 1.0, n)], 1)
    x = x - course @ linalg.lstsq(course, x)[0]
    power = np.abs(np.fft.rfft(x * window, PADDED * n))
    spacing = rate / (PADDED * n)
    low = max(1, int((line.hz - SHORT_BINS * line.bin_hz) / spacing))
    high = min(len(power) - 2, int((line.hz + SHORT_BINS * line.bin_hz) / spacing) + 1)
    if high <= low:
        return None
    k = low + int(power[low:high + 1].argmax())
    amplitude = 2.0 * float(power[k]) / float(window.sum())
    if amplitude <= 0.0:
        return None
    noise = max(float(np.var(x)) - 0.5 * amplitude ** 2, 1.0 / 12.0)
    # Of a frequency [Rife & Boorstyn, IEEE Trans. IT 20 (1974) 591, eq. 24].
    sigma = rate / (2.0 * math.pi) * math.sqrt(24.0 * noise / (amplitude ** 2 * n ** 3))
    return amplitude, peak(power, k) * spacing, odds.Z_90 * sigma


def slow(sessions, sensor, axis):
    """The strongest Line between SLOWEST periods of a long rest and FASTEST_HZ. None where nothing
    stands out, or what does is slower than SLOWEST_HZ or a multiple of what is."""
    lines = [_slow(s, sensor, axis) for s in sessions if s.runs]
    lines = [line for line in lines if line]
    if not lines:
        return None
    best = max(lines, key=lambda line: line.nats)
    return replace(best, files=tuple(file for line in lines for file in line.files))


def _slow(session, sensor, axis):
    m = max(1, int(session.rate / SLOW_RATE))
    x = longest(session, sensor)[:, axis]
    rate, n = session.rate / m, len(x) // m
    if n / rate < SLOW_S:
        return None
    x = x[:n * m].reshape(n, m).mean(axis=1) * unit_of_count(session.capture.meta, sensor)
    u = np.linspace(-1.0, 1.0, n)
    x = x - np.polynomial.polynomial.polyval(u, np.polynomial.polynomial.polyfit(u, x, 3))
    window = np.hanning(n)
    power = np.abs(np.fft.rfft(x * window)) ** 2 / (window ** 2).sum()
    first, end = int(SLOWEST), min(int(FASTEST_HZ * n / rate), len(power) - 2)
    if end - first < SLOW_WIDTH:
        return None
    band = power[first:end]
    # The floor falls with the frequency as flicker or a walk does: with that slope taken off, it
    # is the running median of the logarithm.
    fall = np.log(np.arange(first, end))
    fall *= min(_slope(fall, np.log(np.maximum(band, 1e-300))), 0.0)
    flat = np.log(np.maximum(band, 1e-300)) - fall
    floor = np.exp(ndimage.median_filter(flat, SLOW_WIDTH, mode="reflect") + fall) / math.log(2.0)
    ratio = band / floor
    k = int(ratio.argmax())
    if not _in_both_halves(x, (first + k) / n, math.sqrt(4.0 * band[k] / n)):
        return None
    doubt = 1.0 + odds.Z_90 * MEDIAN_ERROR / math.sqrt(SLOW_WIDTH)
    nats = float(ratio[k]) / doubt - math.log(3.0 * len(band))
    lobe, around = (band[max(0, k - w):k + w + 1].sum() for w in (2, 8))
    amplitude = math.sqrt(4.0 * lobe / n)
    if nats < -math.log(SLOW_CHANCE) or lobe < LOBE * around or amplitude < SLOW_SHARE * x.std() \
            or _of_something_slower(ratio / doubt, first, k, SLOWEST_HZ * n / rate):
        return None
    line = Line(axis, peak(power, first + k) * rate / n, rate / n, min(nats, 999.0), amplitude,
                1.0 / math.sqrt(2.0 * ratio[k]), power=float(lobe),
                excess=float(max(around, lobe)), steady=True)
    sigma = rate / (2.0 * math.pi) * math.sqrt(24.0 * float(floor[k]) / (
        amplitude ** 2 * float(n) ** 3))
    low, high = line.hz - odds.Z_90 * sigma, line.hz + odds.Z_90 * sigma
    return replace(line, low=low, high=high, files=((session.name, line.hz, low, high),))


def _of_something_slower(ratio, first, k, least):
    """Whether the k-th of the bins from `first` on, or that of which it is a multiple, is a line
    below bin `least`; ratio (m,): their power over the floor."""
    parts = [round((first + k) / times) - first for times in range(1, MULTIPLES + 1)]
    return any(0 <= part < least - first and ratio[max(part - 1, 0):part + 2].max()
               > -math.log(SLOW_CHANCE) for part in parts)


def _in_both_halves(x, cycles, amplitude):
    """Whether a sine of so many cycles a sample is in both halves of x, about as large as in
    the whole: what wanders makes a peak, and does not go on."""
    t = np.arange(len(x))
    design = np.stack([np.sin(2.0 * np.pi * cycles * t), np.cos(2.0 * np.pi * cycles * t),
                       np.ones(len(x)), t / len(x)], 1)
    middle = len(x) // 2
    sizes = [np.linalg.lstsq(design[part], x[part], rcond=None)[0][:2]
             for part in (slice(0, middle), slice(middle, None))]
    together = float(sizes[0] @ sizes[1])
    return together > HALVES ** 2 * amplitude ** 2


def answer(lines):
    """For --json: of each axis its frequency, the interval and the files that show it."""
    return {line.letter: {"hz": float("%.7g" % line.hz), "steady": line.steady,
                          "interval_90_hz": [float("%.7g" % line.low), float("%.7g" % line.high)],
                          "files": [{"capture": name, "hz": float("%.7g" % hz),
                                     "interval_90_hz": [float("%.7g" % low),
                                                        float("%.7g" % high)]}
                                    for name, hz, low, high in line.files]} for line in lines}
