"""Weighted least squares with four columns, solved by hand: Li Eq. 7, P = (X'X)^-1 X'Y.

X holds the measured rows, Y the true ones (Li's sentence below Eq. 7 has them swapped). Rows are
to be of a size near 1 (g, not counts): the condition of X'X is then 3 instead of 9e7, and single
precision is enough. The elimination is Gauss-Jordan with row pivoting. Arrays hold their numbers
unboxed; a list of floats takes four times the heap.
"""

import math
from array import array

DOUBLE = 1.0 + 1e-9 != 1.0
# Part of a column that must remain once the columns before it are taken out.
SMALLEST_PIVOT = 1e-10 if DOUBLE else 1e-5


class SingularSystem(ValueError):
    """The rows do not determine every parameter; the text says which column is missing."""


def eliminate(left, right):
    """The solution of left x = right; left is n x n, symmetric, positive.

    Works on copies, scaled to a unit diagonal. Raises SingularSystem.
    """
    n = len(left)
    scale = array("d", [1.0 / math.sqrt(_positive(left[i][i], i)) for i in range(n)])
    a = []
    for i in range(n):
        row = array("d", left[i])
        for j in range(n):
            row[j] *= scale[i] * scale[j]
        row.extend(array("d", [y * scale[i] for y in right[i]]))
        a.append(row)
    for k in range(n):
        _pivot(a, k)
        for i in range(n):
            if i != k:
                f = a[i][k]
                for j in range(k, len(a[i])):
                    a[i][j] -= f * a[k][j]
    return [[x * scale[i] for x in a[i][n:]] for i in range(n)]


def _positive(d, i):
    if not 0.0 < d < 1e30:
        raise SingularSystem("column %d of the rows is %s: nothing to solve from"
                             % (i + 1, "empty" if d == 0.0 else "not finite"))
    return d


def _pivot(a, k):
    """Bring the largest number of column k to row k and make it 1."""
    p = k
    for i in range(k + 1, len(a)):
        if abs(a[i][k]) > abs(a[p][k]):
            p = i
    if not abs(a[p][k]) > SMALLEST_PIVOT:
        raise SingularSystem("the rows leave column %d undetermined: pivot %.1e, at least %.0e is "
                             "needed" % (k + 1, abs(a[p][k]), SMALLEST_PIVOT))
    a[k], a[p] = a[p], a[k]
    f = 1.0 / a[k][k]
    for j in range(k, len(a[k])):
        a[k][j] *= f


COLUMNS = 4


class NormalEquations:
    """Accumulates X'WX (4 x 4) and X'WY (4 x targets)."""

    def __init__(self, targets):
        self.targets = targets
        self.rows = 0
        self.xx = [array("d", [0.0] * COLUMNS) for _ in range(COLUMNS)]
        self.xy = [array("d", [0.0] * targets) for _ in range(COLUMNS)]

    def add(self, row, truth, weight=1.0):
        """row: 4 measured values, truth: one value per target, weight: 1/variance."""
        self.rows += 1
        for i in range(COLUMNS):
            x = weight * row[i]
            xx = self.xx[i]
            for j in range(COLUMNS):
                xx[j] += x * row[j]
            xy = self.xy[i]
            for j in range(self.targets):
                xy[j] += x * truth[j]

    def solve(self):
        """The 4 x targets parameters. Raises SingularSystem."""
        return eliminate(self.xx, self.xy)

    def inverse(self):
        """(X'WX)^-1, 4 x 4: the covariance when weights are 1/variance."""
        unit = [[1.0 if i == j else 0.0 for j in range(COLUMNS)] for i in range(COLUMNS)]
        return eliminate(self.xx, unit)
