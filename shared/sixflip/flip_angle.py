"""The flip angles the gyro measured, for the accelerometer's solve where that pays (METHOD 1).

The gyro's P must not come from these same flips: that would be circular. A stored record or
the host's refinement from the face-to-face moves will do.
"""

import math

from sixflip.faces import AXIS, SIGN
from sixflip.flip_turns import find_flips, mean_rate

# A turn farther off half a turn is no flip.
NO_FLIP = 0.7


def measured_angles(placements, moves, lsb_per_dps, P):
    """{face: rad} from a to b, right-handed about the face's axis, 0..2 pi; P 4 x 3."""
    bias = mean_rate(placements, lsb_per_dps)
    found = {}
    for f in find_flips(placements, moves, lsb_per_dps, bias, P[:3]):
        # Its own test of the half turn is the point here, not a reason to leave it out.
        if f.used or f.reason.startswith("turned"):
            k = AXIS[f.face]
            raw = SIGN[f.face] * f.turned[k]
            turn = SIGN[f.face] * sum([f.turned[i] * P[i][k] for i in range(3)])
            angle = turn if abs((raw - f.angle) % (2.0 * math.pi)) < 1e-6 else -turn
            found.setdefault(f.face, []).append(angle % (2.0 * math.pi))
    return {face: sum(a) / len(a) for face, a in found.items()}


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
