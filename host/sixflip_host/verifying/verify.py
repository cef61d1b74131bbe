"""sixflip verify: is the board's arithmetic right? Everything again from the raw capture."""

import json

from sixflip.accelerometer import best_level
from sixflip.faces import face_of_code

from .. import progress
from ..errors import BadFile, UsageError
from ..file_arguments import add_input
from ..history import remember
from ..solving import solution
from ..solving.solve import finite
from ..terminal import console, plain, styled, table
from . import unverifiable, verify_checks, verify_files, verify_flips, verify_gyro

HELP = "recompute everything from the raw capture and compare with the board's record"
EXAMPLE = "sixflip verify pulled/e6614c311b4c5a2f"


def add_arguments(parser):
    """The options of the verb."""
    add_input(parser, "files", nargs="+", metavar="DIR | CAPTURE RECORD",
              help="the folder `pull` made, or a capture and a record")
    parser.add_argument("--json", action="store_true", help="every comparison as JSON")


def run(args):
    """Compare; 0 when everything agrees, 1 with a table of what differs."""
    if len(args.files) > 2:
        raise UsageError("%d files, expected DIR or CAPTURE RECORD" % len(args.files))
    with progress.during("verify"):
        capture_path, capture, record_path, record = verify_files.find(args.files)
        before = verify_files.record_before(record_path, record)
        if not (capture.board_placements or capture.placements()):
            raise BadFile("%s: no placement in it, cut short before the first one: nothing to "
                          "compare the record with" % capture_path)
        checks, remarks = verify(capture, record, before)
    others = unverifiable.fields(capture, record, before)
    failed = [check for check in checks if not check.ok]
    remember.verified(capture, record, checks)
    if args.json:
        print(json.dumps(finite({
            "format": 1, "ok": not failed, "capture": str(capture_path),
            "record": str(record_path), "float_bits": record.float_bits,
            "sums_only": capture.sums_only, "remarks": remarks,
            "checks": [vars(check) for check in checks],
            "not_verifiable": [{"field": field, "why": why} for field, why in others]})))
        return 1 if failed else 0
    _words(capture_path, record_path, record, checks, failed, remarks, others)
    return 1 if failed else 0


def verify(capture, record, before=None):
    """Every Check of a record against a capture, and remarks on what could not be checked.

    before  the record before, None where there is none
    """
    remarks = []
    checks = verify_checks.belong_together(capture, record)
    if capture.truncated:
        remarks.append("the capture is not whole: " + capture.truncated)
        checks.append(verify_checks.Check("capture", capture.truncated, "", False, "whole"))
    if capture.sums_only:
        remarks.append("the board kept only the sums: this vouches for the solve alone, "
                       "not for the sums it started from")
    elif capture.board_placements is None:
        remarks.append("a text capture has no sums of the board: the host's own are used")
    else:
        checks += verify_checks.pose_blocks(capture)
    placements = capture.board_placements or capture.placements()
    if record.accel is None:
        return checks + [verify_checks.Check("accelerometer", "not in the record", "", False)], \
            remarks
    checks += verify_checks.accelerometer(record, placements, record.accel_lsb_per_g,
                                          verify_flips.angles(record))
    found, said = verify_flips.checks(capture, record, placements, before)
    checks += found
    remarks += said
    old_gyro = before and before.gyro["P"]
    checks += _verdict(capture, record, placements, old_gyro)
    found, said = verify_gyro.checks(capture, record, placements, old_gyro)
    checks += found
    remarks += said
    if record.gyro_lsb_per_dps:
        checks += verify_checks.gyro_bias(record, placements)
    checks += verify_checks.temperature(record, capture, placements)
    return checks, remarks


def _verdict(capture, record, placements, old_gyro):
    """Level, and the verdict the shared judge gives now that the samples are at hand."""
    again = solution.judge(capture, placements, record.g, record.accel["level"],
                           angles=verify_flips.angles(record))
    verify_flips.doubts(capture, record, placements, again, old_gyro)
    check = verify_checks.same("verdict", record.accel["verdict"], again.verdict)
    if capture.sums_only and (check.board, check.host) == ("doubtful", "good") \
            and "flip" in record.accel["reason"]:
        check.ok = True     # what the gyro saw of the flips was not kept
    if not check.ok:
        check.host = "%s: %s" % (again.verdict, again.reason)
    checks = [check, verify_checks.same("level", record.accel["level"], best_level(
        [one.pose for one in placements if face_of_code(one.pose) >= 0]))]
    if check.ok and not capture.sums_only:
        checks.append(verify_checks.same_words("reason", record.accel["reason"], again.reason,
                                               record.float_bits))
    return checks


def _words(capture_path, record_path, record, checks, failed, remarks, others):
    """What was compared, what differs, and the answer."""
    out = console()
    out.print(plain("%s against %s (%d comparisons, board with %d-bit floats)" % (
        record_path, capture_path, len(checks), record.float_bits)))
    for remark in remarks:
        out.print(plain("  " + remark))
    for why in dict.fromkeys(why for _, why in others):
        out.print(plain("  not verifiable: %s (%s)" % (", ".join(
            field for field, reason in others if reason == why), why)))
    if not failed:
        out.print(styled("the board's arithmetic is right", "bold green"))
        return
    rows = [[check.name, cell(check.board), cell(check.host), check.limit] for check in failed]
    out.print(table("what differs", ["", "board", "host", "limit"], rows))
    out.print(styled("%d of %d comparisons differ" % (len(failed), len(checks)), "bold red"))


def cell(value):
    """A value of a comparison as text."""
    return "%.12g" % value if isinstance(value, float) else str(value)
