"""Weighted least squares with four columns, solved by hand: Li Eq. 7, P = (X'X)^-1 X'Y.

X holds the measured rows, Y the true ones (Li's sentence below Eq. 7 has them swapped).
Bring rows to a size near 1 (g, not counts): the condition is then 3 instead of 9e7 and
single precision is enough.
"""

from array import array

from sixflip.elimination import eliminate

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
