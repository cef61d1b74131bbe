"""Equations of the joint refinement, each with its derivatives; all residuals whitened.

Parameters, in this order: A (9, row by row) and o (3) of the accelerometer, f = A m + o in g;
W (3 x 7, row by row) of the gyro (gyro_moves.py); one excess angle d a flip, which was
180 degrees + d.

  norm   every rest:  |f| = 1
  flips  every flip:  h_b = R(-(pi + d)) h_a, h the part of f across the face's axis (METHOD 1)
  level  every rest on a face that was never flipped: h = 0, as good as tables are level
  angle  every flip the gyro saw: d = its turn by the gyro - 180 degrees
  moves  every move:  R^T f_before = f_after in direction (Tedaldi eq. 14)
  still  every rest:  W x = 0
"""

import numpy as np

from ..capture import attitude
from . import gyro_moves

N_ACCEL = 12
N_GYRO = 21
SCATTER = 0.05 * np.pi / 180.0  # of setting a box down by hand (METHOD 1)
LEVEL = 1.0 * np.pi / 180.0  # of a table nobody checked


class Equations:
    """Residuals and Jacobian of one session; sigma: multiplies the error of each group."""

    def __init__(self, session):
        self.session = session
        self.sigma = dict.fromkeys(("norm", "flips", "level", "angle", "moves", "still"), 1.0)
        self.size = N_ACCEL + N_GYRO + len(session.flips)
        # f = A m + o as a matrix on (A, o): rows (k, 3, 12).
        m = session.force
        self.of_accel = np.zeros((len(m), 3, N_ACCEL))
        for i in range(3):
            self.of_accel[:, i, 3 * i : 3 * i + 3] = m
            self.of_accel[:, i, 9 + i] = 1.0
        self.gyro = session.has_gyro

    def forces(self, p):
        return self.session.force @ p[:9].reshape(3, 3).T + p[9:12]

    def evaluate(self, p):
        """{group: (residual (n,), Jacobian (n, size))} at parameters p."""
        f = self.forces(p)
        groups = {"norm": self._norm(f), "flips": self._flips(f, p), "level": self._level(f)}
        if self.gyro:
            W = p[N_ACCEL : N_ACCEL + N_GYRO].reshape(3, 7)
            groups["still"] = self._still(W)
            if len(self.session.moves):
                turns, change = self.session.moves.rotate(W)
                groups["moves"] = self._moves(f, turns, change)
                groups["angle"] = self._angle(p, turns, change)
        return {k: (r / self.sigma[k], J / self.sigma[k])
                for k, (r, J) in groups.items() if len(r)}

    def _norm(self, f):
        length = np.linalg.norm(f, axis=1)
        J = np.zeros((len(f), self.size))
        J[:, :N_ACCEL] = np.einsum("ki,kip->kp", f / length[:, None], self.of_accel)
        error = self.session.force_error
        return (length - 1.0) / error, J / error[:, None]

    def _flips(self, f, p):
        residual, rows = [], []
        for k, flip in enumerate(self.session.flips):
            column = N_ACCEL + N_GYRO + k
            plane = np.delete(np.eye(3), np.argmax(np.abs(flip.axis)), axis=0)
            cross = attitude.cross_matrix(flip.axis)
            c, s = np.cos(np.pi + p[column]), np.sin(np.pi + p[column])
            back = c * np.eye(3) - s * cross  # R(-psi) on vectors across the axis
            error = np.sqrt(2.0) * np.hypot(self.session.force_error[flip.a], SCATTER)
            J = np.zeros((3, self.size))
            J[:, :N_ACCEL] = self.of_accel[flip.b] - back @ self.of_accel[flip.a]
            J[:, column] = -(-s * np.eye(3) - c * cross) @ f[flip.a]
            residual.append(plane @ (f[flip.b] - back @ f[flip.a]) / error)
            rows.append(plane @ J / error)
        return _stack(residual, rows, self.size)

    def _level(self, f):
        residual, rows = [], []
        for k in self.session.alone:
            plane = np.delete(np.eye(3), np.argmax(np.abs(f[k])), axis=0)
            J = np.zeros((2, self.size))
            J[:, :N_ACCEL] = plane @ self.of_accel[k]
            residual.append(plane @ f[k] / LEVEL)
            rows.append(J / LEVEL)
        return _stack(residual, rows, self.size)

    def _still(self, W):
        s = self.session
        x = np.hstack([s.rate, np.ones((len(s.rate), 1)), s.force])
        J = np.zeros((len(x), 3, self.size))
        for i in range(3):
            first = N_ACCEL + 7 * i
            J[:, i, first : first + 7] = x
        error = s.rate_error[:, None]
        return (x @ W.T / error).ravel(), (J / error[..., None]).reshape(-1, self.size)

    def _moves(self, f, turns, change):
        s = self.session
        length = np.linalg.norm(f, axis=1)
        v = f / length[:, None]
        across = (np.eye(3) - v[:, :, None] * v[:, None, :]) / length[:, None, None]
        dv = across @ self.of_accel
        before, after = np.array(s.ends).T
        back = np.swapaxes(attitude.matrix(turns), 1, 2)
        carried = np.einsum("mij,mj->mi", back, v[before])
        J = np.zeros((len(turns), 3, self.size))
        J[:, :, :N_ACCEL] = back @ dv[before] - dv[after]
        turned = np.einsum("mij,mjcx->micx", attitude.cross_matrix(carried), change)
        J[:, :, N_ACCEL : N_ACCEL + N_GYRO] = turned.reshape(-1, 3, N_GYRO)
        error = s.move_error[:, None]
        residual = (carried - v[after]) / error
        return residual.ravel(), (J / error[..., None]).reshape(-1, self.size)

    def _angle(self, p, turns, change):
        residual, rows = [], []
        for k, flip in enumerate(self.session.flips):
            if flip.move is None:
                continue
            turn = flip.forward * gyro_moves.turn_about(turns[flip.move], flip.axis)
            excess = turn % (2.0 * np.pi) - np.pi
            J = np.zeros((1, self.size))
            J[0, N_ACCEL : N_ACCEL + N_GYRO] = flip.forward * np.einsum(
                "i,icx->cx", flip.axis, change[flip.move]
            ).ravel()
            J[0, N_ACCEL + N_GYRO + k] = -1.0
            error = np.hypot(self.session.move_error[flip.move], SCATTER / 3)
            residual.append(np.array([excess - p[N_ACCEL + N_GYRO + k]]) / error)
            rows.append(J / error)
        return _stack(residual, rows, self.size)


def _stack(residual, rows, size):
    if not rows:
        return np.zeros(0), np.zeros((0, size))
    return np.concatenate(residual), np.vstack(rows)
