"""Faces and names of the poses: six faces, each twice (a, and b turned by 180 degrees)."""

import math

from sixflip.face_axes import AXIS, LEANING, SIGN, face_of_code  # noqa: F401  its public home

FACES = ("Z+", "Z-", "X+", "X-", "Y+", "Y-")
MOVING = 0
MOST_LEANING = 2000


def pose_name(code):
    """"Z+a" ... "Y-b", "L1" ...; "" while moving."""
    if code == MOVING:
        return ""
    if code <= LEANING:
        return FACES[(code - 1) // 2] + "ab"[(code - 1) % 2]
    return "L%d" % (code - LEANING)


def nearest_face(mx, my, mz):
    """(face 0..5, degrees between the measured gravity and that face's axis), any unit."""
    m = (mx, my, mz)
    best = 0
    for face in range(1, 6):
        if m[AXIS[face]] * SIGN[face] > m[AXIS[best]] * SIGN[best]:
            best = face
    up = m[AXIS[best]] * SIGN[best]
    across = mx * mx + my * my + mz * mz - up * up
    if up <= 0:
        return best, 90.0
    return best, math.degrees(math.atan2(math.sqrt(max(0.0, across)), up))
