"""How noisy the blocks of a session are: white noise, what rounding leaves, vibration.

counts (N, 3) of all samples; first, end (n,): which of them each block holds.
"""
import numpy as np

from ..capture.registers import fixed_bits, steps

ALL, ODD = np.arange(1, 9), np.arange(1, 200, 2)  # harmonics of rounding and of a square wave
SUBMEAN_S = 0.25  # white noise is judged on means this long, so that a filter's colour is in it


def rounding(counts, first, end):
    """Counts (3,): standard deviation of what rounding to steps leaves in the mean of a
    rest. Noise much wider than a step averages it out: the k-th harmonic of the rounding
    error, step / (pi k), is damped by exp(-2 pi^2 k^2 (noise / step)^2) [Widrow & Kollar,
    Quantization Noise (2008), chapter 5]. A bit that never changes takes a square wave of the
    value off, of twice its weight as period and as step, which has the odd harmonics only."""
    step = steps(counts)
    changes = np.concatenate([np.diff(counts[a:b].astype(float), axis=0)
                              for a, b in zip(first, end)])
    seen = np.sqrt(np.maximum(changes.var(axis=0) / 2.0 - step ** 2 / 12.0, 0.0))
    left = _of_mean(step, ALL, seen)
    for axis, column in enumerate(counts.T):
        waves = [2.0 ** (bit + 1) for bit, _ in fixed_bits(column.astype(np.int64))]
        if waves:
            left[axis] += _of_waves(np.array(waves), seen[axis])
    return np.sqrt(left)


def _of_waves(periods, seen):
    """Variance that square waves leave in a mean, of the standard deviation seen in samples,
    which has in it what they do not leave there: the noise is less than that."""
    from scipy import optimize  # of a stuck bit only: without it scipy takes no start-up time
    whole = (periods ** 2).sum() / 16.0

    def excess(noise):
        return noise ** 2 + whole - _of_mean(periods, ODD, noise).sum() - seen ** 2
    noise = optimize.brentq(excess, 0.0, seen) if excess(0.0) < 0.0 else 0.0
    return _of_mean(periods, ODD, noise).sum()


def _of_mean(step, orders, noise):
    """Variance in the mean of what has so much noise of these harmonics of a rounding error."""
    k = orders[:, None]
    return ((step / (np.pi * k) * np.exp(-2.0 * (np.pi * k * noise / step) ** 2)) ** 2
            ).sum(axis=0) / 2.0


def white(counts, first, end, rate):
    """Counts (3,): standard deviation of a mean over one second, from the differences of
    neighbouring short means (slow changes are not in it)."""
    m = max(1, int(SUBMEAN_S * rate))
    squares, number = np.zeros(3), 0
    for a, b in zip(first, end):
        k = (b - a) // m
        if k < 2:
            continue
        short = counts[a:a + k * m].astype(float).reshape(k, m, 3).mean(axis=1)
        squares += (np.diff(short, axis=0) ** 2).sum(axis=0)
        number += k - 1
    if not number:
        return counts[first[0]:end[0]].std(axis=0) / np.sqrt(rate)
    floor = 1.0 / np.sqrt(12.0 * rate)  # of counting: rounding is noise, too
    return np.maximum(np.sqrt(squares / number / 2.0 * m / rate), floor)


def freedom(first, end, rate):
    """Degrees of freedom with which white() knows the noise of three axes together: squares of
    differences of neighbours, of which a mean over N has a relative variance of 3 / N [von
    Neumann et al., Ann. Math. Stat. 12 (1941) 153]."""
    number = ((end - first) // max(1, int(SUBMEAN_S * rate)) - 1).clip(min=0).sum()
    return max(2.0 * float(number), 1.0)


def vibration(capture, first, end):
    """mg rms above the quietest tenth of the blocks; zero where nothing stands out."""
    if not len(first):
        return np.zeros(0)
    scale = 1000.0 / capture.meta["accel_lsb_per_g"]
    power = np.array([np.diff(capture.accel[a:b].astype(float), axis=0).var(axis=0).sum()
                      / 2.0 for a, b in zip(first, end)])
    quiet = np.quantile(power, 0.1)
    excess = np.where(power > 2.0 * quiet, power - quiet, 0.0)
    return np.sqrt(excess) * scale
