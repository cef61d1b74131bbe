"""Sizes of effects, session by session: what the figures of the gap and the loops are made of.

The coefficients of an effect are estimated on the other sessions by generalised least squares.
Levels of placement and flicker are those of the session itself, by restricted maximum likelihood
with the effects in [Patterson & Thompson, Biometrika 58 (1971) 545].

All functions take R data sets at once, R = 1 for the real one.
"""
import numpy as np


class Data:
    """Statistics of R data sets in every unit: lists of (quadratic (G, R), projections)."""

    def __init__(self, units, contrasts=None):
        self.units = units
        self.statistics = [u.statistics(None if contrasts is None else contrasts[i])
                           for i, u in enumerate(units)]


class Fit:
    """Restricted maximum likelihood in one unit: index of the grid (R,), course (G, R) of the log
    likelihood over it, sums for pooling."""

    def __init__(self, unit, statistics, columns, prior):
        quadratic, projections = statistics
        k = len(columns)
        precision = np.diag(1.0 / prior ** 2) if k else np.zeros((0, 0))
        gram = unit.gram.of(columns)
        inner = projections[:, columns]
        loglik = -0.5 * quadratic - unit.logdet[:, None]
        if k:
            full = gram + precision
            solved = np.linalg.solve(full, inner)
            loglik = loglik + 0.5 * (inner * solved).sum(axis=1)
            loglik = loglik - 0.5 * np.linalg.slogdet(full)[1][:, None]
        self.course, self.index = loglik, loglik.argmax(axis=0)
        self.loglik = loglik.max(axis=0)
        every = np.arange(quadratic.shape[1])
        self.quadratic = quadratic[self.index, every]
        self.inner = inner[self.index, :, every]  # (R, k)
        self.gram = gram[self.index]  # (R, k, k)
        self.logdet = unit.logdet[self.index]


def fits(data, columns, prior):
    """Fit of every unit."""
    return [Fit(u, s, columns, prior) for u, s in zip(data.units, data.statistics)]


def coefficients(found, prior):
    """(theta (R, k), V (R, k, k)) of several Fits together."""
    total = sum(f.gram for f in found) + np.diag(1.0 / prior ** 2)
    covariance = np.linalg.inv(total)
    theta = np.einsum("rij,rj->ri", covariance, sum(f.inner for f in found))
    return theta, covariance
