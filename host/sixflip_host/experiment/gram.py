"""What columns S say together, the products S' C^-1 S, at the points of a grid of noise levels.

C is the covariance of the readings at one point of the grid. A search looks at few points, near
the levels that the data has, and at few columns at a time; the products of all columns would cost
more than everything else there. So what is kept of a point is made when it is first asked for:
the whitened columns, of which any products are a short sum, or the products themselves. Where
there are few readings, one matrix of all of them is factored at each point, across what is
projected out (DenseGram); the covariance of a long session is factored in time (factored_gram.py).
"""
import numpy as np
from scipy.linalg import lapack

from . import covariance


class Products:
    """Products of K columns at G points that are there already: values (G, K, K)."""

    def __init__(self, values):
        self.values = values

    def at(self, point, columns=None):
        """(k, k) products of columns (default all) at one point of the grid."""
        columns = np.arange(self.values.shape[1]) if columns is None else columns
        return self.blocks(np.array([point]), columns, columns)[0]

    def blocks(self, points, rows, columns):
        """(P, r, c) products of columns rows (r,) with columns (c,) at points (P,) of the grid."""
        return self.values[points[:, None, None], rows[:, None], columns]

    def rows(self, points, rows):
        """(P, r, K) products of columns rows (r,) with every column."""
        return self.values[points[:, None], rows]

    def at_all_points(self, columns):
        """(G, k, k) products of a few columns at every point."""
        return self.blocks(np.arange(len(self.values)), columns, columns)

    def each(self, points, index):
        """(P, F, k, k) products of columns index (F, k) with one another."""
        return gathered(self.values, index, points)


def gathered(values, index, points=None):
    """(P, F, k, k) of values (P, K, K) at places index (F, k) with one another; points (P,): of
    values (G, K, K)."""
    points = np.arange(len(values)) if points is None else points
    return values[points[:, None, None, None], index[:, :, None], index[:, None, :]]


class Whitened(Products):
    """Products of K whitened columns of r contrasts each: values (G, K, r), those of a point there
    after _fill(points), which whoever inherits from this defines."""

    def blocks(self, points, rows, columns):
        if len(rows) and len(columns):
            self._fill(points)
        others = self._chosen(points[:, None], columns)
        own = others if rows is columns else self._chosen(points[:, None], rows)
        return own @ others.transpose(0, 2, 1)

    def rows(self, points, rows):
        self._fill(points)
        own = self._chosen(points[:, None], rows)
        return np.stack([self._every(white @ self._at(point).T)
                         for point, white in zip(points, own)])

    def each(self, points, index):
        if index.size:
            self._fill(points)
        own, place = np.unique(index, return_inverse=True)
        if len(own) ** 2 < index.size * index.shape[1]:  # most columns are in most of them
            return gathered(self.blocks(points, own, own), place.reshape(index.shape))
        white = self._chosen(points[:, None, None], index)
        return white @ white.transpose(0, 1, 3, 2)

    def _chosen(self, points, columns):
        return self.values[points, columns]

    def _at(self, point):
        """(l, r) what is kept of a point."""
        return self.values[point]

    def _every(self, kept):
        """(r, K) of what is kept for (r, l) columns."""
        return kept


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
    factors, slow = np.empty((len(grid), *base.shape)), np.empty_like(base)
    for own, (placement, flicker) in zip(factors, grid):
        np.multiply(lateral, placement ** 2, out=own)
        np.multiply(kernel, flicker ** 2, out=slow)
        own += slow
        own += base
        # In its own place; in the order of Fortran a lower factor is an upper one.
        if lapack.dpotrf(own.T, lower=0, clean=0, overwrite_a=1)[1]:
            raise np.linalg.LinAlgError("a covariance that is not positive definite")
    return factors


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
        self._loud, self._given = loud, np.asfortranarray(columns[:, loud])
        self._place = np.full(columns.shape[1], len(loud))
        self._place[loud] = np.arange(len(loud))
        self._slot, self._number = np.full(len(grid), -1), 0

    def __reduce__(self):
        """As factored_gram.FactoredGram's."""
        return type(self), (self.grid, self._across, self._columns, self._loud, self._lower)

    def at(self, point, columns=None):
        every = np.arange(len(self._place)) if columns is None else columns
        return super().at(point, every)

    def _fill(self, points):
        for point in points[self._slot[points] < 0]:
            if self._number == len(self.values):
                self.values = np.concatenate([self.values, np.empty_like(self.values)])
            kept = self.values[self._number]
            kept[:-1] = self._solved(point, self._given, 1).T
            kept[-1] = 0.0
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
