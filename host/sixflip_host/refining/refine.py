"""sixflip refine: all rests and moves of a capture in one least squares, with covariance."""

import json

import numpy as np

from sixflip import correction_record
from sixflip.faces import LEANING

from .. import atomic_write, file_kinds, progress
from ..capture import capture_file
from ..errors import BadFile, CheckFailed, UsageError
from ..file_arguments import add_input, add_output
from ..history import remember
from ..simulating import pose_runs
from ..solving import gyro_rests, multiposition
from ..solving.rests_and_moves import RestsAndMoves
from ..verifying.verify_files import read_record
from . import joint_refinement, kept_parameters, refinement_record, refinement_report
from . import refinement_answer as answer

HELP = "refine a calibration from all rests and moves of a capture, with uncertainties"
EXAMPLE = ("sixflip refine capture.csv -o refined.bin\n"
           "         sixflip refine hand_held.csv --free\n"
           "         sixflip refine on_the_floor.csv --record record.bin -o updated.bin")
LABELS = "labels"
SHORTEST = 20  # samples of a labelled rest that count


def add_arguments(parser):
    """The options of the verb."""
    add = parser.add_argument
    add_input(parser, "capture", help="capture file, text or a board's own")
    add("--json", action="store_true", help="the answer as one JSON object")
    add_input(parser, "--record", metavar="RECORD", help="solve only what this session tells, "
              "keep the rest from this record (robots that cannot take all six faces)")
    add_output(parser, "-o", "--output", metavar="NEW", kinds=(file_kinds.RECORD,),
               help="write the refined correction record")
    add("--free", action="store_true", help="faces and labels left aside: rests found by "
        "themselves, |a| = g in free poses, nine terms")
    add("--g-sensitivity", choices=("auto", "on", "off"), default="auto",
        help="gyro's pull by gravity (default: when the rests show it; with -o only when on: "
        "nothing is held out here that would show its gain, as diagnose --record does)")


def run(args):
    """Refine, print, write; 1 when the calibration is refused."""
    if args.free and args.record:
        raise UsageError("--free and --record: expected one of the two, a record has its axes")
    capture = capture_file.read_samples(args.capture)
    record = read_record(args.record) if args.record else None
    pull = args.g_sensitivity
    if args.output and pull == "auto":
        pull = "off"
    with progress.during("refine: all rests and moves together"):
        found = refine(capture, args.free, record, pull)
    remember.refined(capture, found)
    if args.json:
        print(json.dumps(found, allow_nan=False))
    else:
        refinement_report.show(found)
    if found["verdict"] == "refused":
        return CheckFailed.exit_code
    if args.output:
        data = correction_record.encode(refinement_record.build(capture, found, record))
        atomic_write.write_bytes(args.output, data)
    return 0


def refine(capture, free=False, record=None, g_sensitivity="auto"):
    """The answer (a dictionary, JSON-able) of a capture; see the verb's options.

    record: a correction Record to keep the undetermined from.
    """
    runs, source = rests_of(capture, free)
    session = RestsAndMoves(capture, runs, far_pairs=source == LABELS)
    told, kept = None, None
    if record is not None:
        result, told, kept = kept_parameters.refine(session, record)
    else:
        per_g = g_sensitivity == "on" or (
            g_sensitivity == "auto" and gyro_rests.pulled_by_gravity(session))
        if g_sensitivity == "on" and not session.has_gyro:
            raise BadFile("no gyro columns, expected gx gy gz for --g-sensitivity on")
        result = joint_refinement.refine(session, per_g)
    return assemble(capture, session, result, source, told, kept)


def rests_of(capture, free):
    """[(pose code, first, end)] and where they come from, in words."""
    if capture.pose is not None and capture.pose.any():
        runs = [run for run in pose_runs.runs(capture.pose) if run[2] - run[1] >= SHORTEST]
        if free:
            return renamed([(f, e) for _, f, e in runs]), "labels, taken as free poses"
        return runs, LABELS
    if free:
        lsb = float(capture.meta["accel_lsb_per_g"])
        if len(capture) < 2 * multiposition.rest_intervals.WINDOW:
            raise BadFile("%d samples, expected a session of rests" % len(capture))
        try:
            fit = multiposition.search(capture.accel * (capture.g / lsb), capture.g)
        except ValueError as error:
            raise CheckFailed(str(error))
        return renamed([(f, f + n) for f, n in fit.rests]), "found by |a| = g (Tedaldi)"
    from ..solving.find_poses import find_poses
    found = find_poses(capture)
    return pose_runs.runs(np.asarray(found.pose)), "found against the sensor's own noise"


def renamed(spans):
    """Spans as leaning poses L1, L2, ..."""
    return [(LEANING + 1 + k, first, end) for k, (first, end) in enumerate(spans)]


def assemble(capture, session, result, source, told, kept):
    """Everything about a refinement in one dictionary."""
    lost, weak = answer.left_open(session, result) if told is None else ([], [])
    judged, reason = answer.verdict(session, result, lost)
    off = answer.norm_off_mg(result)
    out = {
        "format": 1, "sensor": capture.meta["sensor"], "g": capture.g,
        "rests": len(session.codes), "rests_from": source, "moves": len(session.ends),
        "moves_left_out": session.left_out,
        "accel": answer.accelerometer(result, capture.g),
        "norm_off_mg": dict(zip(session.names, off.tolist())),
        "norm_off_mg_rms": float(np.sqrt(np.mean(off**2))),
        "gyro": answer.gyro(result) if session.has_gyro and session.ends else None,
        "moves_off_deg_rms": answer.moves_off_deg(session, result),
        "flips": answer.flips(session, result),
        "flip_spread_deg": None if result.hand is None else float(np.degrees(result.hand)),
        "equations": {name: {"number": n, "freedom": freedom,
                             "times_expected_error": result.equations.sigma[name]}
                      for name, (_, n, freedom) in result.groups.items()},
        "not_determined": [name for _, shares in lost[:1] for name in shares] + weak,
        "solved": told, "kept": kept, "verdict": judged, "reason": reason,
    }
    if not session.has_gyro:
        out["gyro_missing"] = ("no gyro columns: flips are taken as 180 degrees and there is "
                               "nothing to refine a gyro from")
    return out
