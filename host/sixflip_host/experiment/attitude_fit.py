"""Which way each placement lay: nominal sensor and gravity's direction, fitted together.

Twelve parameters take counts to g. All placements give |f| = 1; those on a labelled face also
say, loosely (a table may be tilted, a box not square), which way. Source: METHOD section 1, and
Tedaldi et al. (ICRA 2014) for what lies in between.
"""
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from sixflip.poses import faces

from .projection import lateral_basis

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
PARAMETERS = 12  # of the matrix, row by row, and of the offset


def face_axes(face):
    """(n, 3) unit vectors of face indices (n,); zero where leaning (-1)."""
    axes = np.zeros((len(face), 3))
    for i, f in enumerate(face):
        if f >= 0:
            axes[i, faces.AXIS[f]] = faces.SIGN[f]
    return axes


@dataclass(frozen=True, eq=False)
class NominalSensor:
    """matrix (3, 3), offset (3,): f = matrix · measured (g) + offset; up (placements, 3); loose
    (PARAMETERS, k): what matrix, row by row, and offset may be off by, a column a standard
    deviation, or None where that is not asked."""

    matrix: np.ndarray
    offset: np.ndarray
    up: np.ndarray
    loose: np.ndarray | None = None

    def spread(self, f):
        """(n, 3, k) g: what each standard deviation of the parameters makes of readings that were
        corrected to f (n, 3) g."""
        measured = (f - self.offset) @ np.linalg.inv(self.matrix).T
        by_row = np.einsum("ab,nc->nabc", np.eye(3), measured).reshape(len(f), 3, 9)
        ones = np.broadcast_to(np.eye(3), (len(f), 3, 3))
        return np.concatenate([by_row, ones], 2) @ self.loose

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
    # What the placements show is the least that |f| = 1 holds to.
    power, directions = np.linalg.eigh(found.jac.T @ found.jac)
    loose = directions * max(1.0, _scatter(found, number)) / np.sqrt(power)
    return NominalSensor(matrix, offset, f / np.linalg.norm(f, axis=1)[:, None], loose)


def unknown(chosen, nominal):
    """(m, k) deg/s: what each standard deviation of a NominalSensor makes of what is observed of
    turns.Turns: gravity, before and after, is read by it. In the faces of a box they are nothing
    beside how it lies; where a thing never leans far they are a good part of what is left."""
    parts = []
    for turn in chosen:
        before, after = nominal.spread(np.stack([turn.before, turn.after]))
        back = turn.end @ after - before
        added = np.zeros((2 + turn.flip, back.shape[1]))
        added[:2] = np.degrees(lateral_basis(turn.before) @ back)
        parts.append(added / turn.seconds)
    return np.vstack(parts)


def squareness(chosen):
    """Columns (m, 3), deg: the angles xy, xz and yz between the accelerometer's axes, by which all
    gravity of a session was read. Faces of a box that is not square are read as such angles, and
    so are half turns that were not quite half on a table that leans, alike in each session; the
    part that turns all axes together is the gyro's misalignment."""
    parts = []
    for turn in chosen:
        first, second = lateral_basis(turn.before)
        added = np.zeros((2 + turn.flip, 3))
        for k, (a, b) in enumerate(((0, 1), (0, 2), (1, 2))):
            skewed = np.zeros((3, 3))
            skewed[a, b] = skewed[b, a] = 1.0
            back = turn.end @ (skewed @ turn.after) - skewed @ turn.before
            added[:2, k] = back @ first, back @ second
        parts.append(added / turn.seconds)
    return np.vstack(parts)


def _scatter(found, number):
    """Standard deviation of the first `number` residuals of a solution of least squares, by what
    is left of them beside the parameters that they tell."""
    rows = found.jac[:number]
    told = float(np.sum(rows * np.linalg.solve(found.jac.T @ found.jac, rows.T).T))
    return np.sqrt((found.fun[:number] ** 2).sum() / max(number - told, 1.0))
