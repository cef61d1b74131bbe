"""Means of poses, before and after the correction. Pose codes are those of faces.py."""

from sixflip.elimination import SingularSystem
from sixflip.face_axes import AXIS, face_of_code


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
