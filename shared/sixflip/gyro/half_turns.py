"""Were the flips half turns? The moves from face to face tell: they begin and end at gravity.

All flips short by one angle look like another scale of the gyro and another tilt of the table.
A move between two faces does not: its rotation must carry gravity of the rest before to that
of the rest after (METHOD 2). About each axis of the box the flips turned by pi (1 + x), x three
unknowns; people err alike on all faces, give or take the hand: x = common + hand.
"""

import math

from sixflip import STANDARD_G
from sixflip.accelerometer.normal_equations import NormalEquations
from sixflip.accelerometer.scale_form import inverse3
from sixflip.accelerometer.six_faces import corrected
from sixflip.poses.faces import face_of_code
from sixflip.poses.placement import COARSE, FINE, has_gap

# A move's gravity is met no better than this: windows of a quarter of a second, a hand that
# wobbles by 10 degrees. Measured over healthy sessions by tests/studies/bench/mistakes.py.
MOVE = math.radians(0.3)


def excess(placements, moves, lsb_per_g, r, accel_P):
    """([x of three axes], [standard error of each]) or None where no move tells.

    r  GyroscopeResult, its matrix from half turns; accel_P: 4 x 4, m/s2
    """
    try:
        turned = Turned(r.P)
        rows = []
        for m in moves:
            if not m.path or m.before < 0 or m.after < 0 or m.saturated or has_gap(m):
                continue
            ends = (placements[m.before], placements[m.after])
            if min([face_of_code(p.pose) for p in ends]) >= 0:
                rows += turned.rows(m.path, [_gravity(p, lsb_per_g, accel_P) for p in ends])
        return _solve(rows, r)
    except ValueError:
        return None


def _solve(rows, r):
    """Least squares for x of three axes and what they have in common."""
    hand = r.hand_deg / 180.0 / math.sqrt(2.0)  # of two flips' mean
    scatter = MOVE
    for _ in range(2):
        equations = NormalEquations(1)
        for row, left in rows:
            equations.add(row, [left])
        for k in range(3):
            row = [0.0, 0.0, 0.0, -1.0]
            row[k] = 1.0
            off = scatter if k in r.missing else scatter / hand
            equations.add(row, [0.0], off * off)
        x = [v[0] for v in equations.solve()]
        square = 0.0
        for row, left in rows:
            left -= sum([row[k] * x[k] for k in range(3)])
            square += left * left
        # two numbers a move, less three unknowns
        scatter = max(MOVE, math.sqrt(square / max(1.0, len(rows) / 1.5 - 3.0)))
    covariance = equations.inverse()
    return x[:3], [scatter * math.sqrt(covariance[k][k]) for k in range(3)]


def _gravity(p, lsb_per_g, accel_P):
    """Unit vector, box axes."""
    # the place's own gravity moves a direction by a thousandth of a bias
    v = corrected(accel_P, [s * STANDARD_G / (p.n * lsb_per_g) for s in p.sums[:3]])
    n = math.sqrt(sum([a * a for a in v]))
    return [a / n for a in v]


class Turned:
    """The gyro's matrix as rotation Q (chip to box) and what is left of it, D = Q'C - 1."""

    def __init__(self, P):
        self.C = [[P[j][i] for j in range(3)] for i in range(3)]
        Q = self.C
        for _ in range(6):  # Newton's iteration to the nearest rotation (Higham 1986)
            inverse = inverse3(Q)
            Q = [[0.5 * (Q[i][j] + inverse[j][i]) for j in range(3)] for i in range(3)]
        self.Q = Q
        self.D = [[sum([Q[m][i] * self.C[m][j] for m in range(3)]) - (1.0 if i == j else 0.0)
                   for j in range(3)] for i in range(3)]

    def rows(self, path, gravities):
        """[([change with x of three axes, 0], what is left)] of the gravity at a move's start."""
        start, end = [[sum([self.Q[m][i] * g[m] for m in range(3)]) for i in range(3)]
                      for g in gravities]
        v = [sum([path[3 * i + k] * end[k] for k in range(3)]) / FINE for i in range(3)]
        turn = _change(path, self.D)
        once = _cross(turn, v)
        twice = _cross(turn, once)
        v = [v[i] + once[i] + 0.5 * twice[i] for i in range(3)]
        by_axis = [_cross(_change(path, [[self.Q[k][i] * self.C[k][j] for j in range(3)]
                                         for i in range(3)]), v) for k in range(3)]
        return [([by_axis[k][i] for k in range(3)] + [0.0], start[i] - v[i]) for i in range(3)]


def _change(path, D):
    """J D: what the start of the path sees turn more."""
    return [sum([path[9 + 9 * row + 3 * i + j] * D[i][j] for i in range(3) for j in range(3)])
            / COARSE for row in range(3)]


def _cross(a, b):
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]
