"""Which way each placement lay: nominal sensor and gravity's direction, fitted together.

Twelve parameters take counts to g. All placements give |f| = 1; those on a labelled face also
say, loosely (a table may be tilted, a box not square), which way. Source: METHOD section 1, and
Tedaldi et al. (ICRA 2014) for what lies in between.
"""
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from sixflip.poses import faces

# g, standard deviations: how well |f| = 1 holds, and a table's tilt (30 mg are 1.7 degrees). They
# are a hundred apart, so that the length of gravity decides wherever it says anything, and the
# labels only choose among the turned sensors that fit it alike.
ALONG = 0.3e-3
ACROSS = 30e-3
# Cross-axis sensitivity and scale where nothing else says, and offset, g [MPU-6000 PS rev 3.4,
# table 6.2: 2 %, 3 %, 80 mg]; SHAPE is let go to LEEWAY times that, the offset to six times.
SHAPE, LEEWAY, OFFSET = 0.02, 5.0, 0.5
# Without labels nothing but |f| = 1 and that prior says which way a box lay; in the six faces they
# leave a sensor free to turn by half a right angle for an effect of a hundredth. How well |f| = 1
# holds is then what the placements themselves show, to SETTLED of it.
ROUNDS, SETTLED = 12, 0.1


def face_axes(face):
    """(n, 3) unit vectors of face indices (n,); zero where leaning (-1)."""
    axes = np.zeros((len(face), 3))
    for i, f in enumerate(face):
        if f >= 0:
            axes[i, faces.AXIS[f]] = faces.SIGN[f]
    return axes


@dataclass(frozen=True, eq=False)
class NominalSensor:
    """matrix (3, 3), offset (3,): f = matrix · measured (g) + offset; up (placements, 3)."""

    matrix: np.ndarray
    offset: np.ndarray
    up: np.ndarray

    def corrected(self, mg):
        """(n, 3) g from (n, 3) mg as measured."""
        return mg * 1e-3 @ self.matrix.T + self.offset


def fit(session, added=0.0):
    """NominalSensor of a Session; placements in the order of session.runs. added (n, 3) mg: what
    something else than a nominal sensor adds to its readings."""
    number, accel = session.placements(), session.accel - added
    mean = np.array([accel[session.placement == p].mean(axis=0) * 1e-3
                     if (session.placement == p).any() else np.array([0.0, 0.0, 1.0])
                     for p in range(number)])
    code = [run[0] for run in session.runs]
    axes = face_axes([faces.face_of_code(c) if session.labelled else -1 for c in code])
    on_face = np.abs(axes).sum(axis=1) > 0
    start = np.concatenate([np.eye(3).ravel(), np.zeros(3)])

    def residual(p, holds):
        f = mean @ p[:9].reshape(3, 3).T + p[9:]
        along = (np.linalg.norm(f, axis=1) - 1.0) / holds
        across = (f - axes)[on_face]
        across -= axes[on_face] * (across * axes[on_face]).sum(axis=1)[:, None]
        prior = np.concatenate([(p[:9] - start[:9]) / SHAPE / LEEWAY, p[9:] / OFFSET])
        return np.concatenate([along, across.ravel() / ACROSS, prior])

    holds, parameters = ALONG if on_face.any() else ACROSS, start
    for _ in range(1 if on_face.any() else ROUNDS):
        found = least_squares(residual, parameters, x_scale=0.01, method="trf", max_nfev=60,
                              args=(holds,))
        before, parameters = holds, found.x
        holds = max(ALONG, holds * _scatter(found, number))
        if abs(holds - before) < SETTLED * before:
            break
    matrix, offset = parameters[:9].reshape(3, 3), parameters[9:]
    f = mean @ matrix.T + offset
    return NominalSensor(matrix, offset, f / np.linalg.norm(f, axis=1)[:, None])


def _scatter(found, number):
    """Standard deviation of the first `number` residuals of a solution of least squares, by what
    is left of them beside the parameters that they tell."""
    rows = found.jac[:number]
    told = float(np.sum(rows * np.linalg.solve(found.jac.T @ found.jac, rows.T).T))
    return np.sqrt((found.fun[:number] ** 2).sum() / max(number - told, 1.0))
