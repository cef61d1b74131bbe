"""How well the gyro is known: the flips by the solved matrix, and the standard errors."""

import math

from sixflip.faces import AXIS, FACES
from sixflip.scale_form import inverse3

HAND = math.radians(0.4)  # how well a hand turns by half a turn


def angles(r, flips):
    """The angle of every flip by the solved matrix; a face's last usable flip speaks. across_deg:
    the most that a used one turned about another axis."""
    r.flips = {}
    r.across_deg = 0.0
    for f in flips:
        k = AXIS[f.face]
        name = FACES[f.face]
        turn = sum([f.turned[i] * r.P[i][k] for i in range(3)]) + f.T * r.P[3][k]
        f.left = abs(turn) - math.pi
        for j in range(3):
            if f.used and j != k:
                across = sum([f.turned[i] * r.P[i][j] for i in range(3)]) + f.T * r.P[3][j]
                r.across_deg = max(r.across_deg, abs(math.degrees(across)))
        if f.used or not r.flips.get(name, {"used": False})["used"]:
            r.flips[name] = {"angle_deg": math.degrees(abs(turn)), "used": f.used,
                             "reason": f.reason}


def spread(r, rows, used, c, bias):
    """Standard errors: a hand no better than 0.4 degrees, worse when its flips disagree."""
    free = len(used) - (3 - len(r.missing))
    square = sum([f.left * f.left for f in used]) / free if free > 0 else 0.0
    square = max(square, HAND * HAND)
    r.hand_deg = math.degrees(math.sqrt(square))
    var = [[0.0] * 3 for _ in range(5)]
    for row, truth, v in rows:
        h = [HAND * HAND / v[3] * sum([c[i][j] * row[j] for j in range(4)]) for i in range(4)]
        offset = h[3] - sum([bias[k] * h[k] for k in range(3)])
        for j in range(3):
            d = square if truth[j] and v[j] == HAND * HAND else v[j]
            for i, x in enumerate(h[:3] + [offset, h[3]]):
                var[i][j] += x * x * d
    r.sigma = [[math.sqrt(x) for x in row] for row in var[:4]]
    A = inverse3([row[:3] for row in r.P[:3]])
    r.bias_dps = [math.degrees(bias[j] - sum([r.P[3][k] * A[k][j] for k in range(3)]))
                  for j in range(3)]
    r.sigma_bias_dps = [math.degrees(math.sqrt(
        sum([A[k][j] * A[k][j] * var[4][k] for k in range(3)]))) for j in range(3)]
