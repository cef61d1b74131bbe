"""The rests of a free-hand recording, or of a gyro alone: where the variance in a sliding window
stays below a multiple of that at rest (Tedaldi et al., ICRA 2014, section IV-A), cut where the
motion begins.
"""

import numpy as np

from sixflip.poses.faces import LEANING

from .rests import Run, stretches

WINDOW = 101  # samples of a sliding window, imu_tk's default: one second at 100 Hz
SHORTEST = 100  # samples that a rest in a free-hand recording must last
GYRO_STILL, GYRO_CREEPS_DPS = 4.0, 1.0   # times the quietest variance; off the usual reading


def sliding_variance(samples, window=WINDOW):
    """Norm of the three variances in the window around every sample.

    samples (n, 3), window two and more: a single sample has no variance; returns
    (n - window + 1,), entry k belongs to sample k + window // 2.
    """
    if window < 2:
        raise ValueError("a window of %d samples has no variance" % window)
    centred = samples - samples.mean(axis=0)
    zero = np.zeros((1, samples.shape[1]))
    total = np.vstack([zero, np.cumsum(centred, axis=0)])
    squares = np.vstack([zero, np.cumsum(centred * centred, axis=0)])
    total = total[window:] - total[:-window]
    squares = squares[window:] - squares[:-window]
    variance = (squares - total * total / window) / (window - 1)
    return np.linalg.norm(np.maximum(variance, 0.0), axis=1)


def variance_at_rest(samples, first_rest=None, window=WINDOW):
    """Norm of the variances of the sensor lying still.

    first_rest: number of samples at the start that are known to be still (imu_tk asks for
    this); None: the tenth part of all windows with the least variance, so that nobody has to
    lie still on command. A window must be shorter than a rest.
    """
    if first_rest:
        return float(np.linalg.norm(samples[:first_rest].var(axis=0, ddof=1)))
    spread = np.sort(sliding_variance(samples, window))
    return float(np.median(spread[: max(1, len(spread) // 10)]))


def find(samples, limit, window=WINDOW, shortest=SHORTEST):
    """list of Run: the variance in the window around each sample stays below the limit.

    Tedaldi et al., ICRA 2014, section IV-A. samples (n, 3), limit in squared units of them.
    The board's windows are not used here: they wait for a pose of a wanted length, because an
    operator is there to try again; every rest of a recording that is over should be used, and
    be cut where the motion begins.
    """
    if len(samples) <= window:
        return []
    still = sliding_variance(samples, window) < limit
    half = window // 2
    return [Run(0, first + half, end + half) for first, end in stretches(still)
            if end - first >= shortest]


def label_still_gyro(capture):
    """The capture of a gyro alone, its rests labelled as leaning ones: where it is about as quiet
    as ever, and reads about what it reads most of the time. A turn at a steady rate that lasts
    for most of the recording looks the same."""
    samples = capture.gyro / capture.meta["gyro_lsb_per_dps"]
    window = max(8, int(capture.meta["rate_hz"]))
    capture.pose = np.zeros(len(samples), np.int16)
    if len(samples) < 3 * window:
        return capture
    spread = sliding_variance(samples, window)
    least = 3.0 / 12.0 / capture.meta["gyro_lsb_per_dps"] ** 2
    quiet = spread < GYRO_STILL * max(float(np.quantile(spread, 0.1)), least)
    mean = np.stack([np.convolve(x, np.full(window, 1.0 / window), "valid")
                     for x in samples.T], 1)
    usual = np.median(mean[quiet], axis=0)
    quiet &= np.abs(mean - usual).max(axis=1) < GYRO_CREEPS_DPS
    half, number = window // 2, 0
    for first, end in stretches(quiet):
        if end - first >= window:
            number += 1
            first = 0 if not first else first + half
            end = len(samples) if end == len(quiet) else end + half
            capture.pose[first:end] = LEANING + number
    return capture
