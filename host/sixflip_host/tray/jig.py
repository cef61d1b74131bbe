"""How each board sits in the jig: which face of the jig is up when a face of the board is.

A board may lie in the jig in any of the 24 ways in which a cube fits into its hole, so what it
calls X+ may be another face of the jig. A mounting is a dict {face of the board: face of the
jig}. One rest that both name shows one axis of it, a second one on another axis shows the rest.
"""

from ..guide.box_drawings import opposite

LETTERS = "XYZ"
FACES = tuple(letter + sign for letter in LETTERS for sign in "+-")
AS_THE_JIG = {face: face for face in FACES}


def vector(face):
    """The face's direction, three whole numbers."""
    return tuple((1 if face[1] == "+" else -1) * (letter == face[0]) for letter in LETTERS)


def across(first, second):
    """The face at right angles to two others: the right-handed cross product of their axes."""
    a, b = vector(first), vector(second)
    c = [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]
    axis = next(k for k in range(3) if c[k])
    return LETTERS[axis] + ("+" if c[axis] > 0 else "-")


def fits(mounting, own, jig):
    """Whether a rest with the board's face own up, and the jig's face jig, agrees with it."""
    return mounting.get(own, jig) == jig and jig_to_own(mounting).get(jig, own) == own


def learned(mounting, own, jig):
    """The mounting with what such a rest shows; where it disagrees, what this rest alone shows."""
    mounting = dict(mounting) if fits(mounting, own, jig) else {}
    for face, up in ((own, jig), (opposite(own), opposite(jig))):
        mounting[face] = up
    if len(mounting) == 4:
        first = own
        second = next(face for face in mounting if face[0] != own[0])
        third, up = across(first, second), across(mounting[first], mounting[second])
        mounting.update({third: up, opposite(third): opposite(up)})
    return mounting


def jig_to_own(mounting):
    """{face of the jig: face of the board} of a mounting."""
    return {jig: own for own, jig in mounting.items()}
