"""sixflip solve: a capture file through the shared core, the same code as on the board."""

import json

from sixflip.accelerometer.six_faces import LEVELS

from .. import progress
from ..calibrate import local_gravity as gravity
from ..calibrate import solution, solution_json
from ..capture import open_recording
from ..errors import UsageError
from ..file_arguments import add_input
from ..json_numbers import finite
from ..present import calibration_words
from ..terminal import say

EXAMPLE = "sixflip solve capture.csv --lat 48.1 --height 520"


def add_arguments(parser):
    """The options of the verb."""
    add = parser.add_argument
    add_input(parser, "capture", help="capture file: .csv, .csv.gz or a board's capture.bin")
    add("--json", action="store_true", help="the answer as one JSON object")
    add("--g", type=float, help="local gravity, m/s² (default: what the capture says)")
    add("--lat", type=float, metavar="DEG", help="latitude, for local gravity")
    add("--height", type=float, metavar="M", help="height above the ellipsoid (default 0)")
    add("--level", choices=LEVELS, help="default: the best the poses allow")
    add("--flips", choices=("measured", "180"), default="measured",
        help="turns between the two captures of a face: by the gyro where the face-to-face "
        "moves give its scale (default), or half turns")


def run(args):
    """Solve and answer; 1 when the verdict is refused."""
    g = local_gravity(args)
    with progress.during("solve"):
        capture = open_recording.read(args.capture)
        solved = solution.solve(capture, g, args.level, args.flips == "180")
    if args.json:
        said = {"assumed": capture.assumed} if capture.assumed else {}
        print(json.dumps(dict(finite(solution_json.to_json(solved)), **said), ensure_ascii=False))
    else:
        say(capture.assumed)
        calibration_words.show(solved)
    return 1 if solved.verdict == "refused" else 0


def local_gravity(args):
    """m/s² from --g, or --lat and --height; None when neither is there."""
    if args.lat is None:
        if args.height is not None:
            raise UsageError("--height needs --lat")
        if args.g is not None and not 9 < args.g < 11:
            raise UsageError("--g %g: expected m/s², between 9 and 11" % args.g)
        return args.g
    if args.g is not None:
        raise UsageError("--g and --lat: expected one of the two")
    try:
        return gravity.local(args.lat, args.height or 0.0)
    except ValueError as error:
        raise UsageError(str(error))
