"""sixflip verify: is the board's arithmetic right? Everything again from the raw capture."""
import json

from .. import progress
from ..calibrate import verification, verify_files
from ..errors import BadFile, UsageError
from ..file_arguments import add_input
from ..history import logbook
from ..json_numbers import finite
from ..terminal import console, plain, styled, table

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
        checks, remarks = verification.verify(capture, record, before)
    others = verification.not_verifiable(capture, record, before)
    failed = [check for check in checks if not check.ok]
    logbook.verified(capture, record, checks)
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


def _words(capture_path, record_path, record, checks, failed, remarks, others):
    """What was compared, what differs, and the answer."""
    screen = console()
    screen.print(plain("%s against %s (%d comparisons, board with %d-bit floats)" % (
        record_path, capture_path, len(checks), record.float_bits)))
    for remark in remarks:
        screen.print(plain("  " + remark))
    for why in dict.fromkeys(why for _, why in others):
        screen.print(plain("  not verifiable: %s (%s)" % (", ".join(
            field for field, reason in others if reason == why), why)))
    if not failed:
        screen.print(styled("the board's arithmetic is right", "bold green"))
        return
    rows = [check.row() for check in failed]
    screen.print(table("what differs", ["", "board", "host", "limit"], rows))
    screen.print(styled("%d of %d comparisons differ" % (len(failed), len(checks)), "bold red"))
