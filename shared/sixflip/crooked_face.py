"""Which face is not square to the others, and by how much; said when face_fit.py found one."""

import math

from sixflip.faces import AXIS, FACES, face_of_code

CROOKED_DEG = 1.0
# Other people's six faces, steadied by hand, are off by up to 5 degrees: doubtful, not useless.
CROOKED_NO_FLIPS_DEG = 6.0


def describe(r, face, size):
    """("doubtful" | "refused", sentence); size: what is left across the axis of face, g."""
    flips = r.level != "no flips"
    crooked = math.degrees(3.0 * size)
    limit = CROOKED_DEG if flips else CROOKED_NO_FLIPS_DEG
    face = _crooked_one(r, face)
    # Little crooked, the chip's own misalignment hides which of the two it is.
    name = FACES[face] + (" (or %s)" % FACES[face ^ 1] if crooked < 3.0 else "")
    return ("refused" if not crooked <= limit else "doubtful",
            "face %s is crooked by about %.2f degrees, %.1f is the limit (%.1f mg left over): it "
            "is not square to the others, something lies under it%s"
            % (name, crooked, limit, 1000.0 * size,
               ", or its flip was not 180 degrees" if flips else " or the table tilts"))


def _crooked_one(r, face):
    """Of the two opposite faces the one whose gravity is farther off the chip's axis."""
    pair = (face & 6, face | 1)
    off = []
    for f in pair:
        k = AXIS[f]
        rows = [m for m, p in zip(r.means, r.poses) if face_of_code(p) == f]
        # Offsets from the four other faces, whose axes are not this one's.
        s = 0.0
        for j in range(3):
            if j != k:
                zero = _middle_of_others(r, k, j)
                x = sum([m[j] for m in rows]) / len(rows) - zero
                s += x * x
        off.append(s)
    return pair[0] if off[0] > off[1] else pair[1]


def _middle_of_others(r, k, j):
    """Zero of axis j from the two faces of the third axis, neither k nor j."""
    rows = [m[j] for m, p in zip(r.means, r.poses) if AXIS[face_of_code(p)] == 3 - k - j]
    return sum(rows) / len(rows)
