"""Good, doubtful or refused, and the sentence that says why: the accelerometer.

The first thing found speaks: the poses as they were captured (sixflip/poses/pose_check.py), then
the parameters, how the faces agree, and how well a corrected vector is known. Every comparison
is written so that NaN fails it.
"""

import math

from sixflip import RAIL
from sixflip.accelerometer.face_fit import judge_fit
from sixflip.poses.pose_check import judge_session

SCALE_OFF = 0.2
# Cross-axis sensitivity is 2 % per axis at most in the data sheets (MPU6050 3.4, table 6.2).
# Opposite faces that are parallel, but not square to the others, show nowhere else.
OFF_SQUARE_DEG = (3.5, 6.0)
# Of a corrected vector, RMS over all directions. Sessions on tables tilted by up to 5 degrees,
# placed to 0.05 degrees and flipped to 0.4, stay below it in 99 of 100: bench mistakes.
UNCERTAIN_MG = 2.5


def judge_result(result, failure=""):
    """("good" | "doubtful" | "refused", sentence)."""
    if result is None:
        return "refused", failure or "the poses do not determine the twelve parameters"
    judgement = _judge_parameters(result) or judge_fit(result) or _judge_uncertainty(result)
    oblique = _judge_axes(result)
    if oblique and not (judgement and judgement[0] == "refused"):
        judgement = oblique if oblique[0] == "refused" else judgement or oblique
    if judgement and judgement[0] == "refused":
        return judgement
    if result.level == "no flips":
        return "doubtful", ("no flips, the table's tilt is in the result"
                            + ("; " + judgement[1] if judgement else ""))
    if judgement:
        return judgement
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


def vector_sigma_mg(r):
    """Standard error of a corrected vector, RMS over all directions of gravity, mg."""
    square = 0.0
    for j in range(3):
        offset = r.sigma_P[3][j] / r.g
        square += offset * offset + sum([r.sigma_P[i][j] * r.sigma_P[i][j]
                                         for i in range(3)]) / 3.0
    return 1000.0 * math.sqrt(square)


def _judge_uncertainty(r):
    """What the residuals scatter, and what the zeros drifted, beyond what is still good."""
    sigma = vector_sigma_mg(r)
    if r.level == "no flips" or sigma <= UNCERTAIN_MG:
        return None
    return "doubtful", ("a corrected vector is known to %.1f mg only, %.1f is the limit: the "
                        "faces do not agree any better, or a zero drifted meanwhile"
                        % (sigma, UNCERTAIN_MG))


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


def judge_accelerometer(result, placements, lsb_per_g, missing=(), failure="", rail=RAIL,
                        halves=None):
    """("good" | "doubtful" | "refused", sentence).

    result     AccelerometerResult, None when the solve raised; failure: what it said
    missing    pose codes a guided session still wants; missing faces are found in any case
    rail       count at which the accelerometer is saturated
    halves     per placement, mean of its second half minus its first [x, y, z] in counts,
               where the samples are at hand
    """
    return (judge_session(placements, lsb_per_g, missing, rail, halves)
            or judge_result(result, failure))
