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

    def residual(p):
        f = mean @ p[:9].reshape(3, 3).T + p[9:]
        along = (np.linalg.norm(f, axis=1) - 1.0) / ALONG
        across = (f - axes)[on_face]
        across -= axes[on_face] * (across * axes[on_face]).sum(axis=1)[:, None]
        prior = np.concatenate([(p[:9] - start[:9]) / SHAPE / LEEWAY, p[9:] / OFFSET])
        return np.concatenate([along, across.ravel() / ACROSS, prior])

    parameters = least_squares(residual, start, x_scale=0.01, method="trf", max_nfev=60).x
    matrix, offset = parameters[:9].reshape(3, 3), parameters[9:]
    f = mean @ matrix.T + offset
    return NominalSensor(matrix, offset, f / np.linalg.norm(f, axis=1)[:, None])
