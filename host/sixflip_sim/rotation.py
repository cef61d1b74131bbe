"""Rotation matrices as tuples of nine floats, row by row: [r0 r1 r2; r3 r4 r5; r6 r7 r8]."""

import math

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def about(axis, angle):
    """Right-handed rotation by angle (rad) about a unit vector (Rodrigues)."""
    x, y, z = axis
    c = math.cos(angle)
    s = math.sin(angle)
    d = 1.0 - c
    return (c + x * x * d, x * y * d - z * s, x * z * d + y * s,
            y * x * d + z * s, c + y * y * d, y * z * d - x * s,
            z * x * d - y * s, z * y * d + x * s, c + z * z * d)


def times(a, b):
    """Matrix product a·b."""
    return (a[0] * b[0] + a[1] * b[3] + a[2] * b[6],
            a[0] * b[1] + a[1] * b[4] + a[2] * b[7],
            a[0] * b[2] + a[1] * b[5] + a[2] * b[8],
            a[3] * b[0] + a[4] * b[3] + a[5] * b[6],
            a[3] * b[1] + a[4] * b[4] + a[5] * b[7],
            a[3] * b[2] + a[4] * b[5] + a[5] * b[8],
            a[6] * b[0] + a[7] * b[3] + a[8] * b[6],
            a[6] * b[1] + a[7] * b[4] + a[8] * b[7],
            a[6] * b[2] + a[7] * b[5] + a[8] * b[8])


def transposed(a):
    return (a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8])


def apply(a, v):
    """a·v"""
    return (a[0] * v[0] + a[1] * v[1] + a[2] * v[2],
            a[3] * v[0] + a[4] * v[1] + a[5] * v[2],
            a[6] * v[0] + a[7] * v[1] + a[8] * v[2])


def cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def norm(v):
    return math.sqrt(dot(v, v))


def axis_angle(a):
    """(unit axis, angle in 0..pi) of a rotation, through the quaternion's largest part, so
    that half a turn is no special case (Shepperd 1978)."""
    trace = a[0] + a[4] + a[8]
    if trace >= a[0] and trace >= a[4] and trace >= a[8]:
        w = 1.0 + trace
        v = (a[7] - a[5], a[2] - a[6], a[3] - a[1])
    elif a[0] >= a[4] and a[0] >= a[8]:
        w = a[7] - a[5]
        v = (1.0 + a[0] - a[4] - a[8], a[1] + a[3], a[2] + a[6])
    elif a[4] >= a[8]:
        w = a[2] - a[6]
        v = (a[1] + a[3], 1.0 - a[0] + a[4] - a[8], a[5] + a[7])
    else:
        w = a[3] - a[1]
        v = (a[2] + a[6], a[5] + a[7], 1.0 - a[0] - a[4] + a[8])
    n = norm(v)
    if n == 0.0:
        return (0.0, 0.0, 1.0), 0.0
    if w < 0.0:
        w = -w
        n = -n
    return (v[0] / n, v[1] / n, v[2] / n), 2.0 * math.atan2(abs(n), w)
