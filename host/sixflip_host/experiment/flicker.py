"""The slow noise of a sensor: flicker, as the covariance of means over stretches of time, and a
random walk, as the first terms of its expansion."""
import numpy as np

from sixflip_sim.effects.drift import TIMES_S

# s, of the exponentials. The library's go from 10 to 1000 s; flicker has neither a shortest nor a
# longest time, so that half-decades go on to what a block (2.5 s) and hours can show.
ALL_TIMES_S = (0.3, 1.0, 3.0, *TIMES_S, 3000.0, 10000.0)
FEW = 64  # stretches up to which all times are taken at once: in 64 x 64 x 10 numbers, 330 KB


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


def walk(t, number):
    """[(n,)] number functions of times t (n,) s whose coefficients, independent of each other with
    a standard deviation of 1, make a random walk that ends 1 off on average [Karhunen-Loeve;
    Loeve, Probability Theory II, section 37]."""
    u = (t - t.min()) / max(float(np.ptp(t)), 1.0)
    return [np.sqrt(2.0) * np.sin(k * u) / k for k in (np.arange(number) + 0.5) * np.pi]


def differences(gap, block):
    """(n,) variance of the difference of two means over `block` seconds, their middles `gap` >=
    block apart, of unit flicker: per exponential 2 var - 2 cov, averaged over the blocks."""
    times = np.array(ALL_TIMES_S)[:, None]
    x = block[None] / times
    own = 2.0 / x * (1.0 - (1.0 - np.exp(-x)) / x)
    both = ((1.0 - np.exp(-x)) / x) ** 2 * np.exp(-(gap - block)[None] / times)
    return 2.0 * (own - both).sum(axis=0)
