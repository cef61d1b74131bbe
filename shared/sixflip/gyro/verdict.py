"""Good, doubtful or refused, and the sentence that says why: the gyro, and what it says of the
flips.

Half turns are assumed. Six flips that are short by one angle look like another tilt of the table
to the accelerometer, and like another scale to the gyro, which the moves between the faces
contradict (half_turns.py). One flip that differs from the others shows in any case.
"""

import math

from sixflip.gyro.flips import NOT_A_HALF_TURN
from sixflip.poses.faces import AXIS, FACES

SCALE_OFF = 0.2
ANGLE_OFF_DEG = 3.0
ACROSS_DEG = 1.5  # half of what two flips of an axis may lean apart


def judge_gyroscope(r):
    """("good" | "doubtful" | "refused", sentence) about a GyroscopeResult; NaN never passes."""
    if r.wrong_axes:
        return "refused", r.wrong_axes
    for row in r.P:
        for x in row:
            if not abs(x) < 1e6:
                return "refused", "the solve did not end in finite numbers"
    for k in range(3):
        if not abs(r.P[k][k] - 1.0) <= SCALE_OFF:
            return "refused", ("gyro scale of axis %s is %.3f, 0.8 to 1.2 is the limit: wrong "
                               "range or LSB?" % ("xyz"[k], r.P[k][k]))
    left_out = ["%s (%s)" % (face, r.flips[face]["reason"]) for face in sorted(r.flips)
                if not r.flips[face]["used"]]
    more = "; left out: " + ", ".join(left_out) if left_out else ""
    without_sign = ["xyz"[k] for k in range(3) if k not in r.signs_seen]
    if without_sign:
        more += "; sign of %s not seen, no quarter turn about it" % " and ".join(without_sign)
    if len(r.missing) == 3:
        return "refused", "no usable flip about any axis" + more
    if r.missing:
        return "doubtful", ("no usable flip about axis %s, its old values are kept"
                            % " and ".join(["xyz"[k] for k in r.missing])) + more
    for face in sorted(r.flips):
        angle = r.flips[face]["angle_deg"]
        if r.flips[face]["used"] and not abs(angle - 180.0) <= ANGLE_OFF_DEG:
            return "doubtful", ("the flips of an axis disagree: %s turned by %.1f degrees if "
                                "the others were half turns, 3 is the limit" % (face, angle))
    if not r.across_deg <= ACROSS_DEG:
        return "doubtful", ("the flips of an axis disagree: one of them turned by %.1f degrees "
                            "about another axis, %.1f is the limit" % (r.across_deg, ACROSS_DEG))
    # One flip is right or wrong by itself: late or repeated samples may have shortened it.
    single = [k for k in "XYZ" if len([1 for face in r.flips if face[0] == k
                                          and r.flips[face]["used"]]) < 2]
    if single:
        return "doubtful", ("one flip alone about %s, nothing to hold its angle against"
                            % " and ".join(single).lower()) + more
    scale = max([r.sigma[k][k] for k in range(3)])
    if not scale <= 0.01:
        return "doubtful", "the scale is known to %.1f %% only, 1 is the limit" % (100 * scale)
    used = len([1 for face in r.flips if r.flips[face]["used"]])
    return "good", ("%d flips, scale known to %.2f %%, bias to %.3f degrees/s"
                    % (used, 100 * scale, max(r.sigma_bias_dps))) + more


APART_DEG = 3.0
MATTERS_MG = 1.0
# False alarms, where the moves contradict: 1 axis in 2000.
SIGMAS = 3.5
# Of two flips' mean by a hand good to 0.4 degrees (gyro_spread.HAND), a part of half a turn.
PAIR = 0.4 / 180.0 / math.sqrt(2.0)
# A scale known no better is doubtful (gyro_verdict.py), and so is one held against no better.
HELD = 0.01


def not_half_turns(r):
    """{axis: degrees by which its flips were too long} of axes where the moves show it."""
    too_long = {}
    for k in range(3):
        if r.excess and k not in r.missing:
            x, sigma = r.excess[0][k], r.excess[1][k]
            if abs(x) > SIGMAS * math.sqrt(sigma * sigma + PAIR * PAIR):
                too_long[k] = 180.0 * x
    return too_long


def _off_half_turn(too_long, r):
    """"every flip was short by 6.0 degrees", or those about one axis or two."""
    worst = max(too_long, key=lambda k: abs(too_long[k]))
    axes = [k for k in sorted(too_long)
            if abs(too_long[k] - too_long[worst]) < SIGMAS * 180.0 * (r.excess[1][k] + PAIR)]
    return "%s %s by %.1f degrees" % (
        "every flip was" if len(axes) == 3 else
        "the flips about %s were" % " and ".join(["xyz"[k] for k in axes]),
        "too long" if too_long[worst] > 0 else "short", abs(too_long[worst]))


