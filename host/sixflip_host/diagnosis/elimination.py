"""Private columns integrated out of a unit's statistics, before the shared ones are fitted.

What a session has of its own (a jump, a sine, something smooth in time) has coefficients with a
normal prior; integrated out they leave products of the shared columns, a quadratic and a
determinant, at each point of the grid of noise levels.
"""
from dataclasses import dataclass

import numpy as np

from ..experiment import gram

# Least eigenvalue of a metric of columns of size 1: some tens of units in the last place.
ROUNDING = 1e-14


@dataclass(frozen=True)
class Columns:
    """Columns of a unit's table with the standard deviations of their coefficients."""

    index: np.ndarray
    prior: np.ndarray

    def __add__(self, other):
        return Columns(np.concatenate([self.index, other.index]),
                       np.concatenate([self.prior, other.prior]))

    def __len__(self):
        return len(self.index)


NONE = Columns(np.zeros(0, dtype=int), np.zeros(0))


@dataclass(frozen=True)
class Reduced:
    """A unit's statistics with private columns integrated out: gram (G, k, k), inner (G, k, R)
    of the columns asked for, quadratic (G, R), logdet (G,)."""

    gram: np.ndarray
    inner: np.ndarray
    quadratic: np.ndarray
    logdet: np.ndarray


@dataclass(frozen=True)
class Whitening:
    """matrix (G, k, k), W M W' = 1 of a metric M; half_logdet (G,), half of log |M|."""

    matrix: np.ndarray
    half_logdet: np.ndarray


def whitening(metric):
    """Whitening of metrics (G, k, k), positive but for rounding."""
    try:
        factor = np.linalg.cholesky(metric)
    except np.linalg.LinAlgError:
        size = np.sqrt(np.diagonal(metric, axis1=1, axis2=2))
        values, vectors = np.linalg.eigh(metric / size[:, None] / size[:, :, None])
        values = np.maximum(values, ROUNDING)
        return Whitening((vectors / np.sqrt(values)[:, None]).transpose(0, 2, 1) / size[:, None],
                         (0.5 * np.log(values) + np.log(size)).sum(axis=1))
    return Whitening(_inverse(factor), np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1))


def _inverse(lower):
    """(G, k, k) inverses of lower triangular matrices, row by row for all of them at once: many
    small ones, which a library takes one by one and as if they were full."""
    inverse = np.zeros_like(lower)
    scale = 1.0 / np.diagonal(lower, axis1=1, axis2=2)
    for row in range(lower.shape[1]):
        inverse[:, row, row] = scale[:, row]
        inverse[:, row, :row] = -scale[:, row, None] * (
            lower[:, row, None, :row] @ inverse[:, :row, :row])[:, 0]
    return inverse


class Elimination:
    """What integrating private columns out of a unit takes, for all of its columns at once: made
    once for each point of the grid that is asked for, then any shared columns are an indexing.
    R = 1."""

    def __init__(self, unit, statistics, private):
        self.unit, self.statistics, self.private = unit, statistics, private
        points, size = unit.logdet.shape[0], len(unit.silent)
        self.white = np.empty((points, len(private), size))
        self.inner, self.quadratic = np.empty((points, size, 1)), np.empty((points, 1))
        self.logdet, self._done = np.empty(points), np.zeros(points, bool)

    def _fill(self, points):
        points = points[~self._done[points]]
        if not len(points):
            return
        self._done[points] = True
        index, quadratic, projections = self.private.index, *self.statistics
        cross = self.unit.gram.rows(points, index)
        metric = whitening(cross[:, :, index] + np.diag(self.private.prior ** -2.0))
        white, own = metric.matrix @ cross, metric.matrix @ projections[points[:, None], index]
        self.white[points] = white
        self.quadratic[points] = quadratic[points] - (own ** 2).sum(axis=1)
        self.inner[points] = projections[points] - white.transpose(0, 2, 1) @ own
        self.logdet[points] = (self.unit.logdet[points] + metric.half_logdet
                               + np.log(self.private.prior).sum())

    def at(self, points):
        """(quadratic (G, 1), inner (G, K, 1), logdet (G,)), made at these points of the grid."""
        self._fill(points)
        return self.quadratic, self.inner, self.logdet

    def taken(self, points, index):
        """(P, F, k, k): what the private columns take off the products of columns (F, k)."""
        self._fill(points)
        forms, k = index.shape
        own, place = np.unique(index, return_inverse=True)
        if len(own) ** 2 < index.size * k:  # most columns are in most of them
            return gram.gathered(self.block(points, own, own), place.reshape(index.shape))
        white = self.white[points][:, :, index].transpose(0, 2, 3, 1)
        return white @ white.transpose(0, 1, 3, 2)

    def block(self, points, rows, columns):
        """(P, r, c): what the private columns take off the products of columns rows (r,) with
        columns (c,)."""
        self._fill(points)
        white = self.white[points]
        return white[:, :, rows].transpose(0, 2, 1) @ white[:, :, columns]

    def reduced(self, columns, points):
        """Reduced of these shared columns at these points of the grid."""
        self._fill(points)
        return Reduced(self.unit.gram.blocks(points, columns, columns)
                       - self.block(points, columns, columns),
                       self.inner[points[:, None], columns], self.quadratic[points],
                       self.logdet[points])


def reduced(unit, statistics, shared, private, points):
    """Reduced of one unit without anything made before, for R data sets."""
    p = len(private)
    both = (private + shared).index
    # What is looked at everywhere once, few columns of it, is not kept.
    gram = unit.gram.at_all_points(both) if len(points) == len(unit.grid) \
        else unit.gram.blocks(points, both, both)
    inner = statistics[1][points[:, None], both]
    if not p:
        return Reduced(gram, inner, statistics[0][points], unit.logdet[points])
    metric = whitening(gram[:, :p, :p] + np.diag(private.prior ** -2.0))
    white, own = metric.matrix @ gram[:, :p, p:], metric.matrix @ inner[:, :p]
    across = white.transpose(0, 2, 1)
    return Reduced(gram[:, p:, p:] - across @ white, inner[:, p:] - across @ own,
                   statistics[0][points] - (own ** 2).sum(axis=1),
                   unit.logdet[points] + metric.half_logdet + np.log(private.prior).sum())
