"""Baseline: sparse regression on the samples, its penalty by what the other session says.

Lasso by coordinate descent on the sums [Friedman, Hastie & Tibshirani, J. Stat. Softw. 33 (2010)
1, section 2.2]; of the penalties the largest whose error on the sessions held out is within one
standard error of the least, as there.
"""

import numpy as np

from .answers import answer
from .regression import problems

PENALTIES, LEAST, ROUNDS, CLOSE = 40, 1e-4, 300, 1e-5


def lasso(captures):
    """The answer with every variable whose coefficient is not zero."""
    found, gaps = {}, {}
    for problem in problems(captures):
        sums = problem.pooled
        share = best_share(problem)
        theta = path(sums, problem.seen, [share])[0]
        found[problem.sensor] = [
            (problem.names[i], theta[i],
             0.5 * sums.freedom * theta[i] ** 2 * sums.gram[i, i] / max(sums.square, 1e-300))
            for i in np.flatnonzero(theta)]
        gaps[problem.sensor] = problem.held_out(
            lambda others, seen=problem.seen, share=share: path(others, seen, [share])[0])
    return answer({k: v for k, v in found.items() if v}, gaps)


def shares():
    """Penalties as shares of the smallest that makes every coefficient zero."""
    return np.geomspace(1.0, LEAST, PENALTIES)


def best_share(problem):
    """Chosen across sessions; with one session the samples' standard error decides: at the
    penalty sqrt(2 log(variables) / samples) of a noise that only the residual tells."""
    if len(problem.samples) < 2:
        sums = problem.samples[0]
        scale, strongest = _scaled(sums, problem.seen)[2:]
        noise = np.sqrt(2.0 * np.log(max(len(scale), 2)) * sums.square / max(sums.freedom, 1))
        return float(np.clip(noise / max(strongest, 1e-300), LEAST, 1.0))
    errors = []
    for held, mine in enumerate(problem.samples):
        others = problem.samples[:held] + problem.samples[held + 1:]
        errors.append([mine.left(theta) / mine.freedom for theta in path(
            sum(others[1:], others[0]), problem.seen, shares())])
    mean = np.mean(errors, axis=0)
    least = int(mean.argmin())
    allowed = mean[least] + np.std(np.array(errors)[:, least]) / np.sqrt(len(errors)) \
        if len(errors) > 2 else mean[least] * (1.0 + np.sqrt(2.0 / problem.pooled.freedom))
    return float(shares()[int(np.flatnonzero(mean <= allowed)[0])])


def _scaled(sums, seen):
    """(gram, inner) of the variables seen, each of unit norm; their norms; largest inner."""
    scale = np.sqrt(np.maximum(np.diag(sums.gram)[seen], 1e-300))
    gram = sums.gram[np.ix_(seen, seen)] / scale / scale[:, None]
    inner = sums.inner[seen] / scale
    return gram, inner, scale, float(np.abs(inner).max()) if len(inner) else 0.0


def path(sums, seen, wanted):
    """list of theta (K,), one for each penalty, each starting from the one before."""
    gram, inner, scale, strongest = _scaled(sums, seen)
    theta, left, out = np.zeros(len(inner)), inner.copy(), []
    for share in wanted:
        penalty = share * strongest
        for _ in range(ROUNDS):
            moved = 0.0
            for i in range(len(theta)):
                alone = left[i] + gram[i, i] * theta[i]
                new = np.sign(alone) * max(abs(alone) - penalty, 0.0) / max(gram[i, i], 1e-12)
                if new != theta[i]:
                    left -= gram[i] * (new - theta[i])
                    moved, theta[i] = max(moved, abs(new - theta[i])), new
            if moved <= CLOSE * max(strongest, 1e-300):
                break
        whole = np.zeros(len(seen))
        whole[seen] = theta / scale
        out.append(whole)
    return out
