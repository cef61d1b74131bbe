"""Baseline: stepwise regression on the samples, forward and backward, by BIC.

Schwarz, Ann. Statist. 6 (1978) 461: n log(RSS / n) + k log(n), every sample counted.
"""

import numpy as np

from .answers import answer
from .regression import problems

MOST = 20  # variables


def stepwise(captures):
    """The answer with every variable that lowers the criterion."""
    found, gaps = {}, {}
    for problem in problems(captures):
        sums = problem.pooled
        chosen = select(sums, problem.seen)
        theta = least_squares(sums, chosen)
        now = sums.left(theta)
        found[problem.sensor] = [
            (problem.names[i], theta[i], 0.5 * sums.freedom * np.log(
                sums.left(least_squares(sums, [c for c in chosen if c != i])) / now))
            for i in chosen]
        gaps[problem.sensor] = problem.held_out(
            lambda others, chosen=chosen: least_squares(others, chosen))
    return answer({k: v for k, v in found.items() if v}, gaps)


def criterion(sums, chosen):
    """BIC of a set of variables."""
    n = sums.freedom
    rss = max(sums.left(least_squares(sums, chosen)), 1e-12 * sums.square, 1e-300)
    return n * np.log(rss / n) + len(chosen) * np.log(n)


def select(sums, seen):
    """list of the variables chosen."""
    chosen, now = [], criterion(sums, [])
    while len(chosen) < MOST:
        steps = [chosen + [int(i)] for i in np.flatnonzero(seen) if i not in chosen]
        steps += [[c for c in chosen if c != i] for i in chosen]
        scores = [criterion(sums, s) for s in steps]
        if not scores or min(scores) >= now - 1e-9:
            break
        now, chosen = min(scores), steps[int(np.argmin(scores))]
    return chosen


def least_squares(sums, chosen):
    """theta (K,) of the variables chosen, 0 elsewhere."""
    theta = np.zeros(len(sums.inner))
    if chosen:
        gram = sums.gram[np.ix_(chosen, chosen)]
        scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        theta[chosen] = np.linalg.lstsq(gram / scale / scale[:, None],
                                        sums.inner[chosen] / scale, rcond=1e-9)[0] / scale
    return theta
