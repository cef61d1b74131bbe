"""Codes of names: what a plan, a file or a host calls a pose or a face."""

from sixflip.faces import FACES, LEANING, MOST_LEANING, MOVING


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


def face_code(name):
    """0..5 of "Z+" ... "Y-"; ValueError when there is no such face."""
    if name not in FACES:
        raise ValueError("no face is called %r: expected one of %s" % (name, " ".join(FACES)))
    return FACES.index(name)


def is_b(code):
    return 1 <= code <= LEANING and code % 2 == 0
