"""The half turns of a session as the gyro's integral saw them, and which of them can be used.

An integral is the exact sum of counts over n samples, divided by n, times the time that really
passed, with the samples that were late apart (placement.turned): rad in the gyro's own scale,
its bias still in it.

By a gyro that was calibrated in another session the same integrals tell how far each flip really
turned; the accelerometer is solved with these angles where that pays (METHOD 1).
"""

import math

from sixflip.poses.faces import AXIS, SIGN, face_of_code
from sixflip.poses.placement import has_gap, turned

ACROSS_DEG = 5.0
# A gyro misaligned by this much is believed when the flips of both faces show the same.
COMMON_DEG = 15.0
OFF_HALF_TURN_DEG = 40.0

# Faults of a flip.
SATURATED, GAP, NOT_A_HALF_TURN, NOT_FLAT = "saturated", "gap", "not a half turn", "not flat"


def integral(sums, n, duration_us, lsb_per_dps):
    """[Ix Iy Iz] in rad and T in s from the counts of gx gy gz summed over n samples."""
    T = duration_us * 1e-6
    f = math.radians(T / (n * lsb_per_dps))
    return [s * f for s in sums], T


def turn(move, lsb_per_dps):
    """Likewise, of a move."""
    f = math.radians(1.0 / lsb_per_dps)
    return [turned(move, k) * f for k in range(3)], move.duration_us * 1e-6


def mean_rate(placements, lsb_per_dps):
    """The gyro's mean over all rests, rad/s: its bias. ValueError without a rest."""
    n = sum([p.n for p in placements])
    if not n:
        raise ValueError("no rest: the gyro's bias is not known")
    f = math.radians(1.0 / (n * lsb_per_dps))
    return [sum([p.sums[3 + k] for p in placements]) * f for k in range(3)]


class Flip:
    """A move from one capture of a face to the other.

    face; turned [3] rad without bias; T in s; angle rad from a to b, right-handed about the
    face's axis, 0..2 pi; along: +1 or -1, the way it was turned; lean_deg: part across the
    axis; used; fault, reason: why it is not used, a fault from above and a sentence
    """


def find_flips(placements, moves, lsb_per_dps, bias, rotation=None):
    """A Flip for every move between the two captures of a face.

    bias      rad/s, taken out
    rotation  3 x 3 that takes the chip's axes to the box's (rows are images of the chip's
              axes), for a chip which does not sit straight in its box; the accelerometer's P
    """
    flips = []
    for move in moves:
        if move.before < 0 or move.after < 0 or not move.n > 0:
            continue
        a, b = placements[move.before].pose, placements[move.after].pose
        if face_of_code(a) < 0 or a == b or face_of_code(a) != face_of_code(b):
            continue
        flips.append(_flip(move, a, b, lsb_per_dps, bias, rotation))
    _misaligned_not_leaning(flips)
    return flips


def _flip(move, a, b, lsb_per_dps, bias, rotation):
    flip = Flip()
    flip.face = face_of_code(a)
    measured, flip.T = turn(move, lsb_per_dps)
    flip.turned = [measured[k] - bias[k] * flip.T for k in range(3)]
    about = SIGN[flip.face] * flip.turned[AXIS[flip.face]]
    flip.along = 1 if about >= 0.0 else -1
    flip.angle = (about if b > a else -about) % (2.0 * math.pi)
    flip.lean_deg = _lean(flip, rotation)
    flip.fault, flip.reason = _fault(move, flip, abs(math.degrees(about)))
    flip.used = not flip.fault
    return flip


def _fault(move, flip, turned_deg):
    """(fault, sentence), both "" where the flip can be used."""
    if move.saturated:
        return SATURATED, "the gyro was saturated: turn the box more slowly"
    if has_gap(move):
        return GAP, "a gap of %d ms in the samples" % (move.largest_gap_us // 1000)
    if not abs(turned_deg - 180.0) <= OFF_HALF_TURN_DEG:
        return NOT_A_HALF_TURN, "turned by %.0f degrees, expected 140 to 220" % turned_deg
    if not flip.lean_deg <= ACROSS_DEG:
        return NOT_FLAT, ("did not stay flat: %.1f degrees across the axis, %.0f is the limit"
                          % (flip.lean_deg, ACROSS_DEG))
    return "", ""


def _lean(flip, rotation):
    """Degrees across the axis, as read or with the chip turned straight, whichever is less."""
    k = AXIS[flip.face]
    t = flip.turned
    lean = _across(t, k)
    if rotation:
        lean = min(lean, _across([sum([t[i] * rotation[i][j] for i in range(3)])
                                  for j in range(3)], k))
    return lean


def _across(turned, k):
    return math.degrees(math.sqrt(sum([turned[i] * turned[i] for i in range(3) if i != k])))


def _misaligned_not_leaning(flips):
    """Two flips about one axis that lean alike show a misaligned gyro: what P is to take."""
    for f in flips:
        if f.fault != NOT_FLAT or f.lean_deg > COMMON_DEG:
            continue
        k = AXIS[f.face]
        for other in flips:
            if other is f or AXIS[other.face] != k or not other.turned[k]:
                continue
            if not (other.used or other.fault == NOT_FLAT):
                continue
            ratio = f.turned[k] / other.turned[k]
            apart = [f.turned[i] - ratio * other.turned[i] for i in range(3)]
            if _across(apart, k) <= ACROSS_DEG:
                f.used, f.fault, f.reason = True, "", ""
                break


# A turn farther off half a turn is no flip.
NO_FLIP = 0.7


def measured_angles(placements, moves, lsb_per_dps, P):
    """{face: rad} from a to b, right-handed about the face's axis, 0..2 pi; P 4 x 3."""
    bias = mean_rate(placements, lsb_per_dps)
    angles = {}
    for f in find_flips(placements, moves, lsb_per_dps, bias, P[:3]):
        # Its own test of the half turn is the point here, not a reason to leave it out.
        if f.used or f.fault == NOT_A_HALF_TURN:
            k = AXIS[f.face]
            raw = SIGN[f.face] * f.turned[k]
            turn = SIGN[f.face] * sum([f.turned[i] * P[i][k] for i in range(3)])
            angle = turn if abs((raw - f.angle) % (2.0 * math.pi)) < 1e-6 else -turn
            angles.setdefault(f.face, []).append(angle % (2.0 * math.pi))
    return {face: sum(a) / len(a) for face, a in angles.items()}


def worthwhile(angles, scale_sigma):
    """The angles to give to the accelerometer's solve; {} where they would only add noise.

    scale_sigma  relative error of the gyro's scale, of half a turn that is its error in rad

    The six deviations are shrunk towards half a turn by the part of their mean square that
    is the gyro's own error (James and Stein 1961), counted twice because the two faces of an
    axis share it: good flips stay half turns, flips 10 degrees off are believed, and a bad
    gyro is believed less.
    """
    kept = {face: a - math.pi for face, a in angles.items() if abs(a - math.pi) < NO_FLIP}
    square = sum([d * d for d in kept.values()]) / len(kept) if kept else 0.0
    own = 2.0 * (math.pi * scale_sigma) ** 2
    if not square > own:
        return {}
    return {face: math.pi + d * (1.0 - own / square) for face, d in kept.items()}
