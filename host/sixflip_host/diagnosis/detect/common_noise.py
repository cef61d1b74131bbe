"""Noise that two axes have in common: a supply, a reference or a wire that both are on.

A simulated sensor's axes have noise of their own. What shakes the table is felt by several axes
of one chip, and has its own name; here it is said which two go together, not why.
"""
import itertools
import math

import numpy as np
from scipy import special

from ...capture.registers import SENSORS
from .noise_bursts import WINDOW_S
from .ringing import SETTLES_S

# Correlation from which on it is worth a word: half of either's noise. Of the recordings one chip
# has -0.37 between two axes (imu_tk_xsens_multiposition), all others less than 0.05.
SHARED = 0.5
FEWEST = 24  # half seconds


def shared(sessions):
    """[(sensor, sentence, p)] of the two axes of all Sessions whose noise has most in common, once
    for each of their sensors; the correlation is that of the median half second, so that a knock
    or a hand that takes the box away is none."""
    names = [(sensor, axis) for sensor in SENSORS for axis in "xyz"
             if all(getattr(s.capture, sensor) is not None for s in sessions)]
    found = [_by_window(s, names, *run[1:]) for s in sessions for run in s.runs]
    correlations = np.concatenate([correlation for correlation, _ in found]) if found else ()
    if len(correlations) < FEWEST:
        return []
    median, number = np.median(correlations, axis=0), sum(samples for _, samples in found)
    pairs = list(itertools.combinations(range(len(names)), 2))
    first, second = max(pairs, key=lambda pair: abs(median[pair]))
    common = min(abs(float(median[first, second])), 1.0 - 1e-9)
    # Fisher's z; differences share samples, so that three are worth one, and a median is less
    # well known than a mean.
    z = (math.atanh(common) - math.atanh(SHARED)) * math.sqrt(number / 3.0 / (0.5 * math.pi))
    said = ("the noise of the %s axis of the %s and of the %s axis of the %s goes together: a "
            "correlation of %.2g" % (names[first][1], SENSORS[names[first][0]], names[second][1],
                                     SENSORS[names[second][0]], median[first, second]))
    p = min(1.0, len(pairs) * 2.0 * float(special.ndtr(-z)))
    return [(sensor, said, p) for sensor in dict.fromkeys((names[first][0], names[second][0]))]


def _by_window(session, names, first, end):
    """((w, k, k) correlations of what the axes of a rest change by from sample to sample in its
    half seconds, 0 of those that never change; how many samples)."""
    begin, m = first + int(SETTLES_S * session.rate), max(8, int(WINDOW_S * session.rate))
    steps = np.diff(np.stack([getattr(session.capture, sensor)[begin:end, "xyz".index(axis)]
                              for sensor, axis in names], 1).astype(float), axis=0)
    steps = steps[:len(steps) // m * m].reshape(-1, m, len(names))
    size = np.sqrt((steps ** 2).mean(axis=1, keepdims=True))
    steps = steps / np.where(size > 0.0, size, 1.0)
    return steps.transpose(0, 2, 1) @ steps / m, len(steps) * m
