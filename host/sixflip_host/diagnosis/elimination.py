"""Private columns integrated out of a unit's statistics, before the shared ones are fitted.

What a session has of its own (a jump, a sine, something smooth in time) has coefficients with a
normal prior; integrated out they leave products of the shared columns, a quadratic and a
determinant, at each point of the grid of noise levels.
"""
from dataclasses import dataclass

import numpy as np

from ..experiment import gram


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


class Elimination:
    """What integrating private columns out of a unit takes, for all of its columns at once: made
    once for each point of the grid that is asked for, then any shared columns are an indexing.
    R = 1."""

    def __init__(self, unit, statistics, private):
        self.unit, self.statistics, self.private = unit, statistics, private
        points, size = unit.logdet.shape[0], len(unit.silent)
        self.solved = np.empty((points, len(private), size))
        self.inner, self.quadratic = np.empty((points, size, 1)), np.empty((points, 1))
        self.logdet, self._done = np.empty(points), np.zeros(points, bool)

    def _fill(self, points):
        points = points[~self._done[points]]
        if not len(points):
            return
        self._done[points] = True
        index, quadratic, projections = self.private.index, *self.statistics
        cross = self.unit.gram.rows(points, index)
        block = cross[:, :, index] + np.diag(self.private.prior ** -2.0)
        self.solved[points] = np.linalg.solve(block, cross)
        own = projections[points]
        inner = np.linalg.solve(block, own[:, index])
        self.quadratic[points] = quadratic[points] - (own[:, index] * inner).sum(axis=1)
        self.inner[points] = own - cross.transpose(0, 2, 1) @ inner
        self.logdet[points] = (self.unit.logdet[points] + 0.5 * np.linalg.slogdet(block)[1]
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
        cross = self.unit.gram.blocks(points, index.ravel(), self.private.index)
        solved = self.solved[points[:, None, None], np.arange(len(self.private))[:, None],
                             index.ravel()]
        own = solved.reshape(len(points), len(self.private), forms, k).transpose(0, 2, 1, 3)
        return cross.reshape(len(points), forms, k, len(self.private)) @ own

    def block(self, points, rows, columns):
        """(P, r, c): what the private columns take off the products of columns rows (r,) with
        columns (c,)."""
        self._fill(points)
        cross = self.unit.gram.blocks(points, rows, self.private.index)
        return cross @ self.solved[points[:, None, None],
                                   np.arange(len(self.private))[:, None], columns]

    def reduced(self, columns, points):
        """Reduced of these shared columns at these points of the grid."""
        self._fill(points)
        return Reduced(self.unit.gram.blocks(points, columns, columns)
                       - self.block(points, columns, columns),
                       self.inner[points[:, None], columns], self.quadratic[points],
                       self.logdet[points])


def reduced(unit, statistics, shared, private, points):
    """Reduced of one unit without anything made before, for R data sets."""
    k, p = len(shared), len(private)
    both = (private + shared).index
    # What is looked at everywhere once, few columns of it, is not kept.
    gram = unit.gram.at_all_points(both) if len(points) == len(unit.grid) \
        else unit.gram.blocks(points, both, both)
    inner = statistics[1][points[:, None], both]
    if not p:
        return Reduced(gram, inner, statistics[0][points], unit.logdet[points])
    block = gram[:, :p, :p] + np.diag(private.prior ** -2.0)
    solved = np.linalg.solve(block, np.concatenate([gram[:, :p, p:], inner[:, :p]], 2))
    cross = gram[:, p:, :p]
    return Reduced(gram[:, p:, p:] - cross @ solved[:, :, :k],
                   inner[:, p:] - cross @ solved[:, :, k:],
                   statistics[0][points] - (inner[:, :p] * solved[:, :, k:]).sum(axis=1),
                   unit.logdet[points] + 0.5 * np.linalg.slogdet(block)[1]
                   + np.log(private.prior).sum())
