"""Follow the box's attitude through a move with the gyro, and level it at every rest."""

import numpy as np

from sixflip import RAIL
from sixflip.poses.placement import GAP_US

AT_A_TIME = 10_000      # samples whose rotations are there at once: each takes 300 bytes


def heading_change(capture, rests, bias, axis, sign):
    """Degrees (-180..180) the box turned about one of its axes from the first to the last rest.

    rests   Rests in time order; gravity levels the attitude at each, only heading is integrated
    bias    three gyro means at rest, counts; axis, sign: the face both ends lie on
    Returns None when the gyro touched its rail or samples are missing on the way.
    """
    first, last = rests[0].end, rests[-1].first
    gyro = capture.gyro[first - 1:last]
    gaps = np.diff(capture.t_us[first - 1:last]) / 1e6
    if len(gaps) and (max(int(gyro.max()), -int(gyro.min())) >= RAIL
                      or gaps.max() - np.median(gaps) > 1e-6 * GAP_US):
        return None
    attitude = np.eye(3)            # body -> frame of the first rest
    up = _unit(rests[0].mean)
    for before, rest in zip(rests, rests[1:]):
        move = slice(before.end - first, rest.first - first)
        for turn in _turns(capture, gyro, gaps, bias, move):
            attitude = attitude @ turn
        attitude = rotation_between(attitude @ _unit(rest.mean), up) @ attitude
    # twist about the face's axis, up: what is left once gravity agrees
    i, j = (axis + 1) % 3, (axis + 2) % 3
    return sign * float(np.degrees(np.arctan2(attitude[j, i] - attitude[i, j],
                                              attitude[i, i] + attitude[j, j])))


def _turns(capture, gyro, gaps, bias, move):
    """Rotation matrices (3, 3) of a move, one a sample."""
    for first in range(move.start, move.stop, AT_A_TIME):
        end = min(move.stop, first + AT_A_TIME)
        counts = gyro[first:end + 1].astype(float)
        middle = (counts[1:] + counts[:-1]) / 2
        rate = np.radians((middle - bias) / capture.meta["gyro_lsb_per_dps"])
        yield from rotations(rate * gaps[first:end, None])


def _unit(vector):
    return np.asarray(vector, float) / np.linalg.norm(vector)


def carried(steps):
    """(n + 1, 3, 3): the products of the first 0, 1, ... n of rotations (n, 3, 3), in as few
    operations as there are rows and columns when they are laid out in a square."""
    n = len(steps)
    width = max(1, int(np.sqrt(n)))
    square = np.tile(np.eye(3), (-(-n // width) * width, 1, 1))
    square[:n] = steps
    square = square.reshape(-1, width, 3, 3)
    for k in range(1, width):
        square[:, k] = square[:, k - 1] @ square[:, k]
    now = np.eye(3)
    for row in square:
        row[:] = now @ row
        now = row[-1]
    return np.concatenate([np.eye(3)[None], square.reshape(-1, 3, 3)[:n]])


def levelled(way, after, before, share):
    """Attitudes (n, 3, 3) with gravity right at the end, where it is `after` in the body, and
    `before` in the frame of the attitudes: the correction grows with share (n,), that of the
    angle turned, as a wrong scale or bias of the gyro makes it."""
    there = way[-1] @ after
    off = np.cross(there, before)
    size = np.linalg.norm(off)
    if size < 1e-12:
        return way
    angle = np.arctan2(size, there @ before)
    return rotations(np.outer(share, off / size * angle)) @ way


def rotations(vectors):
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3), rad."""
    from scipy.spatial.transform import Rotation  # takes a while to load
    return Rotation.from_rotvec(vectors).as_matrix()


def rotation_between(a, b):
    """The smallest rotation that takes unit vector a to unit vector b."""
    axis = np.cross(a, b)
    sine = np.linalg.norm(axis)
    if sine < 1e-12:
        return np.eye(3)
    return rotations((axis / sine * np.arctan2(sine, a @ b))[None])[0]


def multiply(p, q):
    """Hamilton product of quaternions, shapes (..., 4)."""
    a, b, c, d = np.moveaxis(p, -1, 0)
    e, f, g, h = np.moveaxis(q, -1, 0)
    return np.stack(
        [
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ],
        axis=-1,
    )


def exponential(vector):
    """Quaternion of a rotation vector, (..., 3) rad -> (..., 4)."""
    half = 0.5 * np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * vector * np.sinc(half / np.pi)], axis=-1)


def matrix(q):
    """Rotation matrices (..., 3, 3): end frame to start frame."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def cross_matrix(v):
    """[v]x of shape (..., 3, 3)."""
    x, y, z = np.moveaxis(v, -1, 0)
    o = np.zeros_like(x)
    rows = [[o, -z, y], [z, o, -x], [-y, x, o]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
