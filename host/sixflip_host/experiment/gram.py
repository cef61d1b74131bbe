"""What columns say together, S' C^-1 S, at the points of a grid of noise levels.

A search looks at few points of the grid, near the levels that the data has, and at few columns at
a time; a matrix of all columns costs more than all else there. What is kept of a point is made
when it is first asked for, and is the smaller one: where a session has fewer contrasts than there
are columns, the whitened columns themselves, of which any products are a short sum; in a longer
one the products.
"""
import numpy as np
from scipy.linalg import lapack

from ..progress import steps
from . import covariance

MOSTLY = 0.9  # share of columns that are not silent from which on none is left out


class Products:
    """Products that are there already: values (G, K, K)."""

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

    def each(self, points, index):
        """(P, F, k, k) products of columns index (F, k) with one another."""
        return gathered(self.values, index, points)


def gathered(values, index, points=None):
    """(P, F, k, k) of values (P, K, K) at places index (F, k) with one another; points (P,): of
    values (G, K, K)."""
    points = np.arange(len(values)) if points is None else points
    return values[points[:, None, None, None], index[:, :, None], index[:, None, :]]


def of(groups, grid, space, common, columns):
    """Grams, or FewGrams of few readings."""
    kind = FewGrams if len(columns) <= covariance.FEW else Grams
    return kind(groups, grid, space, common, columns)


class Whitened(Products):
    """Products of whitened columns: values (G, K, r), those of a point there after _fill."""

    def blocks(self, points, rows, columns):
        if len(rows) and len(columns):
            self._fill(points)
        others = self._chosen(points[:, None], columns)
        own = others if rows is columns else self._chosen(points[:, None], rows)
        return own @ others.transpose(0, 2, 1)

    def rows(self, points, rows):
        self._fill(points)
        own = self._chosen(points[:, None], rows)
        return np.stack([self._every(one @ self._at(point).T)
                         for point, one in zip(points, own)])

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


