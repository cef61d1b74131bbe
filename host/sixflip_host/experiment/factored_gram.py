"""The products of columns of a long session: the covariance is factored in time (covariance.py),
so that the time and the memory that they take grow as the session does."""
import numpy as np

from ..progress import steps
from . import covariance
from .gram import Products, Whitened

# Share of columns that are not silent from which on none is left out: to gather the others takes a
# copy of the table at every point, to work out a tenth for nothing takes less.
MOSTLY = 0.9


class FactoredGram(Whitened):
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

    def __reduce__(self):
        """What was worked out is worked out again: it is much, and of few points."""
        return type(self), (self.groups, self.grid, self.space, self.common, self._columns)

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

    def at_all_points(self, columns):
        """(G, k, k) of a few columns at every point; nothing is kept of it."""
        products = np.empty((len(self.grid), len(columns), len(columns)))
        done = np.flatnonzero(self._done)
        products[done] = self.blocks(done, columns, columns)
        for points, left in self._products(np.flatnonzero(~self._done), columns):
            products[points] = left
        return products

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
            for point, readings in zip(chosen, back):
                inner[point] = 0.0
                inner[point, self.loud] = loud @ readings
        return quadratic, inner, logdet

    def _chosen(self, points, columns):
        self._fill(points)
        return self.values[points.reshape(-1, *np.ones(np.ndim(columns), int)), columns]

    def _at(self, point):
        self._fill(np.array([point]))
        return self.values[point]

    def _fill(self, points):
        new = np.unique(points[~self._done[points]])
        made = self._left if self._whitened else self._products
        for chosen, left in made(new, self.loud) if len(new) else ():
            for point, kept in zip(chosen, left):
                if isinstance(self.loud, slice):
                    self.values[point] = kept
                    continue
                self.values[point] = 0.0
                if self._whitened:
                    self.values[point, self.loud] = kept
                else:
                    self.values[point][np.ix_(self.loud, self.loud)] = kept
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
