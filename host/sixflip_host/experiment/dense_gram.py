"""The products of columns where there are few readings: one matrix of all of them at each point of
the grid, across what is projected out."""
import numpy as np
from scipy.linalg import lapack

from . import covariance
from .gram import Whitened


def dense_products(groups, grid, space, common, columns):
    """DenseGram of columns (m, K). grid: list of (placement level, flicker level); space (m, p)
    orthonormal, projected out; common (m, c), coefficients known to 1. LinAlgError where a
    covariance is not positive definite."""
    across = np.linalg.qr(space, mode="complete")[0][:, space.shape[1]:]
    loud = np.flatnonzero((columns != 0.0).any(axis=0))
    return DenseGram(grid, across, across.T @ columns, loud,
                     _factors(groups, grid, across, common))


def _factors(groups, grid, across, common):
    """(G, r, r) lower factors of the covariance at all points; what is above them is not
    zero, but not read."""
    base, lateral, kernel = covariance.components(groups)
    base, lateral, kernel = (across.T @ part @ across
                             for part in (base + common @ common.T, lateral, kernel))
    out, slow = np.empty((len(grid), *base.shape)), np.empty_like(base)
    for own, (placement, flicker) in zip(out, grid):
        np.multiply(lateral, placement ** 2, out=own)
        np.multiply(kernel, flicker ** 2, out=slow)
        own += slow
        own += base
        # In its own place; in the order of Fortran a lower factor is an upper one.
        if lapack.dpotrf(own.T, lower=0, clean=0, overwrite_a=1)[1]:
            raise np.linalg.LinAlgError("a covariance that is not positive definite")
    return out


class DenseGram(Whitened):
    """The products of K columns at the G points of a grid, r contrasts; made by dense_products().

    across (m, r): orthonormal, across what is projected out; columns (r, K), as contrasts; loud:
    which of the columns are not zero; lower (G, r, r): factors of the covariance at all points.
    values (P, l + 1, r): the l loud columns, whitened, and zero for all others, at the points
    asked for so far, in their order. There is room for half of all points at first, which is more
    than a search needs: memory that was just given back costs nothing to take again, and a larger
    piece is always new.
    """

    def __init__(self, grid, across, columns, loud, lower):
        super().__init__(np.empty(((len(grid) + 1) // 2, len(loud) + 1, len(columns))))
        self.grid, self._across, self._columns, self._lower = grid, across, columns, lower
        self._given = np.asfortranarray(columns[:, loud])
        self._place = np.full(columns.shape[1], len(loud))
        self._place[loud] = np.arange(len(loud))
        self._slot, self._number = np.full(len(grid), -1), 0

    def at(self, point, columns=None):
        every = np.arange(len(self._place)) if columns is None else columns
        return super().at(point, every)

    def _fill(self, points):
        for point in points[self._slot[points] < 0]:
            if self._number == len(self.values):
                self.values = np.concatenate([self.values, np.empty_like(self.values)])
            one = self.values[self._number]
            one[:-1] = self._solved(point, self._given, 1).T
            one[-1] = 0.0
            self._slot[point] = self._number
            self._number += 1

    def _chosen(self, points, columns):
        return self.values[self._slot[points], self._place[columns]]

    def _at(self, point):
        return self.values[self._slot[point]]

    def _every(self, kept):
        return kept[:, self._place]

    def at_all_points(self, columns):
        """(G, k, k) of a few columns at every point; nothing is kept of it."""
        given = np.asfortranarray(self._columns[:, columns])
        white = np.stack([self._solved(point, given, 1) for point in range(len(self.grid))])
        return white.transpose(0, 2, 1) @ white

    def statistics(self, z, points=None):
        """As factored_gram.FactoredGram.statistics."""
        z = np.asfortranarray(self._across.T @ z)
        wanted = np.arange(len(self.grid)) if points is None else points
        quadratic = np.full((len(self.grid), z.shape[1]), np.nan)
        inner = np.zeros((len(self.grid), len(self._place), z.shape[1]))
        logdet = np.full(len(self.grid), np.nan)
        back = np.empty((len(wanted), *z.shape))
        for place, point in enumerate(wanted):
            white = self._solved(point, z, 1)
            quadratic[point] = (white ** 2).sum(axis=0)
            logdet[point] = np.log(np.diagonal(self._lower[point])).sum()
            back[place] = self._solved(point, white, 0)
        inner[wanted] = self._columns.T @ back
        return quadratic, inner, logdet

    def _solved(self, point, x, transposed):
        """x (r, R) in the order of Fortran whitened at a point (1), or whitened back (0)."""
        # Read in the order of Fortran the lower factor is an upper one.
        if not len(x):  # all of it was projected out
            return x
        return lapack.dtrtrs(self._lower[point].T, x, trans=transposed)[0]
