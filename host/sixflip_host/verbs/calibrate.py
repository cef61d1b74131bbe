"""sixflip calibrate: guides a person through the six faces and their flips, or a plan, live."""
import json

from ..board import calibration_request, typed_lines
from ..board.board_events import events
from ..board.console import Console
from ..board.ports import HELP as PORT_HELP
from ..board.ports import open_link
from ..board.recording import Recording, RecordingLink
from ..board.session_end import Ending, SessionDeadline
from ..errors import Interrupted, UsageError
from ..file_arguments import add_input, add_output
from ..history import logbook
from ..planning import plan_file
from ..terminal import plain

EXAMPLE = ("sixflip calibrate\n         sixflip calibrate --replay capture.bin --speed 5\n"
           "         sixflip calibrate --all")
FACES = ("Z+", "Z-", "X+", "X-", "Y+", "Y-")
SILENCE_S = 30
TOTAL_S = 4 * 3600     # whatever goes on: the longest plan takes an hour


def add_arguments(parser):
    where = parser.add_mutually_exclusive_group()
    add_ports(where)
    add_input(where, "--replay", metavar="CAPTURE",
              help="no board: play a capture file through the firmware's own session")
    add_all(parser)
    what = parser.add_mutually_exclusive_group()
    add_input(what, "--plan", metavar="FILE|NAME",
              help="a session of a plan (sixflip plan --save FILE), or paper, recommended")
    what.add_argument("--redo", metavar="FACE", choices=FACES,
                      help="take one face of the last session again, or of the one that is under "
                           "way: " + " ".join(FACES))
    what.add_argument("--continue", dest="go_on", action="store_true",
                      help="go on with the session under way, or with the one that was left "
                           "unfinished; with neither begin a new one")
    parser.add_argument("--session", metavar="N", type=int, default=1,
                        help="which session of the plan (default: the first)")
    parser.add_argument("--speed", metavar="N", type=float,
                        help="of --replay: seconds of the capture a second (default: 1 on the "
                             "guided screen, as fast as it goes in lines)")
    add_output(parser, "--record", "-o", "--output", metavar="FILE", kinds=(), dest="recording",
               help="write the raw capture down on this computer while it is taken, whatever the "
                    "board's flash has room for (with --plan it is, as DEVICE-SESSION.bin here)")
    parser.add_argument("--no-record", action="store_true",
                        help="with --plan: leave the capture to the board's flash")
    parser.add_argument("--plain", action="store_true",
                        help="lines instead of the guided screen, for scripts and screen readers; "
                             "so it is anyway where the output is no terminal of 80 by 24")






def add_ports(parser):
    parser.add_argument("--port", metavar="PORT", action="append", help=PORT_HELP + "; with --all "
                        "as often as there are boards (default: all of $SIXFLIP_PORT, or all that "
                        "are plugged in)")


def add_all(parser):
    parser.add_argument("--all", action="store_true", dest="tray",
                        help="several boards in one jig, turned together, each with its own "
                             "verdict")


def follow(link, show, typed=None, say=print, board=None):
    """Show events until the calibration is over; returns the solved event or raises.

    Over is: saved, or the firmware streams again, or it stopped. typed: TypedLines, whose
    lines are sent on. What came of it goes into the history, under the id the firmware says,
    or board where its first words were lost.
    """
    witness = logbook.Witness(board)
    try:
        return _follow(link, show, typed, say, witness)
    finally:
        witness.done()


def _follow(link, show, typed, say, witness):
    ending, deadline = Ending(), SessionDeadline(link)
    for event in events(link, SILENCE_S, TOTAL_S):
        witness.hear(event)
        show(event)
        deadline.hear(event)
        if ending.take(event):
            break
        line = typed.poll() if typed else None
        if line is not None:
            try:
                link.send(json.dumps(typed_lines.command(line)))
            except ValueError as error:
                say(str(error))
    return ending.answer(link.port)








def recording_of(args, session):
    """The Recording that a command line asks for, None without one."""
    if args.recording is None and (session is None or args.no_record):
        return None
    return Recording(args.recording)


