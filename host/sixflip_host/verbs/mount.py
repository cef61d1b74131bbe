"""sixflip mount: roll and pitch of an installed sensor from gravity at rest (Promrit)."""
import json
import os

from sixflip.record import correction_record
from sixflip.record.record import following

from .. import atomic_write, file_kinds
from ..board.board_events import wait_for
from ..board.console import Console
from ..board.ports import VARIABLE as PORT
from ..board.ports import open_link
from ..calibrate import verify_files
from ..capture import capture_file
from ..errors import CheckFailed, UsageError
from ..file_arguments import add_input, add_output
from ..mounting import mounting_angles, robot_axes
from ..terminal import say

EXAMPLE = ("sixflip mount rest.csv --record record_a.bin --axes x=-y,y=x,z=z -o mounted.bin\n"
           "         sixflip mount --vector -0.2235 0.4937 0.8330 --both\n"
           "         sixflip mount --port /dev/ttyACM0 --axes ned")
RULE = "|√(Gy²+Gz²)-1| = %.4f %s |√(Gx²+Gz²)-1| = %.4f"
CHAIN = ("the sensor is corrected first, then turned: measured = (I+S+M) R a + b; the paper's "
         "chain R (I+S+M) a + b puts its errors before the rotation")


def add_arguments(parser):
    """The options of the verb."""
    add = parser.add_argument
    add_input(parser, "capture", nargs="?", help="capture of some seconds of rest, engine off")
    add("--vector", nargs=3, type=float, metavar=("GX", "GY", "GZ"),
        help="instead: gravity as read, calibrated and averaged, in g")
    add_input(parser, "--record", help="correction record of this sensor")
    add("--axes", default="rep103", metavar="AXES",
        help="the robot's axes: rep103 (forward, left, up), ned (forward, right, down), or "
        "where each lies in the sensor, such as x=-y,y=x,z=z (default: rep103)")
    add("--order", choices=("xyz", "yxz"), help="default: the paper's rule (Promrit Eq. 6)")
    add("--both", action="store_true", help="both orders")
    add_output(parser, "-o", "--output", metavar="RECORD", kinds=(file_kinds.RECORD,),
               help="write --record with this mounting in it")
    add("--port", metavar="PORT", help="instead: the board there measures it, keeps it in its "
        "record and applies it from then on (default, without a capture: $SIXFLIP_PORT)")
    add("--json", action="store_true", help="the answer as one JSON object")


def run(args):
    """Measure and answer."""
    on_board = args.port or not (args.capture or args.vector or args.record)
    if on_board and (args.port or os.environ.get(PORT)):
        if args.capture or args.vector or args.record or args.output or args.both:
            raise UsageError("--port: the board measures with its own record; expected only "
                             "--axes, --order and --json with it")
        return run_on_board(args)
    if (args.capture is None) == (args.vector is None):
        raise UsageError("expected a capture, --vector GX GY GZ, or --port (or %s)" % PORT)
    if args.output and not args.record:
        raise UsageError("--output needs --record, the record to put the mounting into")
    axes = robot_axes.parse(args.axes)
    if args.output and axes.left_handed:
        raise UsageError("--axes %s is left-handed: a record cannot hold it, expected "
                         "right-handed axes" % args.axes)
    record = verify_files.accelerometer_record(args.record) if args.record else None
    if args.vector:
        G, rest = list(args.vector), None
    else:
        G, rest = mounting_angles.gravity_of(capture_file.read_samples(args.capture), record)
    calibrated = record is not None or rest is None
    mounted = mounting_angles.answer(G, axes, args.order, record, calibrated)
    mounted["rest"] = rest
    if args.json:
        print(json.dumps(mounted))
    else:
        say(lines(mounted, args.both))
    if args.output:
        record.mounting = mounted["mounting"]
        record.sequence = following(record.sequence)
        atomic_write.write_bytes(args.output, correction_record.encode(record))
    return 0