def scale_off(r, tolerance):
    """(scale of the gyro, degrees by which its flips then were short) where it is beyond what
    its data sheet allows, or None. r a GyroscopeResult; tolerance None: not known."""
    worst = None
    for k in range(3):
        if k in r.missing or tolerance is None:
            continue
        s = math.sqrt(sum([r.P[i][k] * r.P[i][k] for i in range(3)]))
        if abs(s - 1.0) > tolerance + 2.0 * r.sigma[k][k] and (
                worst is None or abs(s - 1.0) > abs(worst - 1.0)):
            worst = s
    return worst and (worst, 180.0 * (1.0 - 1.0 / worst))


def scale_doubt(r, tolerance):
    """The sentence about a gyro whose scale the moves contradict, or which no move confirms
    and its tolerance does not allow either; or ""."""
    if r.excess:
        too_long = not_half_turns(r)
        if too_long:
            return ("%s, by the moves between the faces: its scale is off by %.1f %%"
                    % (_off_half_turn(too_long, r),
                       max([abs(too_long[k]) for k in too_long]) / 1.8))
        known = max([0.0] + [r.excess[1][k] for k in range(3) if k not in r.missing])
        if not known <= HELD:
            return ("the moves between the faces tell by how much the flips turned to %.1f "
                    "degrees only, %.1f is the limit" % (180.0 * known, 180.0 * HELD))
        return ""
    off = scale_off(r, tolerance)
    if not off:
        return "no move between the faces could be used to hold its half turns against"
    return ("gyro scale %.3f, %.0f %% off is the data sheet's limit: the chip is off, or every "
            "flip was %s by %.0f degrees" % (off[0], 100 * tolerance, _side(off[1]), abs(off[1])))


def error_mg(tilt_deg, off_deg):
    """About the error of a corrected vector when a flip was off half a turn by so much."""
    return 1000.0 * math.sin(math.radians(tilt_deg)) * math.radians(off_deg) / 2.0


def apart(r, axis):
    """(degrees by which the flips about an axis differ, the face farther off) or None."""
    if axis in r.missing:
        return None     # what a gyro shows of which no turn counts may be anything
    turned = {}
    for face in range(6):
        flip = r.flips.get(FACES[face])
        if AXIS[face] == axis and flip and (
                flip["used"] or flip["fault"] == NOT_A_HALF_TURN):
            turned[FACES[face]] = (abs(flip["angle_deg"] - 180.0), flip["angle_deg"])
    if not turned:
        return None
    angle = [a[1] for a in turned.values()]
    if len(angle) < 2:
        angle.append(180.0)
    return max(angle) - min(angle), max(turned, key=lambda f: turned[f][0])


def accelerometer_doubt(r, tolerance, tilt_deg, known=()):
    """The sentence about flips that were no half turns where the table's tilt makes that
    matter, or "". Asked of a gyro with a scale that no chip has, too: its flips show that.

    known  faces 0..5 whose turn was measured by another gyro scale and taken into account
    """
    if tilt_deg is None or r.wrong_axes:
        return ""
    for axis in range(3):
        worst = apart(r, axis)
        if worst and FACES.index(worst[1]) not in known and worst[0] > APART_DEG:
            mg = error_mg(tilt_deg, worst[0])
            if mg > MATTERS_MG:
                return ("the flip of %s or of the opposite face was off half a turn by %.1f "
                        "degrees, %.0f is the limit: about %.1f mg at %.1f degrees of tilt"
                        % (worst[1], worst[0], APART_DEG, mg, tilt_deg))
    if len(known) == 6:
        return ""
    if r.excess:
        short = not_half_turns(r)
        mg = error_mg(tilt_deg, max([0.0] + [abs(short[k]) for k in short]))
        if mg > MATTERS_MG:
            return ("%s, by the moves between the faces: about %.1f mg at %.1f degrees of tilt"
                    % (_off_half_turn(short, r), mg, tilt_deg))
        return ""
    off = scale_off(r, tolerance)
    if off and error_mg(tilt_deg, abs(off[1])) > MATTERS_MG:
        return ("gyro scale %.3f: the chip is off, or every flip was %s by %.0f degrees, that "
                "is about %.1f mg at %.1f degrees of tilt" % (
                    off[0], _side(off[1]), abs(off[1]), error_mg(tilt_deg, abs(off[1])),
                    tilt_deg))
    return ""


def _side(short_deg):
    return "short" if short_deg > 0 else "too long"
