"""What columns say together, S' C^-1 S, at the points of a grid of noise levels.

A search looks at few points of the grid, near the levels that the data has, and a matrix of all
columns costs more than all else there: it is worked out where it is asked for, once.
"""
import numpy as np

from . import covariance


class Grams:
    """An array (G, K, K) of which each point of the grid is worked out when it is first asked
    for: an index as of such an array, whose first part says which points."""

    def __init__(self, groups, grid, space, common, columns):
        """grid: list of (placement level, flicker level); space (m, p) orthonormal, projected out;
        common (m, c), coefficients known to 1; columns (m, K)."""
        self.groups, self.grid = groups, grid
        self.loud = np.flatnonzero((columns != 0.0).any(axis=0))  # the others stay zero
        self.fixed, self.known = space.shape[1] + common.shape[1], space.shape[1]
        self.space, self.common, self._columns = space, common, columns
        size = columns.shape[1]
        # Memory that is never written to is never taken.
        self._values = np.empty((len(grid), size, size))
        self._done = np.zeros(len(grid), bool)

    def __len__(self):
        return len(self.grid)

    def __getitem__(self, index):
        points, *columns = index if isinstance(index, tuple) else (index,)
        if all(np.size(one) for one in columns) and not self._done[points].all():
            self._fill(np.atleast_1d(np.arange(len(self.grid))[points]).ravel())
        return self._values[index]

    def of(self, columns):
        """(G, k, k) of a few columns at every point; nothing is kept of it."""
        out = np.empty((len(self.grid), len(columns), len(columns)))
        out[self._done] = self._values[np.ix_(self._done, columns, columns)]
        for points, white in self._whitened(np.flatnonzero(~self._done), columns):
            out[points] = np.stack([self.left(one.T @ one) for one in white])
        return out

    def put(self, point, products):
        """Keep what a point has: products of the whitened space, common and loud columns."""
        self._values[point] = 0.0
        self._values[point][np.ix_(self.loud, self.loud)] = self.left(products)
        self._done[point] = True

    def metric(self, products):
        """(f, f) lower factor of the whitened space and common columns' products, the coefficients
        of the latter known to 1."""
        f = self.fixed
        return np.linalg.cholesky(products[:f, :f] + np.diag(np.arange(f) >= self.known))

    def left(self, products):
        """(k, k) products of whitened columns (f + k, f + k) with the first f taken out."""
        f = self.fixed
        own = np.linalg.solve(self.metric(products), products[:f, f:])
        return products[f:, f:] - own.T @ own

    def _fill(self, points):
        missing = np.unique(points[~self._done[points]])
        for chosen, white in self._whitened(missing, self.loud):
            for point, one in zip(chosen, white):
                self.put(point, one.T @ one)

    def _whitened(self, points, columns):
        """Pairs of points of one flicker level and (points, m, f + k) whitened columns."""
        if not len(points):
            return
        every = np.hstack([self.space, self.common, self._columns[:, columns]])
        flickers = np.array([self.grid[p][1] for p in points])
        for level in dict.fromkeys(flickers.tolist()):
            chosen = points[flickers == level]
            factor = covariance.Factor(self.groups, [self.grid[p][0] for p in chosen], level)
            yield chosen, factor.whitened(every)
