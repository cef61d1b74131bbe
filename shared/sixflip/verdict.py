"""Good, doubtful or refused, and the one sentence that says why: the accelerometer.

The first thing found speaks: the poses as they were captured, then what was solved from them.
A board looks at one after the other, to hold one of the two modules only.
"""

from sixflip.pose_check import judge_session
from sixflip.result_verdict import judge_result


def judge_accelerometer(result, placements, lsb_per_g, missing=(), failure="", rail=32767,
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
