"""The gyro section of a record against what the raw samples of flips and rests say."""

import numpy as np

from ..capture import pose_sums
from ..errors import CheckFailed
from . import reference_gyro, solution
from .verify_checks import Check, close, same, same_words

# A board with 32-bit floats: 1e-5 of the matrix is 0.002 degrees of half a turn, a 300th of
# what a good hand leaves; of the last row it is 0.0006 deg/s.
SINGLE = 1e-5
DOUBLE_REL, DOUBLE_ABS = 1e-9, 1e-12


def checks(capture, record, placements, old=None):
    """(every Check of record.gyro, remarks).

    old  P of the record before this one, kept for axes that were not flipped; None: nominal
    """
    section = record.gyro
    if section is None:
        return _left_out(capture, record, placements, old), []
    if capture.sums_only:
        return [], ["no samples of the moves were kept: the gyro's section is not checked"]
    if capture.gyro is None:
        return [Check("gyro", "in the record", "not in the capture", False)], []
    accel_P = record.accel and record.accel["P"]
    try:
        host = reference_gyro.solve(capture, placements, accel_P, old)
    except (CheckFailed, np.linalg.LinAlgError, ValueError, IndexError) as error:
        return [Check("gyro", section["verdict"], str(error), False)], []
    double = record.float_bits == 64
    relative, absolute = (DOUBLE_REL, DOUBLE_ABS) if double else (0.0, SINGLE)
    P = np.array(section["P"])
    out = [same("gyro, axes without a flip", list(section["missing"]), host.missing)]
    for i, j in np.ndindex(4, 3):
        out.append(close("gyro P[%d][%d]" % (i, j), P[i, j], host.P[i, j], relative, absolute))
    for i, j in np.ndindex(4, 3):
        out.append(close("gyro sigma P[%d][%d]" % (i, j), section["sigma_P"][i][j],
                         host.sigma[i, j], 1e-4 if double else 0.05, 1e-7))
    again, why = _solved_from_capture(capture, placements, accel_P, old)
    out.append(same("gyro verdict", section["verdict"],
                    again.verdict if again else "none: " + why))
    if again:
        out.append(same_words("gyro reason", section["reason"], again.reason, record.float_bits))
    return out, _remarks(section, old)


def _left_out(capture, record, placements, old):
    """A board leaves the gyro out where its own is refused, or there is none."""
    if capture.sums_only or capture.gyro is None:
        return []
    again, _ = _solved_from_capture(capture, placements, record.accel["P"], old)
    there = again is not None and again.verdict != "refused"
    return [Check("gyro", "not in the record", "verdict " + again.verdict if again else "none",
                  not there)]


def _remarks(section, old):
    if not section["missing"]:
        return []
    return ["the gyro's %s was not flipped: %s is expected there" % (
        " and ".join("xyz"[k] for k in section["missing"]),
        "the matrix of the record before" if old else "the data sheet's scale")]


def _solved_from_capture(capture, placements, accel_P, old):
    """(GyroscopeResult, "") of the shared judge from the host's own sums, or (None, why not)."""
    return solution.solve_gyro(capture, placements, pose_sums.moves(capture, placements), accel_P,
                               old)
