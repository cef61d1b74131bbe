"""A capture solved by the shared core, the code that also runs on the board."""

import numpy as np

from sixflip import RAIL
from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer import verdict
from sixflip.chips import catalogue
from sixflip.gyro import solver as gyroscope
from sixflip.gyro import verdict as gyro_verdict
from sixflip.poses.faces import face_of_code, pose_name

from ..capture import clock
from ..capture.capture_binary import write_pauses
from ..capture.find_poses import HELD_BY_HAND, find_poses
from ..capture.imports import units
from . import flips_turned

RATE_OFF = 0.2          # of the rate in the header
JUMP = 10               # times the usual interval
SESSION_WITH_FLIPS = 3  # faces turned by 180 degrees by chance are not that many


class Solution:
    """accel  AccelerometerResult or None when the poses do not determine it
    verdict, reason   about the accelerometer
    gyro   GyroscopeResult, or None and no_gyro says why
    flips  FlipsTurned: the turns the accelerometer was solved with
    placements, moves, capture
    remarks   sentences about the capture itself
    """


def solve(capture, g=None, level=None, half_turns=False):
    """Solve a capture; finds the poses first where nobody labelled them.

    g      m/s², None: what the capture says; level: as accelerometer.solve
    half_turns  take every flip for 180 degrees, whatever the gyro says
    """
    remarks = capture_remarks(capture)
    labelled = capture.pose is not None
    if not labelled and not capture.sums_only:
        posed = find_poses(capture)
        posed.label(capture)
        remarks += posed.remarks()
    flips = flips_turned.FlipsTurned("as asked for") if half_turns \
        else flips_turned.by_moves(capture, labelled)
    return of_placements(capture, flips, labelled, g, level, remarks=remarks)


def of_placements(capture, flips, labelled, g=None, level=None, halves=None, remarks=()):
    """Solution from what a capture's placements and moves say, with no look at its samples.

    flips  FlipsTurned; halves: as halves() gives them, None: they are taken from the samples
    """
    solved = Solution()
    solved.capture, solved.remarks, solved.flips = capture, list(remarks), flips
    placements = capture.placements()
    judge(capture, placements, capture.g if g is None else g, level, labelled, solved,
          flips.angles, halves)
    solved.moves = capture.moves() if not capture.sums_only else []
    solved.gyro, solved.no_gyro = solve_gyro(capture, placements, solved.moves,
                                             solved.accel and solved.accel.P, flips=solved.flips)
    doubt_flips(solved, set(solved.flips.angles))
    return solved


def doubt_flips(solved, known=()):
    """What the gyro saw of the flips reaches the accelerometer's verdict.

    known  faces whose turn was measured and taken into account
    """
    if solved.verdict == "refused" or solved.gyro is None:
        return
    sentence = gyro_verdict.accelerometer_doubt(solved.gyro, tolerance(solved.capture),
                                              solved.accel.tilt_deg, known)
    if sentence:
        solved.reason = sentence if solved.verdict == "good" else solved.reason + "; " + sentence
        solved.verdict = "doubtful"


def tolerance(capture):
    """Of the gyro's scale, by the data sheet; None for a chip we do not know."""
    sensor = capture.meta["sensor"]
    known = [row[0] for row in catalogue.CHIPS if row[1]]
    return catalogue.driver(sensor).gyro_tolerance if sensor in known else None


def judge(capture, placements, g, level=None, labelled=True, solved=None, angles=None, moved=None):
    """Solve the accelerometer from placements and judge it; fills a Solution. moved: what
    halves() gives of the capture, None: it is asked."""
    solved = solved or Solution()
    solved.capture = capture
    solved.placements, solved.g = placements, g
    lsb = capture.meta["accel_lsb_per_g"]
    solved.accel, failure = None, ""
    try:
        solved.accel = accelerometer.solve(solved.placements, lsb, solved.g, level, angles)
    except (ValueError, ZeroDivisionError) as error:
        failure = str(error)
    missing = [] if level == "no flips" else unfinished(solved.placements, labelled)
    solved.verdict, solved.reason = verdict.judge_accelerometer(
        solved.accel, solved.placements, lsb, missing, failure, rail(capture),
        halves(capture, solved) if moved is None else moved)
    return solved


def unfinished(placements, labelled):
    """Pose codes still missing from a session that was meant to have flips."""
    have = {one.pose for one in placements}
    flipped = [face for face in range(6) if {1 + 2 * face, 2 + 2 * face} <= have]
    if len(flipped) < (1 if labelled else SESSION_WITH_FLIPS):
        return []
    return [code for code in range(1, 13) if code not in have]


def rail(capture):
    """Accelerometer count at which the chip is saturated."""
    full_scale = capture.meta.get("accel_range_g", np.inf) * capture.meta["accel_lsb_per_g"]
    return int(min(RAIL, full_scale - 1))


