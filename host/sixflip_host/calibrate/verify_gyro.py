"""What a record says of the gyro and by the gyro: its own section, and the flip angles the
accelerometer was solved with, against what the raw samples of flips and rests say."""

import math

import numpy as np

from sixflip.gyro.flips import NO_FLIP
from sixflip.poses.faces import FACES, SIGN, face_of_code, is_b

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
    compared = [same("gyro, axes without a flip", list(section["missing"]), host.missing)]
    for i, j in np.ndindex(4, 3):
        compared.append(close("gyro P[%d][%d]" % (i, j), P[i, j], host.P[i, j], relative,
                              absolute))
    for i, j in np.ndindex(4, 3):
        compared.append(close("gyro sigma P[%d][%d]" % (i, j), section["sigma_P"][i][j],
                              host.sigma[i, j], 1e-4 if double else 0.05, 1e-7))
    solved, why = _solved_from_capture(capture, placements, accel_P, old)
    compared.append(same("gyro verdict", section["verdict"],
                         solved.verdict if solved else "none: " + why))
    if solved:
        compared.append(same_words("gyro reason", section["reason"], solved.reason,
                                   record.float_bits))
    return compared, _remarks(section, old)


def _left_out(capture, record, placements, old):
    """A board leaves the gyro out where its own is refused, or there is none."""
    if capture.sums_only or capture.gyro is None:
        return []
    solved, _ = _solved_from_capture(capture, placements, record.accel["P"], old)
    there = solved is not None and solved.verdict != "refused"
    return [Check("gyro", "not in the record", "verdict " + solved.verdict if solved else "none",
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


def flip_angles(record):
    """{face: rad} the record says the accelerometer was solved with; None: half turns."""
    if record.flips is None:
        return None
    return {face: math.pi + d for face, d in enumerate(record.flips["excess"]) if d}


def flip_checks(capture, record, placements, before):
    """(Checks of record.flips, remarks). before: the record in the other slot, or None."""
    section = record.flips
    if section is None:
        return [], []
    if capture.sums_only:
        return [], ["no samples of the moves were kept: the flip angles are taken as stated"]
    if capture.gyro is None:
        return [Check("flip angles", "in the record", "no gyro in the capture", False)], []
    if before is None or before.gyro is None or before.sequence != section["sequence"]:
        return [], ["the flip angles came from the gyro of record %s, which is not here: they "
                    "are taken as stated" % ("number nan" if section["sequence"] is None
                                             else "%d" % section["sequence"])]
    known = [k for k in range(3) if k not in before.gyro["missing"]]
    sigma = max(before.gyro["sigma_P"][k][k] for k in known)
    double = record.float_bits == 64
    host = _excess(capture, placements, np.array(before.gyro["P"]), known, sigma)
    compared = [close("gyro scale behind the flip angles", section["scale_sigma"], sigma, 1e-5)]
    for face in range(6):
        compared.append(close("flip of %s, rad beyond half a turn" % FACES[face],
                              section["excess"][face], host.get(face, 0.0), 0.0,
                              1e-9 if double else 2e-5))
    return compared, []


def _excess(capture, placements, P, known, sigma):
    """{face: rad beyond half a turn}, weighed against the gyro's error as METHOD 1 asks."""
    lsb = capture.meta["gyro_lsb_per_dps"]
    rests = [one for one in placements if one.n > 0]
    bias = np.radians(sum(capture.gyro[one.first:one.first + one.n].sum(axis=0, dtype=np.int64)
                          for one in rests) / sum(one.n for one in rests) / lsb)
    turns_of = {}
    for at, k, _, (first, second) in reference_gyro.half_turns(
            capture, placements, bias, P[:3]):
        face = face_of_code(first)
        if k in known:
            turn = SIGN[face] * ((at.turned - bias * at.T) @ P[:3])[k]
            turn = -turn if is_b(first) and not is_b(second) else turn
            turns_of.setdefault(face, []).append(turn % (2 * np.pi) - np.pi)
    off = {face: float(np.mean(each)) for face, each in turns_of.items()}
    off = {face: d for face, d in off.items() if abs(d) < NO_FLIP}
    own = 2 * (np.pi * sigma) ** 2
    square = np.mean(np.square(list(off.values()))) if off else 0.0
    return {face: d * (1 - own / square) for face, d in off.items()} if square > own else {}


def doubt_flips(capture, record, placements, solved, old_P=None):
    """The shared judge's verdict (a Solution) once the gyro has spoken, as on the board."""
    solved.gyro = None
    if solved.accel and not capture.sums_only and capture.gyro is not None:
        moves = pose_sums.moves(capture, placements)
        solved.gyro, _ = solution.solve_gyro(capture, placements, moves, solved.accel.P, old_P)
    solution.doubt_flips(solved, set(flip_angles(record) or ()))
    return solved
