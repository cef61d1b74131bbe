"""Do the six faces agree? What noise, placing by hand and the flips leave unexplained, in a
verdict.

Where they do not agree it is said which face is probably not square to the others, and by how
much.
"""

import math

from sixflip.accelerometer.sigma import PLACING, face_residuals, influence, residual_variance
from sixflip.poses.faces import AXIS, FACES, face_of_code, pose_name

SQUARENESS_DEG = 1.0    # that a face may be off square to the others
# Other people's six faces, steadied by hand, are off by up to 5 degrees: doubtful, not useless.
SQUARENESS_NO_FLIPS_DEG = 6.0
# chi2 of three numbers: 1 good session in 2000 lies beyond on one of three pairs of faces.
DOUBT = 19.0
FLIP_ERROR = math.radians(0.4)
# What a bias wanders between captures minutes apart, g: flicker of an ordinary MEMS part.
WANDER = 2e-4
# Nonlinearity is 0.5 % of 2 g in the data sheets; a box on its edge leaves more.
ALONG_G = 0.01
# chi2 of six numbers: 1 good session in 200 lies beyond.
ZEROS_DOUBT = 18.5


def judge_fit(r):
    """("doubtful" | "refused", sentence) about the worst disagreement, or None."""
    faults = [x for x in (_judge_spread(r), _judge_squareness(r), _judge_along(r),
                          _judge_zeros(r)) if x]
    for fault in faults:       # a doubt must not hide what is to be refused
        if fault[0] == "refused":
            return fault
    return faults[0] if faults else None


def _judge_spread(r):
    """One table, six tilts: placing moves each tilt by 0.05/sqrt(2) degrees and its noise."""
    if len(r.tilts) < 6:
        return None
    noise = max([v for row in r.variance for v in row])
    across = math.degrees(math.sqrt(0.5 * (PLACING * PLACING + noise)))
    # Range of six, each a length in the plane: 5.5 sigma is passed by 1 in 2000.
    limit = 5.5 * across + 0.02 * r.tilt_deg
    if r.tilt_spread_deg <= limit:
        return None
    tilts = sorted(r.tilts.values())
    middle = 0.5 * (tilts[2] + tilts[3])
    face = max(r.tilts, key=lambda f: abs(r.tilts[f] - middle))
    off = abs(r.tilts[face] - middle)
    # A capture that leans by x shifts the face's tilt by x/2.
    off_deg = 2.0 * off if off == off else 180.0
    return ("refused" if not off_deg <= SQUARENESS_DEG else "doubtful",
            "face %s does not lie like the others: its tilt is off by %.2f degrees, the faces "
            "may differ by %.2f; one capture is crooked or moved" % (FACES[face], off, limit))


def _judge_squareness(r):
    """Even residuals: what a and b of a face have in common and the model cannot take.

    Opposite faces share it: an X+ off square and an X- equally so cannot be told apart by
    the fit. A third of a single face's angle is left as its residual.
    """
    tilt = math.radians(r.tilt_deg or 0.0)
    placing = math.sqrt(PLACING * PLACING + 0.5 * tilt * tilt * FLIP_ERROR * FLIP_ERROR)
    h = influence(r)
    worst, face, size = 0.0, None, 0.0
    along = [0.0, 0]
    for f, _, left, kept in face_residuals(r, h):
        chi2 = across = 0.0
        for k in range(3):
            noise, scatter = residual_variance(r, kept, k, placing)
            chi2 += left[k] * left[k] / (noise + scatter + WANDER * WANDER / 4)
            if k != AXIS[f]:
                across += left[k] * left[k]
        if not chi2 <= worst:
            worst = chi2
        if not across <= size * size:
            face, size = f, math.sqrt(across)
        if abs(left[AXIS[f]]) > along[0]:
            along = [abs(left[AXIS[f]]), f]
    if worst <= DOUBT:
        return None
    if along[0] > 1.5 * size and r.level != "no flips":
        return ("refused" if not along[0] <= ALONG_G else "doubtful",
                "faces %s and %s leave %.1f mg along their axis that noise does not explain: the "
                "sensor is not linear, or its temperature changed"
                % (FACES[along[1] & 6], FACES[along[1] | 1], along[0] * 1000.0))
    return _off_square(r, face, size)


