"""Rests in a free-hand recording, found without a threshold to set.

Tedaldi et al., ICRA 2014, section IV-A: the variance of the accelerometer in a sliding window
is compared with a multiple of its variance at rest; the multiple is the one whose rests fit
|a| = g best (multiposition.py tries them). The board's still window (sixflip.still_window) is
not used here: it waits for a pose of a wanted length and refuses short ones, because an operator
is there to try again. A free-hand recording is over; every rest that is in it should be used,
and its ends should be cut where the motion begins, not where a window ends.
"""

import numpy as np

WINDOW = 101  # samples, imu_tk's default: one second at 100 Hz
SHORTEST = 100  # samples a rest must last


def sliding_variance(samples, window=WINDOW):
    """Norm of the three variances in the window around every sample.

    samples (n, 3); returns (n - window + 1,), entry k belongs to sample k + window // 2.
    """
    centred = samples - samples.mean(axis=0)
    zero = np.zeros((1, samples.shape[1]))
    total = np.vstack([zero, np.cumsum(centred, axis=0)])
    squares = np.vstack([zero, np.cumsum(centred * centred, axis=0)])
    total = total[window:] - total[:-window]
    squares = squares[window:] - squares[:-window]
    variance = (squares - total * total / window) / (window - 1)
    return np.linalg.norm(np.maximum(variance, 0.0), axis=1)


def variance_at_rest(samples, first_rest=None):
    """Norm of the variances of the sensor lying still.

    first_rest: number of samples at the start that are known to be still (imu_tk asks for
    this); None: the tenth part of all windows with the least variance, so that nobody has to
    lie still on command.
    """
    if first_rest:
        return float(np.linalg.norm(samples[:first_rest].var(axis=0, ddof=1)))
    spread = np.sort(sliding_variance(samples))
    return float(np.median(spread[: max(1, len(spread) // 10)]))


def find(samples, limit, window=WINDOW, shortest=SHORTEST):
    """Rests as a list of (first, n): the window's variance stays below the limit.

    samples (n, 3), limit in squared units of the samples.
    """
    if len(samples) <= window:
        return []
    still = sliding_variance(samples, window) < limit
    edges = np.diff(np.concatenate([[0], still.astype(np.int8), [0]]))
    first = np.flatnonzero(edges == 1) + window // 2
    after = np.flatnonzero(edges == -1) + window // 2
    return [(int(f), int(a - f)) for f, a in zip(first, after) if a - f >= shortest]