def lines(mounted, both=False):
    """A mounting in lines for a person."""
    said = ["G = (%+.4f, %+.4f, %+.4f) g, length %.4f g%s" % (
        *mounted["G"], mounted["G_size"], "" if mounted["calibrated"] else
        ": not calibrated, its direction alone is used")]
    rest = mounted["rest"]
    if rest:
        said.append("  %d samples at rest, noise %.2f mg: the angles are good to %.3f deg by "
                    "noise alone" % (rest["samples"], rest["noise_mg"], rest["angle_sigma_deg"]))
        if not mounted["calibrated"]:
            said.append("  without --record the sensor's bias is in the angles: 10 mg are 0.6 deg")
    rule = mounted["rule"]
    said.append("paper's rule: R_%s, since %s" % (
        rule["order"], RULE % (rule["left"], "<" if rule["left"] < rule["right"] else ">=",
                               rule["right"])))
    orders = ("xyz", "yxz") if both else (mounted["order"],)
    for order in orders:
        angles = mounted["both"][order]
        said.append("order R_%s: roll %.4f deg, pitch %.4f deg, yaw 0 (gravity does not show it)"
                    "%s" % (order, angles["roll_deg"], angles["pitch_deg"],
                            " <- taken" if both and order == mounted["order"] else ""))
    said.append("axes: the robot's x y z lie along the sensor's %s%s" % (
        mounted["axes"], "; the answer is in NED: forward, right, down"
        if mounted["frame"] == "ned" else ""))
    if mounted["left_handed"]:
        said.append("  the axes asked for are left-handed, no way of mounting gives that: roll "
                    "and pitch are for y turned round; rates need the matrix with its sign turned")
    said.append("robot = C · sensor, C (order R_%s)" % mounted["order"])
    said += ["  %+.6f  %+.6f  %+.6f" % tuple(row) for row in mounted["compensation"]]
    said.append("G in the robot's axes: (%+.4f, %+.4f, %+.4f) g" % tuple(mounted["G_robot"]))
    said.append(CHAIN + ("; with this sensor's errors that is %.1f mg"
                         % mounted["chain_differs_mg"] if mounted["chain_differs_mg"] is not None
                         else ", 10.6 mg at 30 and 15 deg with scale errors of +2, +0.5, -1 %"))
    return said


def board_command(args):
    """The line for the board; UsageError where a board cannot do it."""
    axes = robot_axes.parse(args.axes)
    if axes.left_handed:
        raise UsageError("--axes %s is left-handed: a board cannot hold it, expected right-handed "
                         "axes" % args.axes)
    asked = {"cmd": "mount", "axes": axes.axes, "frame": axes.frame}
    if args.order:
        asked["order"] = args.order
    return asked


def ask_board(args):
    """The board's "mounted" event; CheckFailed with its reason."""
    asked = board_command(args)
    with open_link(args.port) as link:
        link.reset()
        started = wait_for(link, ("ready", "calibrating"))
        if started["event"] == "calibrating":
            raise CheckFailed("%s: no correction is in force, so the board is calibrating; a "
                              "mounting needs a calibrated sensor" % link.port)
        link.send(json.dumps(asked))
        answer = wait_for(link, ("mounted", "not_mounted", "error"), silence_s=60)
        while answer["event"] == "error" and "mount" not in answer["what"]:
            answer = wait_for(link, ("mounted", "not_mounted", "error"), silence_s=60)
    if answer["event"] == "error":
        raise CheckFailed("%s; expected %s" % (answer["what"], answer.get("expected")))
    if answer["event"] == "not_mounted":
        raise CheckFailed("no mounting measured: %s; the board goes on with %s" % (
            answer.get("reason"), "the one it has" if answer.get("mounting") == "stored"
            else "none"))
    return answer


def run_on_board(args):
    """Let the board measure it and keep it, and print what it answers."""
    answer = ask_board(args)
    if args.json:
        print(json.dumps(answer))
    else:
        Console().show(answer)
    return 0
