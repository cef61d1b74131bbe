"""Noise of many samples at once: the deviates of sixflip_sim/noise.py for whole arrays of sample
numbers, the same bit for bit and a hundred times as fast, with the moment of the effects that is
as many moments; and slow noise, flicker as the covariance of means over stretches of time, a
random walk as the first terms of its expansion.
"""
import numpy as np

from sixflip_sim import noise
from sixflip_sim.effects.drift import TIMES_S
from sixflip_sim.effects.moment import Moment

_BODY = np.append(np.array(noise.BODY, dtype=np.int64), 0)  # the 128th is never used
_TAIL = np.array(noise.TAIL, dtype=np.int64)
# s, of the exponentials. The library's go from 10 to 1000 s; flicker has neither a shortest nor a
# longest time, so that half-decades go on to what a block (2.5 s) and hours can show.
ALL_TIMES_S = (0.3, 1.0, 3.0, *TIMES_S, 3000.0, 10000.0)
FEW = 64  # stretches up to which all times are taken at once: in 64 x 64 x 10 numbers, 330 KB


def gauss_int(stream, k):
    """noise.gauss_int for sample numbers k (n,), int64 or whole floats -> int64 (n,)."""
    x = noise.bits(stream, np.asarray(k).astype(np.int64))
    cell = (x >> 24) & 0x7F
    low = _BODY[cell]
    value = low + (((_BODY[cell + 1] - low) * (x & 0xFFFFFF)) >> 24)
    tail = cell == 127
    if tail.any():
        rare = x[tail]
        cell = (rare >> 18) & 0x3F
        low = _TAIL[cell]
        value[tail] = low + (((_TAIL[cell + 1] - low) * (rare & 0x3FFFF)) >> 18)
    return np.where(x >> 31, -value, value)


def gauss(stream, k):
    """(n,) standard normal deviates of sample numbers k (n,). Where the same few numbers come
    again and again, as the corners of slow noise do, each is made once."""
    k = np.atleast_1d(k).astype(np.int64)
    if len(k) > 64:
        low = int(k.min())
        spread = int(k.max()) - low + 1
        if spread < len(k) // 4:
            return gauss_int(stream, np.arange(low, low + spread))[k - low] * noise.UNIT
    return gauss_int(stream, k) * noise.UNIT


def uniform(stream, k):
    """(n,) uniform deviates in [-1, 1) of sample numbers k (n,)."""
    return noise.uniform(stream, np.asarray(k).astype(np.int64))


def moment():
    """An empty Moment whose fields may be arrays."""
    return Moment(np.exp, np.sin, np.floor, gauss)


def flicker_kernel(t, seconds):
    """(n, n) covariance of unit flicker: of the means over stretches of `seconds` (n,) around
    t (n,) s of a sum of exponentials (Ornstein-Uhlenbeck processes), equally spaced in the
    logarithm of time."""
    apart = np.maximum(np.abs(t[:, None] - t) - 0.5 * (seconds[:, None] + seconds), 0.0)
    kernel, own = np.zeros_like(apart), 0.0
    at_a_time = len(ALL_TIMES_S) if len(t) <= FEW else 1
    for first in range(0, len(ALL_TIMES_S), at_a_time):
        times = np.array(ALL_TIMES_S[first:first + at_a_time])[:, None]
        half = seconds / (2.0 * times)  # (times, n)
        shrunk = np.sinh(np.minimum(half, 30.0)) / np.maximum(half, 1e-9)
        inside = np.minimum(half[:, :, None] + half[:, None], 60.0)
        kernel += (np.exp(-apart / times[:, :, None] - inside)
                   * shrunk[:, :, None] * shrunk[:, None]).sum(axis=0)
        x = 2.0 * half
        own = own + (2.0 / x * (1.0 - (1.0 - np.exp(-x)) / x)).sum(axis=0)
    np.fill_diagonal(kernel, own)
    return kernel


def flicker_of_mean(seconds):
    """Standard deviation of the mean of a log of so many seconds, of unit flicker."""
    return float(np.sqrt(flicker_kernel(np.zeros(1), np.full(1, seconds))[0, 0]))


def walk(t, number):
    """[(n,)] number functions of times t (n,) s whose coefficients, independent of each other with
    a standard deviation of 1, make a random walk that ends 1 off on average [Karhunen-Loeve;
    Loeve, Probability Theory II, section 37]."""
    u = (t - t.min()) / max(float(np.ptp(t)), 1.0)
    return [np.sqrt(2.0) * np.sin(k * u) / k for k in (np.arange(number) + 0.5) * np.pi]


def flicker_differences(gap, block):
    """(n,) variance of the difference of two means over `block` seconds, their middles `gap` >=
    block apart, of unit flicker: per exponential 2 var - 2 cov, averaged over the blocks."""
    times = np.array(ALL_TIMES_S)[:, None]
    x = block[None] / times
    own = 2.0 / x * (1.0 - (1.0 - np.exp(-x)) / x)
    both = ((1.0 - np.exp(-x)) / x) ** 2 * np.exp(-(gap - block)[None] / times)
    return 2.0 * (own - both).sum(axis=0)


def flicker_log_likelihood(t, left, level):
    """Log likelihood of what is left (n, 3) of a log at times t (n,), by flicker of a level and by
    what the samples within each part of the log differ by: of its means over parts alone."""
    parts, middle, seconds = _parts(t)
    number = np.bincount(parts)
    kernel, log = level ** 2 * flicker_kernel(middle, seconds), 0.0
    for own in left.T:
        mean = np.bincount(parts, own) / number
        within = np.maximum(np.bincount(parts, own ** 2) / number - mean ** 2, 1e-12) / number
        log -= 0.5 * float(mean @ np.linalg.solve(kernel + np.diag(within), mean))
    return log


def flicker_of_sizes(t, columns):
    """(k,) standard deviation that unit flicker alone gives to the sizes of columns (n, 3, k) at
    times t (n,): what wanders as slowly as a temperature passes for what follows it."""
    parts, middle, seconds = _parts(t)
    kernel, across, power = flicker_kernel(middle, seconds), 0.0, 0.0
    for own in columns.transpose(1, 0, 2):
        own = own - own.mean(axis=0)
        sums = np.stack([np.bincount(parts, column) for column in own.T], 1)
        across = across + ((kernel @ sums) * sums).sum(axis=0)
        power = power + (own ** 2).sum(axis=0)
    return np.sqrt(np.maximum(across, 0.0)) / np.maximum(power, 1e-12)


def _parts(t):
    """((n,) number of the part of a log in which a row at t (n,) lies, the middle of each part
    that has rows, and how long each lasts, s)."""
    seconds = max(float(np.ptp(t)) / FEW, 1e-9)
    parts = np.unique(np.minimum(((t - t[0]) / seconds).astype(int), FEW - 1),
                      return_inverse=True)[1]
    number = np.bincount(parts)
    return parts, np.bincount(parts, t) / number, np.full(len(number), seconds)
