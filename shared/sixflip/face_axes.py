"""Which axis points up on each of the six faces; all that the solve needs of faces.py."""

AXIS = (2, 2, 0, 0, 1, 1)  # the axis that points up or down on each face
SIGN = (1, -1, 1, -1, 1, -1)  # +1: the named axis points up and reads +g
LEANING = 12  # code 12 + k is the k-th leaning pose


def face_of_code(code):
    """0..5, or -1 for a leaning pose and for moving."""
    if 1 <= code <= LEANING:
        return (code - 1) // 2
    return -1
