"""The noise of one log: at its rests, by means of each octave that is as loud as those below it,
without the line that a channel may have; of what never rests by the quick end of its spectrum.
"""
from dataclasses import dataclass

import numpy as np

from ...experiment.block_measures import SUBMEAN_S
from ...experiment.signal_measures import MEDIAN_OF_SQUARE
from . import log_rests

# Standard error of a deviation taken from the median of squares of a standard normal, times the
# root of the number [Rousseeuw, Croux, J. Am. Stat. Assoc. 88 (1993)].
MEDIAN_SIGMA = 1.17
NEIGHBOURS = 0.87  # the same of one taken from white differences of neighbours: half of 3^0.5
# Of a rest that is a hover, or a stop in which it still turns, neighbouring means differ by its
# course; by their second differences that is nothing. Their power of white noise, 1 + 4 + 1, and
# how many of their squares, by the correlation of these, count as one.
ORDER, ORDER_POWER, ALIKE = 2, 6.0, 1.94
SETTLING = 4.0  # times the usual power: five means of one noise differ by as much in 0.3 %
SHORTEST_MEAN = 2  # samples
# Chance of noise to have a line in one channel of a rest; hertz below which what warms up or what
# settles has as much: of a rest of ten seconds the first four ordinates.
NO_LINE, SLOWEST_LINE_HZ = 1e-4, 0.5
# Chi squared of three axes that are as loud in an octave as below, in 99 of 100: what a filter
# takes away it takes from all of them.
FLAT = 11.3


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
    power = np.median(squares, axis=0) / MEDIAN_OF_SQUARE / ORDER_POWER
    return (power / (window ** 2).sum() / trace.rate_hz,
            float(MEDIAN_SIGMA / np.sqrt(len(squares) / ALIKE)), sample)


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
    """((k, 3) squared second differences of means of values (n, 3) over a window, (j, 3) squared
    differences of neighbouring samples) within the Trace's rests."""
    rests, m = [], len(window)
    for a, b in trace.rests:
        x = values[a:b]
        k = len(x) // m
        if k > ORDER:
            quiet = without_line(x, trace.rate_hz)
            means = np.einsum("kmi,m->ki", quiet[:k * m].reshape(k, m, 3), window)
            rests.append((np.diff(means, ORDER, axis=0) ** 2, np.diff(x, axis=0) ** 2))
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
