"""sixflip stream: the samples of a running board, as they come.

The nodes of the paper, all on one board: raw_imu is the raw stream, do_calib the calibration
(on the board, or sixflip solve from a capture), apply_calib the corrected stream, and the robot
reads that over the same serial line, as text or as binary frames (stream_frame.py).
"""

import contextlib
import math
import sys

from .. import file_kinds
from ..board.event_words import words
from ..board.ports import add_port, open_link
from ..board.stream_session import SLOWEST_HZ, StreamSession
from ..calibrate.verify_files import read_record
from ..errors import UsageError
from ..file_arguments import add_output
from ..streaming import publishing
from ..terminal import plain

EXAMPLE = "sixflip stream --heading --hz 20"

COLUMNS = {
    "raw": ("ax", "ay", "az", "gx", "gy", "gz", "temp"),
    "corrected": ("ax_mps2", "ay_mps2", "az_mps2", "gx_radps", "gy_radps", "gz_radps"),
    "heading": ("roll_deg", "pitch_deg", "yaw_deg"),
}


def add_arguments(parser):
    """The options of the verb."""
    add_port(parser)
    what = parser.add_mutually_exclusive_group()
    for name, text in (("raw", "counts as the chip gives them"),
                       ("corrected", "m/s² and rad/s (the default)"),
                       ("heading", "roll, pitch and yaw in degrees")):
        what.add_argument("--" + name, dest="what", action="store_const", const=name, help=text)
    parser.set_defaults(what="corrected")
    parser.add_argument("--binary", action="store_true",
                        help="frames with sequence and CRC on the wire: lost ones are counted")
    parser.add_argument("--hz", type=float, help="samples a second (default: what the board is "
                                                 "set to)")
    parser.add_argument("--seconds", type=float, metavar="N", help="by the board's clock "
                                                                   "(default: until Ctrl-C)")
    add_output(parser, "-o", "--output", metavar="FILE", help="CSV (default: the screen)",
               kinds=(file_kinds.SAMPLES, file_kinds.CORRECTED))
    publishing.add_arguments(parser)


def run(args):
    """Print samples as CSV; what else the board says and the count go to stderr."""
    if args.hz is not None and not SLOWEST_HZ <= args.hz <= 500:
        raise UsageError("--hz %g: expected %g to 500" % (args.hz, SLOWEST_HZ))
    if args.seconds is not None and not args.seconds > 0:
        raise UsageError("--seconds %g: expected more than 0" % args.seconds)
    robots = publishing.asked(args)
    record = read_record(args.record) if args.record else None
    with open_link(args.port) as link:
        if robots and record is None:
            record = publishing.record_of(link)
        session = StreamSession(link, args.what, args.binary, args.hz, show)
        with contextlib.ExitStack() as stack:
            stack.callback(report, session)
            stack.callback(session.close)
            to = publishing.Publishing(args, record, stack, tell) if robots else None
            write(session, args, stack, to)
    return 0


def write(session, args, stack, to=None):
    """Header and rows, every one as soon as it is there; where it is published (to), only into a
    file."""
    file = None
    for t_us, values in session.samples(args.seconds):
        if to:
            to.publish(t_us, values)
            if args.output is None:
                continue
        if file is None:     # a board that does not stream leaves no empty file behind
            file = sys.stdout if args.output is None else stack.enter_context(
                open(args.output, "w", encoding="utf-8", newline="\n"))  # noqa: SIM115
            print(",".join(("t_us",) + COLUMNS[args.what]), file=file)
        print("%d,%s" % (t_us, ",".join([cell(x) for x in values])), file=file,
              flush=file is sys.stdout)


def cell(value):
    """Seven digits, all that a board's float has; nothing for what was not measured."""
    return "" if value is None or math.isnan(value) else "%.7g" % value


def show(event):
    """Bus errors and the like."""
    text = words(event)
    if text:
        print(plain(text), file=sys.stderr)


def tell(text):
    """What is published where, and jumps of the board's clock."""
    print(plain(text), file=sys.stderr)


def report(session):
    """How much came, and how much did not."""
    if session.before is None:
        return
    text = "%d samples" % session.taken
    if session.binary:
        text += ", %d frames lost" % session.lost
    if session.damaged:
        text += ", %d damaged lines" % session.damaged
    print(text, file=sys.stderr)
