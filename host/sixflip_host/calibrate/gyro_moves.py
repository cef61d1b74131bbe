"""Rotation of the box over each move, and how it changes with the gyro's parameters.

The corrected rate is linear in its parameters: w = W x, x = [gyro (rad/s), 1, force (g)], W of
shape (3, 7): scale and misalignment, offset, g-sensitivity. Each step between two samples turns
by a rotation vector of the two (see steps); the steps of all moves are multiplied together as
quaternions (q0, q1, q2, q3) by doubling, so no Python loop runs over samples.
Tedaldi et al. (ICRA 2014, eq. 13-18) do the same with Runge-Kutta, one sample after another.
"""

from dataclasses import dataclass

import numpy as np

from ..capture.attitude import exponential, matrix, multiply
from ..experiment.session import ReadOnlyArrays

COLUMNS = 7
RAD = np.pi / 180.0


@dataclass(frozen=True, eq=False)
class GyroMoves(ReadOnlyArrays):
    """All moves of a session, padded to one length of n steps; arrays read only.

    dt (moves, n) s; before, after (moves, n, 7): x (see above) at both ends of each step.
    """

    dt: np.ndarray
    before: np.ndarray
    after: np.ndarray

    @property
    def seconds(self):
        """(moves,): how long each lasts."""
        return self.dt.sum(axis=1)

    def __len__(self):
        return len(self.dt)

    def steps(self, W):
        """Rotation vector of every step, (moves, steps, 3).

        dt (w0 + w1) / 2 + dt^2 / 6 (w0 x w1). One half of the second term is Magnus' for a
        rate that changes linearly over the step. The other is the trapezoid's own error,
        -dt^3 / 12 w'', which integrated by parts over a move that begins and ends at rest is
        dt^3 / 12 (w x w') once more. Together: fourth order on a smooth move.
        """
        w0 = self.before @ W.T
        w1 = self.after @ W.T
        return 0.5 * (w0 + w1) * self.dt[..., None] + np.cross(w0, w1) * (
            self.dt**2 / 6.0)[..., None]

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
        carried = matrix(total).swapaxes(1, 2)[:, None] @ middle
        weighted = 0.5 * (self.before + self.after) * self.dt[..., None]
        change = np.einsum("mkac,mkx->macx", carried, weighted, optimize=True)
        return total, change


def from_session(session, moves):
    """GyroMoves of some of the moves (blocks.Move) of a blocks.Session, by the nominal scale."""
    meta = session.capture.meta
    return of_samples(session.capture.gyro * (RAD / meta["gyro_lsb_per_dps"]),
                      session.capture.accel / meta["accel_lsb_per_g"], session.t_s,
                      [(move.first, move.end - 1) for move in moves])


def of_samples(gyro, force, t, spans):
    """GyroMoves of gyro (n, 3) rad/s and force (n, 3) g at t (n,) s; spans: list of (first, last)
    sample of each move, both at rest, first < last."""
    longest = max([last - first for first, last in spans], default=0)
    dt = np.zeros((len(spans), longest))
    before, after = np.zeros((2, len(spans), longest, COLUMNS))
    for k, (first, last) in enumerate(spans):
        x = np.hstack([gyro[first:last + 1], np.ones((last - first + 1, 1)),
                       force[first:last + 1]])
        dt[k, :last - first] = np.diff(t[first:last + 1])
        before[k, :last - first], after[k, :last - first] = x[:-1], x[1:]
    return GyroMoves(dt, before, after)


def turn_about(q, axis):
    """Angle (rad, -pi..pi) of the part of rotation q that is about the unit axis."""
    angle = 2.0 * np.arctan2(q[..., 1:] @ axis, q[..., 0])
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
