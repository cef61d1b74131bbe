"""sixflip refine: all rests and moves of a capture in one least squares, with covariance."""
import json

from sixflip.record import correction_record

from .. import atomic_write, file_kinds, progress
from ..calibrate.verify_files import read_record
from ..capture import open_recording
from ..errors import CheckFailed, UsageError
from ..file_arguments import add_input, add_output
from ..history import logbook
from ..present import calibration_words
from ..terminal import say

EXAMPLE = ("sixflip refine capture.csv -o refined.bin\n"
           "         sixflip refine hand_held.csv --free\n"
           "         sixflip refine on_the_floor.csv --record record.bin -o updated.bin")


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
    from ..calibrate import refinement, refinement_record  # scipy
    if args.free and args.record:
        raise UsageError("--free and --record: expected one of the two, a record has its axes")
    capture = open_recording.read_samples(args.capture)
    record = read_record(args.record) if args.record else None
    pull = args.g_sensitivity
    if args.output and pull == "auto":
        pull = "off"
    with progress.during("refine: all rests and moves together"):
        refined = refinement.refine(capture, args.free, record, pull)
    logbook.refined(capture, refined)
    if args.json:
        said = {"assumed": capture.assumed} if capture.assumed else {}
        print(json.dumps(dict(refined, **said), allow_nan=False))
    else:
        say(capture.assumed)
        calibration_words.show_refinement(refined)
    if refined["verdict"] == "refused":
        return CheckFailed.exit_code
    if args.output:
        data = correction_record.encode(refinement_record.build(capture, refined, record))
        atomic_write.write_bytes(args.output, data)
    return 0