def start(link, args, session, recorded=False):
    """Ask for what the command line says; the board's id, None when it was not asked."""
    record = {"record": True} if recorded else {}
    if args.redo:
        if calibration_request.join(link, args.redo):
            return None
        return calibration_request.ask_for_calibration(link, {"redo": args.redo})
    if args.go_on:
        if calibration_request.under_way(link) is not None:
            return None
        return calibration_request.ask_for_calibration(link, {"continue": True})
    if session:
        return calibration_request.ask_for_calibration(
            link, dict(plan_file.request(session, calibration_request.rate_of(link)), **record))
    return calibration_request.ask_for_calibration(link, record)


def checked(args):
    """The plan's session, None without; UsageError for what does not go together."""
    if getattr(args, "tray", False):
        alone(args)
    elif isinstance(args.port, list) and len(args.port) > 1:
        raise UsageError("--port %s: expected one, or --all for several boards in one jig"
                         % " --port ".join(args.port))
    session = plan_file.session_of(args.plan, args.session) if args.plan else None
    if session is None and args.session != 1:
        raise UsageError("--session %d: only with --plan" % args.session)
    if args.replay and (args.plan or getattr(args, "redo", None) or getattr(args, "go_on", None)):
        raise UsageError("--replay plays a capture as it was taken: not with --plan, --redo or "
                         "--continue")
    if getattr(args, "recording", None) is not None and (
            args.replay or args.redo or args.go_on or args.no_record):
        raise UsageError("--record writes a session down from its beginning: not with --replay, "
                         "--redo, --continue or --no-record")
    if args.speed is not None and (not args.replay or not args.speed > 0):
        raise UsageError("--speed %g: expected a number above 0, with --replay" % args.speed)
    return session


def alone(args):
    """UsageError for what --all does not go with: what is said of one board, and what is done in
    one order, in which a board that misses a placement would hold up all others."""
    for name in ("replay", "plan", "redo", "recording"):
        if getattr(args, name, None):
            name = "--" + ("record" if name == "recording" else name)
            raise UsageError("--all: not with %s, which is for one board" % name)


def link_of(args, guided):
    """The board, or the replay in its place."""
    if not args.replay:
        return open_link(args.port[0] if args.port else None)
    from ..guide.replay_link import ReplayLink
    return ReplayLink(args.replay, args.speed or (1.0 if guided else None))


def in_lines(link, args, step, board):
    """Line by line; the solved event."""
    console = Console(step=step)
    try:
        with typed_lines.TypedLines(console.echo) as typed:
            if typed.live:
                console.say(typed_lines.HELP)
            if args.replay:
                return _follow(link, console.show, typed, console.say, logbook.Witness())
            return follow(link, console.show, typed, console.say, board)
    finally:
        console.clear()


def on_a_screen(link, args, step, board):
    """On the guided screen; the solved event."""
    from ..guide import terminal_guide
    from ..guide.board_session import BoardSession
    session = BoardSession(link, board, step, keep=not args.replay)
    if terminal_guide.run(session):
        raise Interrupted(calibration_request.stop(link))
    return session.ending.answer(link.port)


def say_recorded(recording):
    """What became of the file on this computer."""
    if recording is None:
        return
    recording.close()
    for line in [*recording.words(), recording.slow_link()]:
        if line:
            print(plain(line))


def run(args):
    session = checked(args)
    from ..guide import terminal_guide
    guided = not args.plain and terminal_guide.possible()
    if args.tray:
        from ..tray import tray_guide
        return tray_guide.run(args.port, {"continue": True} if args.go_on else None, guided)
    step = (lambda at: plan_file.what_to_do(session, at)) if session else None
    recording = recording_of(args, session)
    with link_of(args, guided) as link:
        board = start(link, args, session, recording is not None)
        listened = link if recording is None else RecordingLink(link, recording)
        try:
            solved = (on_a_screen if guided else in_lines)(listened, args, step, board)
        except KeyboardInterrupt:
            raise Interrupted(calibration_request.stop(listened)) from None
        finally:
            say_recorded(recording)
    return 1 if solved.get("verdict") == "refused" else 0
