"""Names and codes of the poses: six faces of the box, each captured twice, and leaning poses.

A face is called after the axis of the sensor that points up on it, which then reads +g: "Z+".
Its first capture is "Z+a", the second, turned by half a turn flat on the table, "Z+b". In
programs a face is a number 0..5 and a pose a code: 0 while the box moves, 1..12 for the faces,
12 + k for the k-th leaning pose "Lk".
"""

import math

AXIS = (2, 2, 0, 0, 1, 1)  # the axis that points up or down on each face
SIGN = (1, -1, 1, -1, 1, -1)  # +1: the named axis points up and reads +g
LEANING = 12  # code 12 + k is the k-th leaning pose


def face_of_code(code):
    """0..5, or -1 for a leaning pose and for moving."""
    if 1 <= code <= LEANING:
        return (code - 1) // 2
    return -1


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


def pose_code(name):
    """The code of a name; ValueError with a sentence when there is no such pose."""
    if name == "":
        return MOVING
    if name[:2] in FACES and name[2:] in ("a", "b"):
        return 1 + 2 * FACES.index(name[:2]) + (name[2:] == "b")
    digits = name[1:]
    k = int(digits) if name[0] == "L" and digits and not digits.strip("0123456789") else 0
    if 0 < k <= MOST_LEANING and name == "L%d" % k:
        return LEANING + k
    raise ValueError(
        "no pose is called %r: expected Z+a, Z+b, Z-a ... Y-b or L1 to L%d" % (name, MOST_LEANING)
    )


def is_b(code):
    """Whether a code is the second capture of a face."""
    return 1 <= code <= LEANING and code % 2 == 0
