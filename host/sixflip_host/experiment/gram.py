"""What columns S say together, the products S' C^-1 S, at the points of a grid of noise levels.

C is the covariance of the readings at one point of the grid. A search looks at few points, near
the levels that the data has, and at few columns at a time; the products of all columns would cost
more than everything else there. So what is kept of a point is made when it is first asked for:
the whitened columns, of which any products are a short sum (dense_gram.py, and factored_gram.py
where a session has fewer contrasts than there are columns), or the products themselves.
"""
import numpy as np


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