def _off_square(r, face, size):
    """("doubtful" | "refused", sentence); size: what is left across the axis of face, g."""
    flips = r.level != "no flips"
    off_deg = math.degrees(3.0 * size)
    limit = SQUARENESS_DEG if flips else SQUARENESS_NO_FLIPS_DEG
    face = _face_off_square(r, face)
    # Little crooked, the chip's own misalignment hides which of the two it is.
    name = FACES[face] + (" (or %s)" % FACES[face ^ 1] if off_deg < 3.0 else "")
    return ("refused" if not off_deg <= limit else "doubtful",
            "face %s is crooked by about %.2f degrees, %.1f is the limit (%.1f mg left over): it "
            "is not square to the others, something lies under it%s"
            % (name, off_deg, limit, 1000.0 * size,
               ", or its flip was not 180 degrees" if flips else " or the table tilts"))


def _face_off_square(r, face):
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


def _judge_along(r):
    """Along gravity placing hardly moves a pose: a and b of a face differ by noise alone."""
    if r.level == "no flips":
        return None
    tilt = math.radians(r.tilt_deg)
    for i in range(len(r.poses)):
        pose = r.poses[i]
        face = face_of_code(pose)
        k = AXIS[face]
        v = r.variance[i][k] + WANDER * WANDER + 2.0 * (tilt * PLACING) ** 2 + PLACING ** 4
        other = r.residual.get(pose + 1 if pose & 1 else pose - 1)
        if other is None:
            continue
        apart = abs(r.residual[pose][k] - other[k])
        limit = 4.5 * math.sqrt(2.0 * v) + 5e-5
        if not apart <= limit:
            return "doubtful", ("%s and its flip differ by %.1f mg along gravity, %.1f is the "
                                "limit: one was knocked, or the temperature changed"
                                % (pose_name(pose), 1000.0 * apart, 1000.0 * limit))
    return None


def _judge_zeros(r):
    """All that the flips leave over: every axis' zero, found on three pairs of faces.

    On the pair on which the axis points up and down placing hardly matters; on the two others
    it does. 18 numbers of the faces' means less 12 parameters are these six.
    """
    if r.level == "no flips":
        return None
    tilt = math.radians(r.tilt_deg)
    placing2 = PLACING * PLACING + 0.5 * tilt * tilt * FLIP_ERROR * FLIP_ERROR
    chi2 = 0.0
    worst = (0.0, 0, 0.0)
    for k in range(3):
        zero, v = [0.0] * 3, [0.0] * 3
        for i in range(len(r.poses)):
            axis = AXIS[face_of_code(r.poses[i])]
            n = 2 * len([1 for p in r.poses if (p - 1) // 2 == (r.poses[i] - 1) // 2])
            zero[axis] += r.residual[r.poses[i]][k] / n
            v[axis] += (r.variance[i][k] + (placing2 if axis != k else 0.0)) / (n * n)
        i, j = (k + 1) % 3, (k + 2) % 3
        for off, v2 in ((zero[k] - 0.5 * (zero[i] + zero[j]),
                         v[k] + 0.25 * (v[i] + v[j]) + WANDER * WANDER / 4),
                        (zero[i] - zero[j], v[i] + v[j])):
            chi2 += off * off / v2
            if not off * off <= worst[0] * v2:
                worst = (off * off / v2, k, off)
    if chi2 <= ZEROS_DOUBT:
        return None
    return "doubtful", ("the zero of axis %s differs by %.1f mg from face to face, more than "
                        "placing by hand and noise explain: it jumped between two poses, or "
                        "the box lay crooked" % ("xyz"[worst[1]], 1000.0 * abs(worst[2])))
