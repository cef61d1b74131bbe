"""The flip angles a board solved with, from the raw samples and the earlier record's gyro."""

import math

import numpy as np

from sixflip.gyro.flips import NO_FLIP
from sixflip.poses.faces import FACES, SIGN, face_of_code, is_b

from ..capture import pose_sums
from . import reference_gyro, solution
from .verify_checks import Check, close


def angles(record):
    """{face: rad} the record says the accelerometer was solved with; None: half turns."""
    if record.flips is None:
        return None
    return {face: math.pi + d for face, d in enumerate(record.flips["excess"]) if d}


def checks(capture, record, placements, before):
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
    host = excess(capture, placements, np.array(before.gyro["P"]), known, sigma)
    out = [close("gyro scale behind the flip angles", section["scale_sigma"], sigma, 1e-5)]
    for face in range(6):
        out.append(close("flip of %s, rad beyond half a turn" % FACES[face],
                         section["excess"][face], host.get(face, 0.0), 0.0,
                         1e-9 if double else 2e-5))
    return out, []


def excess(capture, placements, P, known, sigma):
    """{face: rad beyond half a turn}, weighed against the gyro's error as METHOD 1 asks."""
    lsb = capture.meta["gyro_lsb_per_dps"]
    rests = [one for one in placements if one.n > 0]
    bias = np.radians(sum(capture.gyro[one.first:one.first + one.n].sum(axis=0, dtype=np.int64)
                          for one in rests) / sum(one.n for one in rests) / lsb)
    found = {}
    for at, k, _, (first, second) in reference_gyro.half_turns(
            capture, placements, bias, P[:3]):
        face = face_of_code(first)
        if k in known:
            turn = SIGN[face] * ((at.turned - bias * at.T) @ P[:3])[k]
            turn = -turn if is_b(first) and not is_b(second) else turn
            found.setdefault(face, []).append(turn % (2 * np.pi) - np.pi)
    off = {face: float(np.mean(each)) for face, each in found.items()}
    off = {face: d for face, d in off.items() if abs(d) < NO_FLIP}
    own = 2 * (np.pi * sigma) ** 2
    square = np.mean(np.square(list(off.values()))) if off else 0.0
    return {face: d * (1 - own / square) for face, d in off.items()} if square > own else {}


def doubts(capture, record, placements, again, old_P=None):
    """The shared judge's verdict (a Solution) once the gyro has spoken, as on the board."""
    again.gyro = None
    if again.accel and not capture.sums_only and capture.gyro is not None:
        moves = pose_sums.moves(capture, placements)
        again.gyro, _ = solution.solve_gyro(capture, placements, moves, again.accel.P, old_P)
    solution.doubt_flips(again, set(angles(record) or ()))
    return again
