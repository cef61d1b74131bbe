"""Which lines are steady and a sensor's own: whether a line keeps its frequency from rest to rest,
since what a motor or a fan does runs on evenly through a rest, and a little faster or slower in
the next; and whether it is a multiple of strides, since what goes on legs does so steadily, and
its steps and knocks are lines that no sensor is shaken at.
"""
import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from ...experiment.block_measures import EDGE_S
from .. import odds

FEWEST = 3  # rests of a file that tell the frequency: two apart may as well be two lines
TOLD = 0.12  # of a rest's own bin, to which it tells the frequency of more than a peak of noise
# Times the error of a whole rest that its halves differ by in white noise; and times the least
# error there is that a frequency under a Hann window has, by simulation, as the halves say it.
HALVES, WINDOWED = 4.0, 1.6
MEDIAN = 0.6745  # of the sizes of normal numbers
# What runs on legs has strides of a frequency in between, and is shaken at multiples of it: so
# many are tried, each off by this share at most.
SLOWEST_HZ, STRIDES_HZ, MULTIPLES, MULTIPLE = 0.7, 5.0, 12, 0.005
# A stride stands that far out of the power around it, from two thirds of its frequency to one and
# a half times, but for its own lobe: noise of one axis does so once in a million bins.
STANDS, AROUND, LOBE = 20.0, 1.5, 4


@dataclass(frozen=True)
class OverRests:
    """files {name: (Hz, half of its 90 % interval)} of those whose rests tell it; spread:
    standard deviation of the frequency between rests, Hz; moves: by more than the rests leave
    open."""

    files: dict
    spread: float
    moves: bool


def over_rests(line, sessions, sensor, sine_nearest):
    """OverRests of a line_frequency.Line, or None where too few rests tell its frequency. Each
    file has a mean of its own; sine_nearest(line, x, rate): line_frequency's."""
    files = {session.name: np.array(_of_rests(line, session, sensor, sine_nearest))
             for session in sessions}
    files = {name: file for name, file in files.items() if len(file) >= FEWEST}
    if not files:
        return None
    most = max(float(np.ptp(file[:, 0])) for file in files.values())
    spread, gain = 0.0, 0.0
    if most > 0.0:
        best = minimize_scalar(lambda spread: -_log_likelihood(files, spread), bounds=(0.0, most),
                               method="bounded", options={"xatol": 1e-3 * most})
        spread, gain = float(best.x), -float(best.fun) - _log_likelihood(files, 0.0)
    known = min(float(file[:, 1].min()) for file in files.values())
    return OverRests({name: _mean(file, spread) for name, file in files.items()}, spread,
                     gain > odds.COST and spread > known)


def together(lines):
    """The Lines of a sensor's axes: one that is where another's frequency moves moves with it, as
    the same thing shakes both."""
    moving = [line for line in lines if line.spread_hz > 0.0 and not line.steady]

    def moves(line):
        return any(abs(line.hz - other.hz) < odds.Z_90 * other.spread_hz + 0.5 * (
            line.high - line.low) for other in moving)
    return [replace(line, steady=False) if line.steady and moves(line) else line for line in lines]


def digits(hz, low, high):
    """A frequency with as many digits as its 90 % interval supports, and six at most."""
    half = 0.5 * (high - low)
    if not half > 0.0:
        return "%.6g" % hz
    most = 5 - math.floor(math.log10(max(abs(hz), 1e-9)))
    return "%.*f" % (max(0, min(most, -math.floor(math.log10(half)))), hz)


def _of_rests(line, session, sensor, sine_nearest):
    """[(Hz, standard error)] of the rests of a file that show the line. An error is that of a sine
    in white noise, or as many times that as the halves of the rests usually differ by, or its own
    do: another peak is one half's where the line is hardly there."""
    counts, edge = getattr(session.capture, sensor), int(EDGE_S * session.rate)
    told, apart = [], []
    for _, first, end in session.runs:
        x = counts[first + edge:end - edge, line.axis].astype(float)
        whole, *halves = (sine_nearest(line, part, session.rate) for part in (
            x, x[:len(x) // 2], x[len(x) // 2:]))
        error = whole[2] / odds.Z_90 if whole else np.inf
        if error * len(x) < TOLD * session.rate and all(halves):
            told.append((whole[1], error))
            apart.append(abs(halves[0][1] - halves[1][1]) / (HALVES * error))
    usual = max(WINDOWED, float(np.median(apart)) / MEDIAN) if apart else 1.0
    return [(hz, max(usual, times) * error) for (hz, error), times in zip(told, apart)]


def _mean(file, spread):
    """(mean frequency, half of its 90 % interval) of rests (k, 2), each with its error, and the
    spread between them."""
    weights = 1.0 / (file[:, 1] ** 2 + spread ** 2)
    return float(np.average(file[:, 0], weights=weights)), odds.Z_90 / math.sqrt(weights.sum())


def _log_likelihood(files, spread):
    """Log likelihood of the rests' frequencies about the mean of their file, but for a constant.
    spread: standard deviation of the line's own between rests."""
    total = 0.0
    for file in files.values():
        variance = file[:, 1] ** 2 + spread ** 2
        off = file[:, 0] - _mean(file, spread)[0]
        total -= 0.5 * float((off ** 2 / variance + np.log(variance)).sum())
    return total


def without_strides(lines, moves):
    """Those of the lines of what moves that are no strides, nor multiples of one; moves: Sessions,
    or stretches of them, of which the accelerometer tells strides that are no line."""
    strides = [line.hz for line in lines if line.hz < STRIDES_HZ]
    return [line for line in lines if not any(_multiple(line.hz, hz) for hz in strides)
            and not _of_a_stride(line.hz, moves)]


def _multiple(hz, stride):
    times = hz / stride
    return round(times) >= 1 and abs(times - round(times)) < MULTIPLE * times


def _of_a_stride(hz, moves):
    """Whether something stands out at a part of a frequency, as nothing does of what is shaken by
    itself: its multiples are above it."""
    spectra = [_spectrum(move) for move in moves if move.capture.accel is not None]
    return any(_stands(*spectrum, hz / times) for spectrum in spectra
               for times in range(2, MULTIPLES + 1) if SLOWEST_HZ <= hz / times < STRIDES_HZ)


def _spectrum(move):
    """(Hz (k,), power (k,) of all axes) of the accelerometer of all of a move."""
    x = move.capture.accel - move.capture.accel.mean(axis=0)
    power = np.abs(np.fft.rfft(x * np.hanning(len(x))[:, None], axis=0)) ** 2
    return np.fft.rfftfreq(len(x), 1.0 / move.rate), power.sum(axis=1)


def _stands(hz, power, stride):
    near = np.abs(hz - stride) <= max(MULTIPLE * stride, hz[1])
    around = (hz > stride / AROUND) & (hz < stride * AROUND)
    around &= np.abs(hz - stride) > MULTIPLE * stride + LOBE * hz[1]
    return near.any() and around.any() and power[near].max() > STANDS * np.median(power[around])
