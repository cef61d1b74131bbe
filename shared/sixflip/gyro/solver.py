"""The gyro from the flips: [Ix Iy Iz T] P = true turn, half a turn or none (METHOD 2).

The same four-column least squares as the accelerometer's: scale, misalignment and bias at once,
and the standard errors from how well a hand turns a box by half a turn.
"""

import math

from sixflip.accelerometer.normal_equations import NormalEquations
from sixflip.accelerometer.scale_form import inverse3
from sixflip.gyro.flips import find_flips, integral, mean_rate
from sixflip.poses.faces import AXIS, FACES, SIGN

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
                             "fault": f.fault, "reason": f.reason}


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


# How flat on the table a turned box stays.
FLAT = math.radians(0.1)
# Bias wander within a session, rad/s.
WANDER = math.radians(0.005)
OLD_WEIGHT = 1e3


class GyroscopeResult:
    """P 4 x 3: [wx wy wz 1] P = true rate, rad/s, for row vectors.

    bias_dps [3]  measured rate at rest, deg/s
    sigma 4 x 3, sigma_bias_dps [3]   standard errors
    flips     {"Z+": {"angle_deg", "used", "fault", "reason"}, ...}; the angle by the solved P
    missing   axes 0..2 without a usable flip: P keeps the old matrix there
    wrong_axes  sentence or ""; signs_seen: axes whose sign the moves confirmed
    excess    ([3], standard errors [3]): by what part of half a turn the flips about each axis
              were too long, by the moves between the faces (half_turns.py); None: not known
    hand_deg  how far the flips of an axis disagree, at least 0.4; across_deg: see gyro_spread
    verdict, reason
    """

    excess = None


def solve(placements, moves, lsb_per_dps, accel_P=None, old=None, lsb_per_g=0):
    """What solve_matrix() gives, judged; with lsb_per_g and accel_P held against the moves."""
    from sixflip.gyro.axis_signs import wrong_axes  # a board has phases of their own for these
    from sixflip.gyro.verdict import judge_gyroscope
    r = solve_matrix(placements, moves, lsb_per_dps, accel_P, old)
    r.wrong_axes, r.signs_seen = wrong_axes(placements, moves, lsb_per_dps,
                                            mean_rate(placements, lsb_per_dps))
    r.verdict, r.reason = judge_gyroscope(r)
    if accel_P and lsb_per_g:
        from sixflip.gyro.half_turns import excess
        r.excess = excess(placements, moves, lsb_per_g, r, accel_P)
    return r


def solve_matrix(placements, moves, lsb_per_dps, accel_P=None, old=None):
    """Solve from a session's placements and moves. ValueError without gyro or rests.

    accel_P  the accelerometer's P: where its chip sits crooked, so does the gyro
    old      4 x 3 P of an earlier record, kept for axes that were not flipped; None: nominal
    """
    if not lsb_per_dps > 0:
        raise ValueError("no gyro: expected its LSB per deg/s")
    if not [1 for p in placements if any(p.sums[3:6]) or any(p.noise[3:6])]:
        raise ValueError("no gyro: every reading is zero")
    r = GyroscopeResult()
    bias = mean_rate(placements, lsb_per_dps)
    flips = find_flips(placements, moves, lsb_per_dps, bias, accel_P and accel_P[:3])
    used = [f for f in flips if f.used]
    r.missing = [k for k in range(3) if not [1 for f in used if AXIS[f.face] == k]]
    rows = _rest_rows(placements, lsb_per_dps, bias) + [_flip_row(f) for f in used]
    if r.missing:
        rows += _old_rows(old, r.missing)
    equations = NormalEquations(3)
    for row, truth, variance in rows:
        equations.add(row, truth, HAND * HAND / variance[3])
    r.P = equations.solve()
    angles(r, flips)
    spread(r, rows, used, equations.inverse(), bias)
    # The bias was taken out beforehand, so that columns do not resemble each other.
    for j in range(3):
        r.P[3][j] -= sum([bias[k] * r.P[k][j] for k in range(3)])
    return r


def _rest_rows(placements, lsb_per_dps, bias):
    """(row, truth, variance per target and for the weight): nothing turned."""
    rows = []
    for p in placements:
        if not p.n > 0:
            continue
        read, T = integral(p.sums[3:6], p.n, p.duration_us, lsb_per_dps)
        noise = [math.radians(x / lsb_per_dps) * T / math.sqrt(p.n) for x in p.noise[3:6]]
        v = [x * x + (WANDER * T) ** 2 for x in noise]
        rows.append(([read[k] - bias[k] * T for k in range(3)] + [T], [0.0] * 3, v + [max(v)]))
    return rows


def _flip_row(flip):
    k = AXIS[flip.face]
    truth = [0.0] * 3
    truth[k] = SIGN[flip.face] * flip.along * math.pi
    v = [FLAT * FLAT] * 3 + [HAND * HAND]
    v[k] = HAND * HAND
    return flip.turned + [flip.T], truth, v


def _old_rows(old, missing):
    """What half a turn about each missing axis would have read, by the old matrix."""
    nominal = [[1.0 if i == j else 0.0 for j in range(3)] for i in range(3)]
    A = inverse3([row[:3] for row in old[:3]]) if old else nominal
    v = [HAND * HAND / OLD_WEIGHT] * 4
    return [([math.pi * A[k][j] for j in range(3)] + [0.0],
             [math.pi * x for x in nominal[k]], v) for k in missing]
