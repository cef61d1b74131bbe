"""The table's tilt, from the two captures of a face turned by 180 degrees on it.

METHOD 1, level 2. All vectors in g, body axes. u is the face's own axis.
"""

import math
from array import array

from sixflip.face_axes import AXIS, SIGN


def in_plane(a, b, face, angle=None):
    """What gravity has across face's axis in capture a, and in b: two 3-vectors, g.

    a, b    corrected means of the two captures, g
    angle   turn of the box from a to b, rad, right-handed about u; None is half a turn

    h = (I - R(-angle))^-1 (a - b), and R(-angle) h = h - (a - b).
    """
    k = AXIS[face]
    d = [a[i] - b[i] for i in range(3)]
    d[k] = 0.0
    h = [0.5 * x for x in d]
    if angle is not None:
        # sin/(1 - cos) is the cotangent of half the angle: 0 for half a turn.
        f = 0.5 * SIGN[face] * math.cos(0.5 * angle) / math.sin(0.5 * angle)
        i, j = (k + 1) % 3, (k + 2) % 3
        h[i] += f * d[j]
        h[j] -= f * d[i]
    return array("d", h), array("d", [h[i] - d[i] for i in range(3)])


def upright(face, across=None):
    """Unit gravity with the part `across` the face's axis (None: a level table)."""
    k = AXIS[face]
    truth = [0.0, 0.0, 0.0] if across is None else list(across)
    s = truth[0] * truth[0] + truth[1] * truth[1] + truth[2] * truth[2]
    # A box on its edge has no tilt: keep the root real, the residuals will tell.
    truth[k] = SIGN[face] * math.sqrt(1.0 - s if s < 1.0 else 0.0)
    return truth


