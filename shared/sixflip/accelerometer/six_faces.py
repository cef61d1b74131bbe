"""P from the means of poses: the paper's average of each flip, and ours with the table's tilt
solved.

METHOD 1. All vectors are in g in the box's axes, u is a face's own axis. The two captures of a
face differ by a half turn about u, so half the difference of their corrected means, less its
part along u, is what gravity has across u: the table's tilt. With it in the true vectors P is
solved again, until it stands still. Pose codes are those of sixflip/poses/faces.py.
"""

import math
from array import array

from sixflip.accelerometer.normal_equations import DOUBLE, NormalEquations, SingularSystem
from sixflip.poses.faces import AXIS, SIGN, face_of_code


def in_plane(a, b, face, angle=None):
    """What gravity has across face's axis in capture a, and in b: two 3-vectors, g.

    a, b    corrected means of the two captures, g
    angle   turn of the box from a to b, rad, right-handed about u; None is half a turn

    h = (I - R(-angle))^-1 (a - b), and R(-angle) h = h - (a - b).
    """
    k = AXIS[face]
    d = [a[i] - b[i] for i in range(3)]
    d[k] = 0.0
    h = [0.5 * x for x in d]
    if angle is not None:
        # sin/(1 - cos) is the cotangent of half the angle: 0 for half a turn.
        f = 0.5 * SIGN[face] * math.cos(0.5 * angle) / math.sin(0.5 * angle)
        i, j = (k + 1) % 3, (k + 2) % 3
        h[i] += f * d[j]
        h[j] -= f * d[i]
    return array("d", h), array("d", [h[i] - d[i] for i in range(3)])


def upright(face, across=None):
    """Unit gravity with the part `across` the face's axis (None: a level table)."""
    k = AXIS[face]
    truth = [0.0, 0.0, 0.0] if across is None else list(across)
    s = truth[0] * truth[0] + truth[1] * truth[1] + truth[2] * truth[2]
    # A box on its edge has no tilt: keep the root real, the residuals will tell.
    truth[k] = SIGN[face] * math.sqrt(1.0 - s if s < 1.0 else 0.0)
    return truth


def corrected(P, m):
    """[x, y, z] of [m 1] P."""
    return [m[0] * P[0][j] + m[1] * P[1][j] + m[2] * P[2][j] + P[3][j] for j in range(3)]


def pose_mean(poses, values, pose):
    """Mean of the [x, y, z] in values that belong to this pose code; None without any."""
    rows = [v for p, v in zip(poses, values) if p == pose]
    if rows:
        return [sum([v[k] for v in rows]) / len(rows) for k in range(3)]
    return None


def pairs(poses):
    """Faces which have both captures, a and b."""
    return [f for f in range(6) if 2 * f + 1 in poses and 2 * f + 2 in poses]


def face_means(poses, means):
    """Level 1, the paper's: a and b of each face averaged."""
    for f in range(6):
        a, b = [pose_mean(poses, means, 2 * f + k) for k in (1, 2)]
        yield [0.5 * (x + y) for x, y in zip(a, b)]


def all_axes(poses):
    """SingularSystem when an axis has no pose on either of its faces."""
    for k in range(3):
        if not [1 for p in poses if AXIS[face_of_code(p)] == k]:
            raise SingularSystem("no pose on either %s face" % "XYZ"[k])


ROUNDS = 20
STANDS_STILL = 1e-12 if DOUBLE else 1e-6
LEVELS = ("tilt solved", "flip average", "no flips")


def truths(poses, across):
    """Unit gravity in every pose, one after the other (a list would not fit a small heap).

    across {face: (in a, in b)} where the tilt is known
    """
    for pose in poses:
        face = face_of_code(pose)
        yield upright(face, across[face][1 - pose % 2] if face in across else None)


def fit(rows, truth):
    """P, 4 x 3: least squares of [row 1] P = truth. Raises SingularSystem."""
    equations = NormalEquations(3)
    for m, t in zip(rows, truth):
        equations.add(m + [1.0], t)
    return equations.solve()


def find_tilts(P, poses, means, angles=None):
    """{face: (in a, in b)} gravity across the axis of every face that was flipped, g."""
    across = {}
    for f in pairs(poses):
        a = corrected(P, pose_mean(poses, means, 2 * f + 1))
        b = corrected(P, pose_mean(poses, means, 2 * f + 2))
        across[f] = in_plane(a, b, f, angles.get(f) if angles else None)
    return across


def solve(poses, means, level, angles=None):
    """(P 4 x 3, across, rounds) from pose codes 1..12 and one [x, y, z] in g for each.

    Raises SingularSystem when an axis has no pose at all or the rows are singular.
    """
    all_axes(poses)
    if level == "flip average":
        P = fit(face_means(poses, means), [upright(f) for f in range(6)])
        return P, find_tilts(P, poses, means, angles), 1
    P = fit(means, truths(poses, {}))
    across = {}
    rounds = 1
    moved = 1.0
    while level == "tilt solved" and rounds < ROUNDS and not moved < STANDS_STILL:
        across = find_tilts(P, poses, means, angles)
        before, P = P, fit(means, truths(poses, across))
        rounds += 1
        moved = max([abs(x - y) for p, q in zip(P, before) for x, y in zip(p, q)])
    return P, across, rounds
