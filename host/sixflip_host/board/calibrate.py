"""sixflip calibrate: guides a person through the six faces and their flips, or a plan, live."""

import contextlib
import json

from ..errors import CheckFailed, Interrupted, NoBoard, SixflipError, UsageError
from ..history import remember
from ..planning import board_plan
from . import typed_lines
from .board_events import events
from .console import Console
from .ports import add_port, open_link

HELP = "calibrate a board now, guided face by face"
EXAMPLE = "sixflip calibrate"
FLAG = "calibrate.flag"
FACES = ("Z+", "Z-", "X+", "X-", "Y+", "Y-")
SILENCE_S = 30
TOTAL_S = 3600
JOIN_S = 3
STOP_S = 10


def add_arguments(parser):
    add_port(parser)
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--plan", metavar="FILE|NAME",
                      help="a session of a plan (sixflip plan --save FILE), or paper, recommended")
    what.add_argument("--redo", metavar="FACE", choices=FACES,
                      help="take one face of the last session again, or of the one that is under "
                           "way: " + " ".join(FACES))
    parser.add_argument("--session", metavar="N", type=int, default=1,
                        help="which session of the plan (default: the first)")


def ask_for_calibration(link, request=None):
    """Leave the flag on the flash, with what is asked for in it, and start the firmware.

    Returns the board's id: what the firmware says at once is lost while a USB port comes back.
    """
    if "main.py" not in link.files([]):
        raise NoBoard("%s: the firmware is not on this board: sixflip provision" % link.port)
    try:
        link.put(FLAG, json.dumps(request).encode() if request else b"")
        board = link.board_id()
        link.reset()
        return board
    except KeyboardInterrupt:
        with contextlib.suppress(SixflipError, OSError):
            link.remove(FLAG)
        raise


def rate_of(link):
    """rate_hz of the board's settings."""
    try:
        rate = json.loads(link.get("sixflip.json"))["rate_hz"]
        return rate if 1 <= rate <= 1000 else 100
    except (SixflipError, OSError, ValueError, KeyError, TypeError):
        return 100


def follow(link, show, typed=None, say=print, board=None):
    """Show events until the calibration is over; returns the solved event or raises.

    Over is: saved, or the firmware streams again, or it stopped. typed: TypedLines, whose
    lines are sent on. What came of it goes into the history, under the id the firmware says,
    or board where its first words were lost.
    """
    witness = remember.Witness(board)
    try:
        return _follow(link, show, typed, say, witness)
    finally:
        witness.done()


def _follow(link, show, typed, say, witness):
    solved = None
    failed = None
    for event in events(link, SILENCE_S, TOTAL_S):
        witness.hear(event)
        show(event)
        kind = event["event"]
        if kind == "solved":
            solved = event
        elif kind == "error":
            failed = event
        elif kind == "saved" and solved:
            return solved
        elif kind in ("ready", "stopped"):
            break
        line = typed.poll() if typed else None
        if line is not None:
            try:
                link.send(json.dumps(typed_lines.command(line)))
            except ValueError as error:
                say(str(error))
    if solved:
        return solved
    if failed:
        raise CheckFailed("not calibrated: %s" % failed.get("what"))
    raise NoBoard("%s: no calibration came to an end on this board; is its firmware of this "
                  "version? (sixflip provision)" % link.port)


def join(link, face):
    """Ask a calibration that is under way and has the face for it again. False when there is
    none: a board without a record begins one by itself."""
    for event in events(link, JOIN_S, JOIN_S):
        if event["event"] == "state":
            missing = event.get("missing")
            if not isinstance(missing, list) or {face + "a", face + "b"} <= set(map(str, missing)):
                return False
            link.send(json.dumps({"cmd": "redo", "face": face}))
            return True
    return False


def stop(link):
    """After Ctrl-C: end the session on the board; a sentence on what is kept."""
    kept = 0
    with contextlib.suppress(SixflipError, OSError):
        link.send("")  # what was being sent
        link.send(json.dumps({"cmd": "stop"}))
        for event in events(link, STOP_S, STOP_S):
            if event["event"] == "capture":
                kept = event.get("samples") or 0
            elif event["event"] in ("saved", "ready", "stopped"):
                break
    if kept:
        return ("stopped; the %s samples so far stay on the board: sixflip calibrate --redo FACE "
                "goes on with them, sixflip pull fetches them" % kept)
    return "stopped; nothing on the board has changed"


def start(link, args, session):
    """Ask for what the command line says; the board's id, None when it was not asked."""
    if args.redo:
        if join(link, args.redo):
            return None
        return ask_for_calibration(link, {"redo": args.redo})
    if session:
        return ask_for_calibration(link, board_plan.request(session, rate_of(link)))
    return ask_for_calibration(link)


def run(args):
    session = board_plan.session_of(args.plan, args.session) if args.plan else None
    if session is None and args.session != 1:
        raise UsageError("--session %d: only with --plan" % args.session)
    step = (lambda at: board_plan.step(session, at)) if session else None
    console = Console(step=step)
    with open_link(args.port) as link:
        board = start(link, args, session)
        try:
            with typed_lines.TypedLines(console.echo) as typed:
                if typed.live:
                    console.say(typed_lines.HELP)
                solved = follow(link, console.show, typed, console.say, board)
        except KeyboardInterrupt:
            console.clear()
            raise Interrupted(stop(link)) from None
    console.clear()
    return 1 if solved.get("verdict") == "refused" else 0
