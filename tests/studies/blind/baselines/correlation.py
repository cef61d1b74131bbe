"""Baseline: the variable that the residual correlates with most, if that is significant."""

import numpy as np
from scipy import stats

from .answers import answer
from .regression import problems

SIGNIFICANT = 0.05  # of the largest of all correlations, every sample counted as independent


def correlation(captures):
    """The answer; one name a sensor at most."""
    found, gaps = {}, {}
    for problem in problems(captures):
        sums = problem.pooled
        best, r = strongest(sums, problem.seen)
        if best is None:
            continue
        p = stats.beta.sf(r * r, 0.5, (sums.freedom - 1) / 2.0) * int(problem.seen.sum())
        if p < SIGNIFICANT:
            score = -0.5 * sums.freedom * np.log1p(-r * r)
            found[problem.sensor] = [(problem.names[best], slope(sums, best)[best], score)]
        gaps[problem.sensor] = problem.held_out(
            lambda others, best=best, named=p < SIGNIFICANT: slope(others, best) * named)
    return answer(found, gaps)


def strongest(sums, seen):
    """(index, correlation) of the largest in size, (None, 0.0) of nothing."""
    if not seen.any() or sums.square <= 0.0:
        return None, 0.0
    r = np.zeros(len(seen))
    r[seen] = sums.inner[seen] / np.sqrt(np.diag(sums.gram)[seen] * sums.square)
    best = int(np.abs(r).argmax())
    return best, float(np.clip(r[best], -1.0, 1.0))


def slope(sums, index):
    """theta (K,) with the least squares coefficient of one variable alone."""
    theta = np.zeros(len(sums.inner))
    if sums.gram[index, index] > 0.0:
        theta[index] = sums.inner[index] / sums.gram[index, index]
    return theta
