"""Axes swapped or inverted against the labels, and a full scale that is off by two or four."""
import itertools

import numpy as np

from sixflip import faces

from .finding import CERTAIN, Finding

CLEAR = 0.7  # share of gravity that an axis must carry to be called swapped


def swapped(sessions):
    """Accelerometer axes against the labels of the faces."""
    means, axes = [], []
    for session in sessions:
        if not session.labelled:
            continue
        for code, first, end in session.runs:
            face = faces.face_of_code(code)
            if face >= 0:
                means.append(session.capture.accel[first:end].mean(axis=0)
                             / session.capture.meta["accel_lsb_per_g"])
                axes.append([faces.SIGN[face] * (k == faces.AXIS[face]) for k in range(3)])
    if len(means) < 4 or np.linalg.matrix_rank(np.array(axes)) < 3:
        return []
    matrix = np.linalg.lstsq(np.hstack([axes, np.ones((len(axes), 1))]), np.array(means),
                             rcond=None)[0][:3].T  # measured = matrix · true
    best = nearest_permutation(matrix)
    if (best == np.eye(3)).all() or (np.abs(matrix) * np.abs(best)).sum(axis=1).min() < CLEAR:
        return []
    value = {}
    for i in range(3):
        source = int(np.abs(best[i]).argmax())
        signed = int(best[i, source]) * (source + 1)
        if signed != i + 1:
            value["xyz"[i]] = signed
    return [Finding("axis_swap", "accel", sorted(value), value, "axis", CERTAIN, "orientation",
                    "axes are swapped or inverted against the labels",
                    {k: (v, v) for k, v in value.items()})]


def nearest_permutation(matrix):
    """The signed permutation (3, 3) nearest to a matrix."""
    best = None
    for order in itertools.permutations(range(3)):
        total = sum(abs(matrix[i, order[i]]) for i in range(3))
        if best is None or total > best[0]:
            signed = np.zeros((3, 3))
            for i in range(3):
                signed[i, order[i]] = np.sign(matrix[i, order[i]]) or 1.0
            best = total, signed
    return best[1]


def full_scale(sessions, nominal):
    """A sentence when the readings are off by a factor of two or four, else ""."""
    size = float(np.median([1.0 / np.cbrt(abs(np.linalg.det(m.matrix))) for m in nominal]))
    for factor in (0.25, 0.5, 2.0, 4.0):
        if abs(size / factor - 1.0) < 0.1:
            return ("the accelerometer reads %g times gravity: its full scale is not the one the "
                    "header states" % factor)
    return ""
