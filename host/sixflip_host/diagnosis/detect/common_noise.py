"""Noise that two axes have in common: a supply, a reference or a wire that both are on.

A simulated sensor's axes have noise of their own. What shakes the table is felt by several axes
of one chip, and has its own name; here it is said which two go together, not why.
"""
import itertools
import math

import numpy as np
from scipy import special

from ...capture.registers import SENSORS
from .ringing import SETTLES_S

# Correlation from which on it is worth a word: half of either's noise. Of the recordings one chip
# has -0.37 between two axes (imu_tk_xsens_multiposition), all others less than 0.05.
SHARED = 0.5
FEWEST, FEWEST_RESTS = 64, 3  # samples of a rest; rests


def shared(sessions):
    """[(sensor, sentence, p)] of the two axes of all Sessions whose noise has most in common, once
    for each of their sensors; the correlation is the median rest's, so that a knock is none."""
    names = [(sensor, axis) for sensor in SENSORS for axis in "xyz"
             if all(getattr(s.capture, sensor) is not None for s in sessions)]
    found = [_of_rest(s, names, *run[1:]) for s in sessions for run in s.runs
             if run.end - run.first - int(SETTLES_S * s.rate) >= FEWEST]
    if len(found) < FEWEST_RESTS:
        return []
    median = np.median([correlation for correlation, _ in found], axis=0)
    number = sum(samples for _, samples in found)
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


def _of_rest(session, names, first, end):
    """((k, k) correlation of what the axes of a rest change by from sample to sample, 0 of those
    that never change; how many samples)."""
    begin = first + int(SETTLES_S * session.rate)
    steps = np.diff(np.stack([getattr(session.capture, sensor)[begin:end, "xyz".index(axis)]
                              for sensor, axis in names], 1).astype(float), axis=0)
    size = np.sqrt((steps ** 2).mean(axis=0))
    steps = steps / np.where(size > 0.0, size, 1.0)
    return steps.T @ steps / len(steps), len(steps)
