"""Rotation of the box over each move, and how it changes with the gyro's parameters.

The corrected rate is linear in its parameters: w = W x, x = [gyro (rad/s), 1, force (g)], W of
shape (3, 7): scale and misalignment, offset, g-sensitivity. Each step between two samples turns
by a rotation vector of the two (see steps); the steps of all moves are multiplied together as
quaternions (q0, q1, q2, q3) by doubling, so no Python loop runs over samples.
Tedaldi et al. (ICRA 2014, eq. 13-18) do the same with Runge-Kutta, one sample after another.
"""

import numpy as np

COLUMNS = 7


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


class GyroMoves:
    """All moves of a session, padded to one length.

    gyro (n, 3) rad/s by the nominal scale, force (n, 3) in g, t (n,) s;
    spans: list of (first, last) sample of each move, both at rest, first < last.
    """

    def __init__(self, gyro, force, t, spans):
        longest = max([last - first for first, last in spans], default=0)
        self.dt = np.zeros((len(spans), longest))
        self.x0 = np.zeros((len(spans), longest, COLUMNS))
        self.x1 = np.zeros((len(spans), longest, COLUMNS))
        rows = np.hstack([gyro, np.ones((len(gyro), 1)), force])
        for k, (first, last) in enumerate(spans):
            n = last - first
            self.dt[k, :n] = np.diff(t[first : last + 1])
            self.x0[k, :n] = rows[first:last]
            self.x1[k, :n] = rows[first + 1 : last + 1]
        self.weighted = 0.5 * (self.x0 + self.x1) * self.dt[..., None]
        self.seconds = self.dt.sum(axis=1)

    def __len__(self):
        return len(self.dt)

    def steps(self, W):
        """Rotation vector of every step, (moves, steps, 3).

        dt (w0 + w1) / 2 + dt^2 / 6 (w0 x w1). One half of the second term is Magnus' for a
        rate that changes linearly over the step. The other is the trapezoid's own error,
        -dt^3 / 12 w'', which integrated by parts over a move that begins and ends at rest is
        dt^3 / 12 (w x w') once more. Together: fourth order on a smooth move.
        """
        w0 = self.x0 @ W.T
        w1 = self.x1 @ W.T
        return self.weighted @ W.T + np.cross(w0, w1) * (self.dt**2 / 6.0)[..., None]

    def rotate(self, W):
        """Total rotation (moves, 4) and its change with W, (moves, 3, 3, 7).

        The change is a small rotation vector in the frame at the end: R -> R exp(change . dW).
        """
        steps = self.steps(W)
        q = exponential(steps)
        shift = 1
        while shift < q.shape[1]:
            q[:, shift:] = multiply(q[:, :-shift], q[:, shift:])
            shift *= 2
        total = q[:, -1].copy()
        # Attitude in the middle of each step, seen from the end: the step's change is carried
        # there and added up.
        before = np.concatenate([np.broadcast_to([1.0, 0, 0, 0], q[:, :1].shape), q[:, :-1]], 1)
        middle = matrix(multiply(before, exponential(0.5 * steps)))
        carried = np.einsum("mba,mkbc->mkac", matrix(total), middle)
        change = np.einsum("mkac,mkx->macx", carried, self.weighted, optimize=True)
        return total, change


def turn_about(q, axis):
    """Angle (rad, -pi..pi) of the part of rotation q that is about the unit axis."""
    angle = 2.0 * np.arctan2(q[..., 1:] @ axis, q[..., 0])
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
