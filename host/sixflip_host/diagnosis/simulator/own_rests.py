"""An accelerometer by its own rests: |force| is gravity at each of them.

What a log's rests leave open keeps its prior's width, of datasheet size, and its correlations: six
faces say next to nothing of a misalignment.
"""
from dataclasses import dataclass

import numpy as np

from .hypotheses import BIAS, SHAPE

STEPS, SMALL = 60, 1e-6  # of the fit at most; standard errors that ends it
FREEDOM = 4.0  # of Student's t [Lange et al., J. Am. Stat. Assoc. 84 (1989), 881]
NORM = 0.005  # m/s2: how well |force| repeats between rests, 0.5 mg with flicker and rounding
# Times NORM, that |force| may repeat worse, doubled each time: to 0.5 g, where the windows are no
# rests but pieces of a flight.
WORSE = 2.0 ** np.arange(11)
# Prior standard deviations beyond which a sensor is none: by 46 degrees another axis is nearer,
# and 80 % of scale or 1.6 g of offset are a convention, or a fit to what are no rests.
IMPOSSIBLE = 20.0
SYMMETRIC = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
PRIOR = np.concatenate([np.full(6, SHAPE), np.full(3, BIAS["accel"])])


@dataclass(frozen=True)
class AtRest:
    """means (n, 3) m/s2 of the rests; p (9,), as of matrix_of, with its covariance (9, 9)."""

    means: np.ndarray
    p: np.ndarray
    covariance: np.ndarray

    @property
    def sigma(self):
        """Standard errors ((3, 3) of the matrix, (3,) of the bias)."""
        spread = np.sqrt(np.diag(self.covariance))
        matrix = np.zeros((3, 3))
        for k, (i, j) in enumerate(SYMMETRIC):
            matrix[i, j] = matrix[j, i] = spread[k]
        return matrix, spread[6:]


def unknown(means):
    """AtRest before any look at its rests."""
    return AtRest(means, np.zeros(9), np.diag(PRIOR ** 2))


def by_norm(means, g):
    """AtRest of the parameters that make |matrix (mean - bias)| = g at rests of means (n, 3).

    How well |force| repeats is not known either: it has a half-Cauchy prior about NORM [Gelman,
    Bayesian Analysis 1 (2006), 515], and the answer is the mean over it by how likely each makes
    the rests [Laplace's approximation: Bishop (2006), section 4.4]. Rests are weighed by Student's
    t besides.
    """
    p, logs, places, inverses = np.zeros(9), [], [], []
    for worse in WORSE[::-1]:
        p, gram, log = likeliest(p, means, g, NORM * worse)
        logs.append(log - 0.5 * np.linalg.slogdet(gram)[1] - np.log(worse + 1.0 / worse))
        places.append(p)
        inverses.append(np.linalg.inv(gram))
    weights = np.exp(np.array(logs) - max(logs))
    weights /= weights.sum()
    p = weights @ places
    apart = np.array(places) - p
    covariance = np.einsum("k,kij->ij", weights, inverses) + (weights * apart.T) @ apart
    if (np.abs(p) > IMPOSSIBLE * PRIOR).any():
        return unknown(means)
    return AtRest(means, p, covariance)


def likeliest(p, means, g, scale):
    """(parameters (9,), their information (9, 9), log posterior but for a constant) where |force|
    repeats to so much (m/s2); by steps from p that are shortened until they make it likelier
    [Levenberg, Q. Appl. Math. 2 (1944), 164]."""
    def looked_at(p):
        matrix, bias = matrix_of(p)
        true = (means - bias) @ matrix.T
        size = np.linalg.norm(true, axis=1)
        unit = true / np.maximum(size, 1e-9)[:, None]
        jacobian = np.empty((len(means), 9))
        for k, (i, j) in enumerate(SYMMETRIC):
            change = np.zeros((3, 3))
            change[i, j] = change[j, i] = 1.0
            jacobian[:, k] = (unit * ((means - bias) @ change.T)).sum(axis=1)
        jacobian[:, 6:] = -unit @ matrix
        off = (g - size) / scale
        log = -0.5 * (FREEDOM + 1.0) * np.log1p(off ** 2 / FREEDOM).sum() - len(off) * np.log(
            scale) - 0.5 * ((p / PRIOR) ** 2).sum()
        return jacobian / scale, off, log

    jacobian, off, log = looked_at(p)
    damping = 1e-3
    for _ in range(STEPS):
        weight = (FREEDOM + 1.0) / (FREEDOM + off ** 2)
        gram = (jacobian.T * weight) @ jacobian + np.diag(PRIOR ** -2.0)
        step = np.linalg.solve(gram + damping * np.diag(np.diag(gram)),
                               jacobian.T @ (weight * off) - p / PRIOR ** 2)
        tried = looked_at(p + step)
        if tried[2] < log:
            damping *= 10.0
        else:
            p, damping = p + step, damping / 10.0
            jacobian, off, log = tried
        if step @ gram @ step < SMALL ** 2 or damping > 1e12:
            break
    # What Student's t says of its place on average [Lange et al. (1989), section 4].
    known = (FREEDOM + 1.0) / (FREEDOM + 3.0)
    return p, known * jacobian.T @ jacobian + np.diag(PRIOR ** -2.0), log


def up_of(mean, p):
    """(direction of gravity (3,), its slope by p (3, 9)) where an accelerometer of parameters p
    reads a mean (3,) at rest."""
    matrix, bias = matrix_of(p)
    true = matrix @ (mean - bias)
    size = max(np.linalg.norm(true), 1e-9)
    slopes = np.zeros((3, 9))
    for k, (i, j) in enumerate(SYMMETRIC):
        slopes[i, k] += mean[j] - bias[j]
        slopes[j, k] += (mean[i] - bias[i]) if i != j else 0.0
    slopes[:, 6:] = -matrix
    up = true / size
    return up, (np.eye(3) - np.outer(up, up)) @ slopes / size


def matrix_of(p):
    """((3, 3) symmetric matrix, (3,) bias) of nine parameters, zero for a sensor without error."""
    matrix = np.eye(3)
    for value, (i, j) in zip(p, SYMMETRIC):
        matrix[i, j] += value
        if i != j:
            matrix[j, i] += value
    return matrix, p[6:]
