"""Sizes of effects, session by session: what the figures of the gap and the loops are made of.

The coefficients of an effect are estimated on the other sessions by generalised least squares.
Levels of placement and flicker are those of the session itself, by restricted maximum likelihood
with the effects in [Patterson & Thompson, Biometrika 58 (1971) 545].

All functions take R data sets at once, R = 1 for the real one.
"""
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Data:
    """Units with the statistics of R data sets in every one: lists of Unit and of (quadratic
    (G, R), projections (G, K, R))."""

    units: list
    statistics: list


def data_of(units):
    """Data of these units, with their own contrasts."""
    return Data(units, [u.statistics() for u in units])


@dataclass(frozen=True, eq=False)
class Fit:
    """Restricted maximum likelihood in one unit: index of the grid (R,), course (G, R) of the log
    likelihood over it, inner (R, k) and gram (R, k, k) there, for pooling."""

    index: np.ndarray
    course: np.ndarray
    inner: np.ndarray
    gram: np.ndarray


def fit(unit, statistics, shared):
    """Fit of elimination.Columns (k,)."""
    quadratic, projections = statistics
    gram, inner = unit.gram.at_all_points(shared.index), projections[:, shared.index]
    course = -0.5 * quadratic - unit.logdet[:, None]
    if len(shared):
        full = gram + np.diag(1.0 / shared.prior ** 2)
        solved = np.linalg.solve(full, inner)
        course = course + 0.5 * (inner * solved).sum(axis=1)
        course = course - 0.5 * np.linalg.slogdet(full)[1][:, None]
    index = course.argmax(axis=0)
    return Fit(index, course, inner[index, :, np.arange(quadratic.shape[1])], gram[index])


def fits(data, shared):
    """Fit of every unit."""
    return [fit(u, s, shared) for u, s in zip(data.units, data.statistics)]


def coefficients(fits, shared):
    """(theta (R, k), V (R, k, k)) of several Fits of these Columns together."""
    total = sum(f.gram for f in fits) + np.diag(1.0 / shared.prior ** 2)
    covariance = np.linalg.inv(total)
    theta = np.einsum("rij,rj->ri", covariance, sum(f.inner for f in fits))
    return theta, covariance
