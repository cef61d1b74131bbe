"""Sessions made by turning vectors forwards, for the solvers' tests; knows none of their code.

A session is a list of placements of a box on a tilted table, read by a sensor with known
errors: measured = M true + b, in g, rounded to exact sums of counts.
"""

import math

from sixflip.poses.placement import Move, Placement

UP = ((0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
IDEAL = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
LSB = 16384.0


class Dice:
    """Uniform and Gaussian numbers, the same on every interpreter (Park, Miller 1988)."""

    def __init__(self, seed):
        self.state = seed * 7919 % 2147483646 + 1
        for _ in range(10):
            self.uniform()

    def uniform(self):
        # 16807 x below 2^31 by Schrage's parts, so that no big integer is needed.
        x = 16807 * (self.state % 127773) - 2836 * (self.state // 127773)
        self.state = x if x > 0 else x + 2147483647
        return self.state / 2147483647.0

    def gauss(self):
        return sum([self.uniform() for _ in range(12)]) - 6.0


def turned(v, axis, angle):
    """v turned right-handed about a unit axis (Rodrigues)."""
    c, s = math.cos(angle), math.sin(angle)
    cross = (axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2],
             axis[0] * v[1] - axis[1] * v[0])
    dot = sum([axis[k] * v[k] for k in range(3)])
    return [c * v[k] + s * cross[k] + (1 - c) * dot * axis[k] for k in range(3)]


def tilted(face, deg, direction):
    """Unit gravity in the body on a table tilted by deg, towards direction (rad)."""
    k = [abs(x) for x in UP[face]].index(1)
    i, j = (k + 1) % 3, (k + 2) % 3
    v = [x * math.cos(math.radians(deg)) for x in UP[face]]
    v[i] = math.sin(math.radians(deg)) * math.cos(direction)
    v[j] = math.sin(math.radians(deg)) * math.sin(direction)
    return v


def gravities(tilt_deg=0.0, flip_deg=None):
    """{pose code: unit gravity}; flip_deg {face: turn from a to b}."""
    out = {}
    for face in range(6):
        a = tilted(face, tilt_deg, 0.7 * face + 0.3)
        turn = math.radians(flip_deg.get(face, 180.0) if flip_deg else 180.0)
        out[2 * face + 1] = a
        # The box turns by +turn, so what it sees of the world turns by -turn.
        out[2 * face + 2] = turned(a, UP[face], -turn)
    return out


def read(v, M, b):
    return [sum([M[i][k] * v[k] for k in range(3)]) + b[i] for i in range(3)]


def placements(poses, M=IDEAL, b=(0, 0, 0), noise_g=0.0, lsb=LSB, n=400, seed=1, across=0.0):
    """A Placement for each pose code; noise on the mean, `across` g of placing scatter."""
    dice = Dice(seed)
    out = []
    for code in sorted(poses):
        v = list(poses[code])
        if across:
            face = (code - 1) // 2
            v = [x + (0.0 if u else across * dice.gauss()) for x, u in zip(v, UP[face])]
        m = [x + noise_g / math.sqrt(n) * dice.gauss() for x in read(v, M, b)]
        sums = [int(round(x * lsb * n)) for x in m]
        counts = max(noise_g * lsb, 0.5)
        out.append(Placement(code, 650 * len(out), n, sums + [4 * n, -3 * n, 2 * n, 0],
                             [counts] * 3 + [3.0] * 3, 10000 * n))
    return out


def vector_error_mg(P, g, M=IDEAL, b=(0, 0, 0)):
    """RMS over all directions of the corrected minus the true vector, mg."""
    total = 0.0
    for j in range(3):
        for k in range(3):
            gain = sum([M[i][k] * P[i][j] for i in range(3)]) - (1 if j == k else 0)
            total += gain * gain / 3
        offset = sum([b[i] * P[i][j] for i in range(3)]) + P[3][j] / g
        total += offset * offset
    return 1000 * math.sqrt(total)


GYRO_LSB = 65.5
# Quarter turns about x, y and z among the moves: every sign is seen.
ORDER = (1, 2, 5, 6, 9, 10, 3, 4, 7, 8, 11, 12)


def _angle_between(before, after, face, other, hand, dice):
    """Rotation vector of one move, rad: a flip either way, a quarter or half turn."""
    if face == other:
        way = 1 if dice.uniform() > 0.5 else -1
        return [way * (math.pi + hand * dice.gauss()) * u for u in UP[face]]
    u, w = UP[face], UP[other]
    e = [w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]]
    if not any(e):
        return [math.pi * x for x in (u[1], u[2], u[0])]
    return [0.5 * math.pi * x for x in e]


def gyro_session(M=IDEAL, bias_dps=(0, 0, 0), hand_deg=0.0, noise_dps=0.0, lsb=GYRO_LSB, seed=1,
                 order=ORDER):
    """(placements, moves) of a session with a gyro that reads M true + bias."""
    dice = Dice(seed)
    rests, moves = [], []

    def counts(angles, seconds, n):
        w = [math.degrees(a) / seconds for a in angles]
        return [int(round(n * lsb * (x + c) + math.sqrt(n) * lsb * noise_dps * dice.gauss()))
                for x, c in zip(read(w, M, (0, 0, 0)), bias_dps)]

    for number, code in enumerate(order):
        face = (code - 1) // 2
        if number:
            before = order[number - 1]
            angles = _angle_between(before, code, (before - 1) // 2, face,
                                    math.radians(hand_deg), dice)
            moves.append(Move(number - 1, number, 650 * number - 250, 250,
                              counts(angles, 2.5, 250), 2500000, [0] * 4, False, 10000))
        accel = [int(6553600 * x) for x in UP[face]]
        rests.append(Placement(code, 650 * number, 400, accel + counts((0, 0, 0), 4.0, 400) + [0],
                               [30.0] * 3 + [max(noise_dps * lsb, 0.5)] * 3, 4000000))
    return rests, moves