class FewGrams(Whitened):
    """The same as Grams of few readings: one matrix of all of them, across what is projected out.
    values (P, l + 1, r): the columns that say anything, whitened, and zero for all others, at the
    points asked for so far, in their order: room for half of all at first, which is more than a
    search needs, since memory that was just given back costs nothing to take again, and a larger
    piece is always new."""

    def __init__(self, groups, grid, space, common, columns):
        self.grid = grid
        self._across = np.linalg.qr(space, mode="complete")[0][:, space.shape[1]:]
        self._columns = self._across.T @ columns
        loud = np.flatnonzero((columns != 0.0).any(axis=0))
        self._given = np.asfortranarray(self._columns[:, loud])
        self._place = np.full(columns.shape[1], len(loud))
        self._place[loud] = np.arange(len(loud))
        super().__init__(np.empty(((len(grid) + 1) // 2, len(loud) + 1, len(self._columns))))
        self._slot, self._number = np.full(len(grid), -1), 0
        self._lower = self._factors(groups, common)

    def at(self, point, columns=None):
        every = np.arange(len(self._place)) if columns is None else columns
        return super().at(point, every)

    def _factors(self, groups, common):
        """(G, r, r) lower factors of the covariance at all points; what is above them is not
        zero, but not read."""
        base, lateral, kernel = covariance.components(groups)
        base, lateral, kernel = (self._across.T @ part @ self._across
                                 for part in (base + common @ common.T, lateral, kernel))
        out, slow = np.empty((len(self.grid), *base.shape)), np.empty_like(base)
        for own, (placement, flicker) in zip(out, self.grid):
            np.multiply(lateral, placement ** 2, out=own)
            np.multiply(kernel, flicker ** 2, out=slow)
            own += slow
            own += base
            # In its own place; in the order of Fortran a lower factor is an upper one.
            if lapack.dpotrf(own.T, lower=0, clean=0, overwrite_a=1)[1]:
                raise np.linalg.LinAlgError("a covariance that is not positive definite")
        return out

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

    def of(self, columns):
        """(G, k, k) of a few columns at every point; nothing is kept of it."""
        given = np.asfortranarray(self._columns[:, columns])
        white = np.stack([self._solved(point, given, 1) for point in range(len(self.grid))])
        return white.transpose(0, 2, 1) @ white

    def statistics(self, z, points=None):
        """As Grams.statistics."""
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


class Grams(Whitened):
    """Products of K columns at the G points of a grid, each point worked out when it is first
    asked for. values: the products, or (G, K, rows) the columns that they are the products of."""

    def __init__(self, groups, grid, space, common, columns):
        """grid: list of (placement level, flicker level); space (m, p) orthonormal, projected out;
        common (m, c), coefficients known to 1; columns (m, K)."""
        self.groups, self.grid = groups, grid
        loud = (columns != 0.0).any(axis=0)  # what the others say is zero
        most = np.count_nonzero(loud) >= MOSTLY * len(loud)
        self.loud = slice(None) if most else np.flatnonzero(loud)
        self.fixed, self.known = space.shape[1] + common.shape[1], space.shape[1]
        self.space, self.common, self._columns = space, common, columns
        rows, size = len(columns) + common.shape[1], columns.shape[1]
        self._whitened = rows < np.count_nonzero(loud)
        # Memory that is never written to is never taken.
        super().__init__(np.empty((len(grid), size, rows if self._whitened else size)))
        self._done = np.zeros(len(grid), bool)
        self._factors = {}

    def __len__(self):
        return len(self.grid)

    def blocks(self, points, rows, columns):
        if self._whitened:
            return super().blocks(points, rows, columns)
        self._fill(points)
        return Products.blocks(self, points, rows, columns)

    def rows(self, points, rows):
        if self._whitened:
            return super().rows(points, rows)
        self._fill(points)
        return Products.rows(self, points, rows)

    def each(self, points, index):
        if self._whitened:
            return super().each(points, index)
        self._fill(points)
        return Products.each(self, points, index)

    def of(self, columns):
        """(G, k, k) of a few columns at every point; nothing is kept of it."""
        out = np.empty((len(self.grid), len(columns), len(columns)))
        done = np.flatnonzero(self._done)
        out[done] = self.blocks(done, columns, columns)
        for points, left in self._products(np.flatnonzero(~self._done), columns):
            out[points] = left
        return out

    def statistics(self, z, points=None):
        """(quadratic (G, R), inner (G, K, R), logdet (G,)) of contrasts z (m, R), what is fixed
        projected out in the metric of each point of the grid; points: which are asked for (None:
        all), at the others quadratic and logdet are NaN, inner is 0. z is whitened, and whitened
        back: the columns need not be."""
        size, number = self._columns.shape[1], z.shape[1]
        quadratic, logdet = np.full((len(self), number), np.nan), np.full(len(self), np.nan)
        inner = np.zeros((len(self), size, number))
        loud = self._columns[:, self.loud].T
        given = np.hstack([self.space, self.common, z])
        wanted = np.arange(len(self)) if points is None else points
        for chosen, factor in steps(self._of_flicker(wanted), "levels of noise"):
            white = factor.whitened(given)
            fixed, data = white[:, :, :self.fixed], white[:, :, self.fixed:]
            metric = self._metric(fixed.transpose(0, 2, 1) @ fixed)
            its = np.linalg.solve(metric, fixed.transpose(0, 2, 1) @ data)
            quadratic[chosen] = (data ** 2).sum(axis=1) - (its ** 2).sum(axis=1)
            logdet[chosen] = factor.logdet + np.log(
                np.diagonal(metric, axis1=1, axis2=2)).sum(axis=1)
            left = data - fixed @ np.linalg.solve(metric.transpose(0, 2, 1), its)
            back = factor.whitened_back(left)
            for point, one in zip(chosen, back):
                inner[point] = 0.0
                inner[point, self.loud] = loud @ one
        return quadratic, inner, logdet

    def _fill(self, points):
        new = np.unique(points[~self._done[points]])
        made = self._left if self._whitened else self._products
        for chosen, left in made(new, self.loud) if len(new) else ():
            for point, one in zip(chosen, left):
                if isinstance(self.loud, slice):
                    self.values[point] = one
                    continue
                self.values[point] = 0.0
                if self._whitened:
                    self.values[point, self.loud] = one
                else:
                    self.values[point][np.ix_(self.loud, self.loud)] = one
            self._done[chosen] = True

    def _left(self, points, columns):
        """Pairs of points of one flicker level and (points, k, m + c) these columns whitened,
        without space and common: what is left of them, and below it what the coefficients of
        common, known to 1, would have to be, so that the products of both are those asked for."""
        given = np.hstack([self.space, self.common, self._columns[:, columns]])
        f = self.fixed
        for chosen, factor in self._of_flicker(points):
            white = factor.whitened(given)
            fixed, left = white[:, :, :f], white[:, :, f:]
            lower = self._metric(fixed.transpose(0, 2, 1) @ fixed)
            inverse = np.linalg.inv(lower)
            its = inverse.transpose(0, 2, 1) @ (inverse @ (fixed.transpose(0, 2, 1) @ left))
            left = np.concatenate([left - fixed @ its, its[:, self.known:]], axis=1)
            yield chosen, left.transpose(0, 2, 1)

    def _products(self, points, columns):
        """Pairs of points of one flicker level and (points, k, k) products of these columns,
        whitened, without space and common."""
        every = np.hstack([self.space, self.common, self._columns[:, columns]])
        f = self.fixed
        for chosen, factor in self._of_flicker(points):
            products = 0.0
            for white in factor.whitened_parts(every):
                products = products + white.transpose(0, 2, 1) @ white
            own = np.linalg.solve(self._metric(products[:, :f, :f]), products[:, :f, f:])
            left = products[:, f:, f:]
            left -= own.transpose(0, 2, 1) @ own
            yield chosen, left

    def _metric(self, products):
        """Lower factors of the whitened space and common columns' products (points, f, f), the
        coefficients of the latter known to 1."""
        return np.linalg.cholesky(products + np.diag(np.arange(self.fixed) >= self.known))

    def _of_flicker(self, points):
        """Pairs of points of one flicker level and the covariance.Factor at them."""
        placements = list(dict.fromkeys(a for a, _ in self.grid))
        flickers = np.array([self.grid[p][1] for p in points])
        for level in dict.fromkeys(flickers.tolist()):
            chosen = points[flickers == level]
            if level not in self._factors:
                self._factors[level] = covariance.Factor(self.groups, placements, level)
            yield chosen, self._factors[level].at(
                [placements.index(self.grid[p][0]) for p in chosen])
