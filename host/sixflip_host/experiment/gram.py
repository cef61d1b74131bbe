"""What columns S say together, the products S' C^-1 S, at the points of a grid of noise levels.

C is the covariance of the readings at one point of the grid. A search looks at few points, near
the levels that the data has, and at few columns at a time; the products of all columns would cost
more than everything else there. So what is kept of a point is made when it is first asked for:
the whitened columns, of which any products are a short sum, or the products themselves. Where
there are few readings, one matrix of all of them is factored at each point, across what is
projected out (DenseGram); the covariance of a long session is factored in time (factored_gram.py).
"""
from functools import cached_property

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
    """Products of K whitened columns of r contrasts each, of which whoever inherits from this
    makes those that are asked for. Those of a hypothesis' own columns with one another are kept: a
    search asks for them again beside every set."""

    def __init__(self, values):
        super().__init__(values)
        self._own = {}

    def blocks(self, points, rows, columns):
        if not len(rows) or not len(columns):
            return np.zeros((len(points), len(rows), len(columns)))
        others = self._chosen(points, columns)
        own = others if rows is columns else self._chosen(points, rows)
        return own @ others.transpose(0, 2, 1)

    def rows(self, points, rows):
        own = self._chosen(points, rows)
        return np.stack([self._every(white @ self._at(point).T)
                         for point, white in zip(points, own)])

    def each(self, points, index):
        size = index.shape[1]
        kept = self._own.setdefault(size, _Kept(len(self.grid), size))
        places = kept.places(index)
        new = ~kept.done[points[:, None], places]
        if new.any():
            own, asked = np.flatnonzero(new.any(axis=0)), points[new.any(axis=1)]
            kept.values[asked[:, None], places[own]] = self._each(asked, index[own])
            kept.done[asked[:, None], places[own]] = True
        return kept.values[points[:, None], places]

    def _each(self, points, index):
        if not index.size:
            return np.zeros((len(points), *index.shape, index.shape[1]))
        own, place = np.unique(index, return_inverse=True)
        if len(own) ** 2 < index.size * index.shape[1]:  # most columns are in most of them
            return gathered(self.blocks(points, own, own), place.reshape(index.shape))
        white = self._chosen(points, index)
        return white @ white.transpose(0, 1, 3, 2)

    def _chosen(self, points, columns):
        """(P, ..., r) columns (...), one or more, at points (P,), whitened."""
        raise NotImplementedError

    def _at(self, point):
        """(l, r) what there is to keep of a point: all columns, whitened."""
        raise NotImplementedError

    def _every(self, kept):
        """(r, K) of what is kept for (r, l) columns."""
        return kept


class _Kept:
    """(G, N, k, k) products of sets of k columns each, with room for N of them, and at which
    points they are done."""

    def __init__(self, points, size):
        self.values, self.done = np.empty((points, 0, size, size)), np.zeros((points, 0), bool)
        self._places = {}

    def places(self, index):
        """(F,) which of the N the sets of columns index (F, k) are; a place for those that are
        new."""
        found = [self._places.setdefault(row.tobytes(), len(self._places)) for row in index]
        room = self.done.shape[1]
        if len(self._places) > room:
            more = max(len(self._places), 2 * room) - room
            self.values, self.done = (
                np.concatenate([kept, np.zeros((len(kept), more, *kept.shape[2:]), kept.dtype)],
                               axis=1) for kept in (self.values, self.done))
        return np.array(found, int)


def dense_products(groups, grid, space, common, columns):
    """DenseGram of columns (m, K). grid: list of (placement level, flicker level); space (m, p)
    orthonormal, projected out; common (m, c), coefficients known to 1."""
    across = np.linalg.qr(space, mode="complete")[0][:, space.shape[1]:]
    loud = np.flatnonzero((columns != 0.0).any(axis=0))
    return DenseGram(groups, grid, across, common, across.T @ columns, loud)


def _factors(groups, grid, across, common):
    """(G, r, r) lower factors of the covariance at all points; what is above them is not
    zero, but not read. LinAlgError where a covariance is not positive definite."""
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
    which of the columns are not zero; the others as dense_products() has them. The covariance is
    factored when it is first asked for, which is LinAlgError where it is not positive definite.
    Of a point (l + 1, r) are kept: the l loud columns, whitened when they are first asked for,
    and zero for all others. A search asks for all of them at few points, and for few at the others
    around. (Beside which others a column is whitened shows in its last digit.)
    """

    def __init__(self, groups, grid, across, common, columns, loud):
        super().__init__(None)
        self.groups, self.grid, self._across, self._common = groups, grid, across, common
        self._columns, self._loud = columns, loud
        self._given = np.asfortranarray(columns[:, loud])
        self._place = np.full(columns.shape[1], len(loud))
        self._place[loud] = np.arange(len(loud))
        self._kept, self._done = {}, np.zeros((len(grid), len(loud) + 1), bool)

    def __reduce__(self):
        """As factored_gram.FactoredGram's."""
        return type(self), (self.groups, self.grid, self._across, self._common, self._columns,
                            self._loud)

    @cached_property
    def _lower(self):
        return _factors(self.groups, self.grid, self._across, self._common)

    def at(self, point, columns=None):
        every = np.arange(len(self._place)) if columns is None else columns
        return super().at(point, every)

    def _fill(self, points, places):
        """Whiten the columns at these places (k,) at points (P,) where they are not yet."""
        for at in np.flatnonzero(~self._done[points[:, None], places].all(axis=1)):
            point, last = points[at], len(self._loud)
            if point not in self._kept:
                self._kept[point] = np.empty((last + 1, self._given.shape[0]))
                self._kept[point][last] = 0.0
                self._done[point, last] = True
            new = np.unique(places[~self._done[point, places]])
            self._kept[point][new] = self._solved(
                point, self._given if len(new) == last else self._given[:, new], 1).T
            self._done[point, new] = True

    def _chosen(self, points, columns):
        places = self._place[columns]
        self._fill(points, places.ravel())
        chosen = np.empty((len(points), *places.shape, self._given.shape[0]))
        for white, point in zip(chosen, points):
            np.take(self._kept[point], places, axis=0, out=white, mode="clip")
        return chosen

    def _at(self, point):
        self._fill(np.array([point]), np.arange(len(self._loud) + 1))
        return self._kept[point]

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
