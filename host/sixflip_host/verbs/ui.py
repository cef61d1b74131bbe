"""sixflip ui: the guided session in a browser, served by this machine to itself alone."""

import asyncio
import contextlib
import errno
import os
import signal
import webbrowser
from pathlib import Path

from .. import optional
from ..board import calibration_request
from ..board.ports import open_link
from ..errors import SixflipError, UsageError
from ..file_arguments import add_input, add_output
from ..planning import plan_file
from ..terminal import plain
from . import calibrate

EXAMPLE = "sixflip ui"


def add_arguments(parser):
    where = parser.add_mutually_exclusive_group()
    calibrate.add_ports(where)
    add_input(where, "--replay", metavar="CAPTURE",
              help="no board: play a capture file through the firmware's own session")
    calibrate.add_all(parser)
    parser.add_argument("--speed", metavar="N", type=float,
                        help="of --replay: seconds of the capture a second (default: 1)")
    add_input(parser, "--plan", metavar="FILE|NAME",
              help="a session of a plan (sixflip plan --save FILE), or paper, recommended")
    parser.add_argument("--session", metavar="N", type=int, default=1,
                        help="which session of the plan (default: the first)")
    parser.add_argument("--listen", metavar="N", type=int, default=0,
                        help="port on this machine for the browser (default: a free one)")
    add_output(parser, "-o", "--output", metavar="DIR", default=".", type=Path,
               writes=lambda value, args: [],     # pull and report look at what is there
               help="folder for what is pulled and reported (default: here)")
    parser.add_argument("--open", action="store_true", help="open the browser too")


def board_of(args):
    """open_link() for the bench; a capture that cannot be replayed is refused here at once."""
    if not args.replay:
        return lambda: open_link(args.port[0] if args.port else None)
    from ..guide.replay_link import ReplayLink, checked
    checked(args.replay)
    return lambda: ReplayLink(args.replay, args.speed or 1.0)


def run(args):
    try:
        from ..ui.server import Server
    except ImportError:
        raise SixflipError("sixflip ui needs aiohttp, which is not installed: %s"
                           % optional.how("ui")) from None
    session = calibrate.checked(args)
    if not 0 <= args.listen <= 65535:
        raise UsageError("--listen %d: expected a port, 1 to 65535" % args.listen)
    make = tray_bench(args) if args.tray else board_bench(args, session)
    server = Server(make, args.listen, "tray.html" if args.tray else "index.html")
    try:
        asyncio.run(serve(server, args))
    except OSError as error:
        if error.errno not in (errno.EADDRINUSE, errno.EACCES):
            raise
        raise UsageError("--listen %d: %s" % (args.listen, os.strerror(error.errno))) from None
    finally:
        said = server.bench.close() if server.port else ""
        if said:
            print(plain(said))
    return 0


def tray_bench(args):
    """make(told) of the bench of several boards in one jig."""
    from ..tray.tray_guide import ports_of
    from ..ui.tray_bench import TrayBench
    return lambda told: TrayBench(lambda: ports_of(args.port), told)


def board_bench(args, session):
    """make(told) of the bench of one board, or of a capture; session: of a plan, None without."""
    from ..ui.bench import Bench
    link = board_of(args)
    more = {} if session is None else {
        "request": lambda link: plan_file.request(session, calibration_request.rate_of(link)),
        "step": lambda at: plan_file.what_to_do(session, at)}
    return lambda told: Bench(link, args.output, told, keep=not args.replay,
                              capture=args.replay, **more)


async def serve(server, args):
    await server.start()
    print("open %s   (Ctrl-C here ends it)" % server.url, flush=True)
    if args.open:
        webbrowser.open(server.url)
    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        with contextlib.suppress(NotImplementedError):  # Windows: Ctrl-C ends it by force
            asyncio.get_running_loop().add_signal_handler(number, ended.set)
    await ended.wait()
    server.bench.over.set()
    await server.stop()