def halves(capture, solution):
    """Per placement: mean counts of its second half minus its first, [x, y, z].

    Zero where the capture says that the box was held by hand: there nothing is still.
    """
    if capture.sums_only:
        return None
    by_hand = capture.meta.get(HELD_BY_HAND, [])
    differences = []
    for placement in solution.placements:
        middle, end = placement.first + placement.n // 2, placement.first + placement.n
        if placement.n < 2 or pose_name(placement.pose) in by_hand:
            differences.append([0.0] * 3)
            continue
        differences.append((capture.accel[middle:end].mean(axis=0)
                            - capture.accel[placement.first:middle].mean(axis=0)).tolist())
    return differences


def middles_mg(placements, lsb):
    """For every axis the middle between its two faces as read, mg; None where one is missing.

    Where faces are crooked or the table tilts this is wrong by the square of the angle only.
    """
    middles = []
    for up, down in ((2, 3), (4, 5), (0, 1)):       # X+ X-, Y+ Y-, Z+ Z-
        axis = len(middles)
        reads = [[one.sums[axis] / one.n for one in placements if face_of_code(one.pose) == face]
                 for face in (up, down)]
        middles.append(500 * sum(sum(r) / len(r) for r in reads) / lsb if all(reads) else None)
    return middles


def capture_remarks(capture):
    """What is worth knowing about the counts themselves."""
    remarks = []
    if capture.truncated:
        remarks.append("the capture is not whole: %s; %d samples could be read" % (
            capture.truncated, len(capture)))
    if capture.sums_only:
        remarks.append("the board kept only the sums: no samples to look into")
    if capture.meta.get(HELD_BY_HAND):
        remarks.append("held by hand, so not really still: %s" % " ".join(
            map(str, capture.meta[HELD_BY_HAND])))
    remarks += _time_remarks(capture)
    step = units.common_step(capture.accel) if len(capture) and capture.accel is not None else 1
    if step > 1:
        remarks.append("every accelerometer count is a multiple of %d: its resolution is %.2f mg"
                       % (step, 1e3 * step / capture.meta["accel_lsb_per_g"]))
    return remarks


def _time_remarks(capture):
    """What is odd about the timestamps: the gyro's integrals hang on them."""
    if len(capture) < 3:
        return []
    gaps = np.diff(capture.t_us)
    usual = float(np.median(gaps))
    remarks = []
    rate_hz = capture.meta["rate_hz"]
    measured = clock.sample_clock(capture)
    if measured and abs(measured.rate_hz / rate_hz - 1) > RATE_OFF:
        remarks.append("the timestamps say %.4g samples a second, the header %g" % (
            measured.rate_hz, rate_hz))
    gaps[write_pauses(capture)] = usual
    jumps = np.flatnonzero(gaps > JUMP * max(usual, 1.0))
    if len(jumps):
        longest = int(gaps.argmax())
        remarks.append("the timestamps jump in %d place%s, the farthest by %.2f s after sample %d"
                       % (len(jumps), "" if len(jumps) == 1 else "s", gaps[longest] / 1e6,
                          longest))
    return remarks


def solve_gyro(capture, placements, moves, accel_P=None, old=None, flips=None):
    """(GyroscopeResult, "") from flips and rests, or (None, why there is none).

    flips  FlipsTurned, where the moves say how far the flips turned
    """
    if capture.gyro is None and not capture.sums_only:
        return None, "the capture has no gyro columns"
    if capture.sums_only:
        return None, "the board kept only the sums: the gyro needs the samples of the moves"
    try:
        solved = gyroscope.solve(placements, moves, capture.meta["gyro_lsb_per_dps"], accel_P,
                                 old, capture.meta["accel_lsb_per_g"])
    except (ValueError, ZeroDivisionError) as error:
        return None, str(error)
    if solved.verdict == "good":
        doubt = flips_short(flips.measured) if flips and flips.measured else \
            gyro_verdict.scale_doubt(solved, tolerance(capture))
        if doubt:
            solved.verdict, solved.reason = "doubtful", doubt
    return solved, ""


def flips_short(measured):
    """What is wrong with a scale from half turns when the moves say they were none, or ""."""
    for axis, faces in enumerate(((2, 3), (4, 5), (0, 1))):     # X+ X-, Y+ Y-, Z+ Z-
        both = [measured[face] for face in faces if face in measured]
        off = sum(degrees - 180.0 for degrees, _ in both) / max(len(both), 1)
        if both and abs(off) > max(flips_turned.OFF_DEG, 3 * max(s for _, s in both)):
            return ("by the face-to-face moves the flips about %s turned by %.1f degrees, not "
                    "180: its scale is off by %.1f %%; sixflip refine gives the right one"
                    % ("xyz"[axis], 180.0 + off, abs(off) / 1.8))
    return ""
