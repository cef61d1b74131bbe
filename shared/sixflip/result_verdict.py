"""The verdict on the accelerometer's parameters. Every test is written so that NaN fails it."""

from sixflip.face_fit import judge_fit

SCALE_OFF = 0.2
# Cross-axis sensitivity is 2 % per axis at most in the data sheets (MPU6050 3.4, table 6.2).
# Opposite faces that are parallel, but not square to the others, show nowhere else.
OFF_SQUARE_DEG = (3.5, 6.0)


def judge_result(result, failure=""):
    """("good" | "doubtful" | "refused", sentence); see verdict.py."""
    if result is None:
        return "refused", failure or "the poses do not determine the twelve parameters"
    found = _judge_parameters(result) or judge_fit(result)
    oblique = _judge_axes(result)
    if oblique and not (found and found[0] == "refused"):
        found = oblique if oblique[0] == "refused" else found or oblique
    if found and found[0] == "refused":
        return found
    if result.level == "no flips":
        return "doubtful", ("no flips, the table's tilt is in the result"
                            + ("; " + found[1] if found else ""))
    if found:
        return found
    if result.level == "flip average" and not result.tilt_deg < 0.5:
        return "doubtful", ("the flip average leaves a scale error at %.1f degrees of tilt, "
                            "0.5 is the limit" % result.tilt_deg)
    return "good", _praise(result)


def _judge_parameters(r):
    """Refuse numbers no working sensor has."""
    for row in r.P:
        for x in row:
            if not abs(x) < 1e6:
                return "refused", "the solve did not end in finite numbers"
    for k in range(3):
        s = r.scale[k]
        if not s > 0.0:
            return "refused", ("scale of axis %s is negative (%.3f): the axis is inverted or "
                               "two faces are exchanged" % ("xyz"[k], s))
        if not abs(s - 1.0) <= SCALE_OFF:
            return "refused", ("scale of axis %s is %.3f, 0.8 to 1.2 is the limit: wrong range "
                               "or LSB per g?" % ("xyz"[k], s))
    return None


def _judge_axes(r):
    """A chip's axes are at right angles; a box may be a lozenge, and flips do not see that."""
    doubt, limit = OFF_SQUARE_DEG
    for i, j in ((0, 1), (0, 2), (1, 2)):
        off = abs(r.T[i][j] + r.T[j][i]) * 57.3
        if not off <= doubt:
            return ("refused" if not off <= limit else "doubtful",
                    "axes %s and %s come out %.1f degrees off a right angle, %.1f is the limit: "
                    "are the faces of the box square to each other?"
                    % ("xyz"[i], "xyz"[j], off, limit if not off <= limit else doubt))
    return None


def _praise(r):
    worst = max([r.sigma_scale[k] for k in range(3)]) * 1000.0
    return ("table tilt %.2f degrees, faces agree to %.2f; scale known to %.2f mg per g"
            % (r.tilt_deg, r.tilt_spread_deg, worst))
