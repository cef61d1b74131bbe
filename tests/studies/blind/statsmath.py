"""Intervals of shares."""

import math

from scipy.stats import binom


def wilson(hits, n, z=1.96):
    """Wilson's 95 % interval of a share (Wilson 1927): (low, high) in 0..1."""
    if n == 0:
        return 0.0, 1.0
    p = hits / n
    centre = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return max(0.0, centre - half), min(1.0, centre + half)


def above(hits, n, share, level=0.05):
    """Whether hits of n are more than a share explains, at the given level (binomial)."""
    return n > 0 and float(binom.sf(hits - 1, n, share)) < level
