"""sixflip virtual-board: a board to try the other commands on, without hardware."""

import contextlib
import json
import time
from pathlib import Path

from sixflip.chips.catalogue import SENSORS

from ..atomic_write import read_bytes
from ..errors import BadFile, UsageError
from ..file_arguments import add_input, add_output
from ..file_kinds import FLASH
from ..virtual.micropython_fetch import cache_dir

MOST_BOARDS = 64
EXAMPLE = "sixflip virtual-board --sensor gy85"


def add_arguments(parser):
    parser.add_argument("--sensor", choices=SENSORS, default="mpu6050")
    parser.add_argument("--tilt", metavar="DEG", type=float, default=2.0,
                        help="tilt of the table that the simulated operator works on")
    parser.add_argument("--seed", type=int, default=1, help="of sensor errors and noise")
    add_output(parser, "--flash", metavar="FILE", type=Path, kinds=(FLASH,),
               help="image of the flash, kept (default: in the cache)")
    parser.add_argument("--speed", metavar="N", type=float, default=1.0,
                        help="simulated seconds a second (default: 1, as with a real board; 20 "
                             "for tests)")
    add_input(parser, "--world", metavar="FILE|JSON",
              help="more of the simulated world: JSON, or a file of it, such as `sixflip simulate "
                   "--worlds` writes")
    parser.add_argument("--session", metavar="N", type=int, default=1,
                        help="which of the worlds in that file (default: the first)")
    parser.add_argument("--boards", metavar="N", type=int, default=1,
                        help="several in one jig, turned together, for sixflip calibrate --all; "
                             "they lie in it as the jig does, upside down, a quarter turn on, on "
                             "their edge, and so on")
    parser.add_argument("--json", action="store_true", help="the port and the flash, as JSON")


def world_spec(args):
    """The spec for sixflip_sim.worlds of a command line."""
    spec = {"sensor": args.sensor, "tilt_deg": args.tilt, "seed": args.seed,
            "order": [],       # the operator does what the board asks for
            "flip_error_deg": 0.4}
    if args.world:
        spec.update(more_of_it(args.world, args.session))
    from sixflip_sim import worlds
    try:
        worlds.make(spec)
    except (ValueError, TypeError, KeyError, AttributeError, IndexError) as error:
        raise UsageError("--world %s: %s" % (args.world, error)) from None
    return spec


def more_of_it(given, session):
    """The dict meant by --world: JSON itself or a file with a world or a list of worlds."""
    inline = given.lstrip()[:1] in ("{", "[")
    text = given if inline else read_bytes(given)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError):
        raise (UsageError if inline else BadFile)(
            "--world %s: expected a JSON object, or a file of it" % given) from None
    worlds = content if isinstance(content, list) else [content]
    if not 1 <= session <= len(worlds):
        raise UsageError("--session %d: %s holds %d" % (session, given, len(worlds)))
    if not isinstance(worlds[session - 1], dict):
        raise UsageError("--world %s: expected a JSON object" % given)
    return worlds[session - 1]


def boards_of(args, images, spec):
    """The VirtualBoards of a command line: one that is asked, several in one jig, or one that
    does as it was planned."""
    from ..board.raw_repl import patience_asked
    from ..virtual.board_hands import AskedHand
    from ..virtual.jig_hand import WAYS, JigHand
    from ..virtual.virtual_board import VirtualBoard
    if len(images) == 1:
        hand = None if spec["order"] else AskedHand()
        return [VirtualBoard(spec, images[0], speed=args.speed, hand=hand)]
    hand = JigHand({image: WAYS[k % len(WAYS)] for k, image in enumerate(images)},
                   patience=patience_asked())
    return [VirtualBoard(dict(spec, seed=args.seed + k, **hand.first(image)), image,
                         speed=args.speed, hand=hand.hand_for(image))
            for k, image in enumerate(images)]


def say(args, boards):
    """Where the boards are."""
    rows = [{"port": board.port, "board": board.unique_id, "flash": str(board.image_path)}
            for board in boards]
    if args.json:
        print(json.dumps({"format": 1, "kind": "sixflip virtual-board",
                          **(rows[0] if len(rows) == 1 else {"boards": rows})}), flush=True)
        return
    for row in rows:
        print("virtual board at %(port)s, flash in %(flash)s" % row)
    if len(rows) == 1:
        print("in another terminal: sixflip provision --port %s   (Ctrl-C here ends it)"
              % rows[0]["port"], flush=True)
        return
    print("in another terminal   (Ctrl-C here ends it):\n"
          "export SIXFLIP_PORT='%s'\n"
          "for port in $SIXFLIP_PORT; do sixflip provision --port $port; done\n"
          "sixflip calibrate --all" % " ".join(row["port"] for row in rows), flush=True)


def run(args):
    if not args.speed > 0:
        raise UsageError("--speed %s: expected a number above 0" % args.speed)
    if not 1 <= args.boards <= MOST_BOARDS:
        raise UsageError("--boards %d: expected 1 to %d" % (args.boards, MOST_BOARDS))
    image = args.flash or cache_dir() / "virtual-board.flash"
    image.parent.mkdir(parents=True, exist_ok=True)
    spec = world_spec(args)
    if args.boards > 1 and spec["order"]:
        raise UsageError("--boards: one hand turns the jig, not with an order in --world")
    images = [image] + [image.with_name("%s-%d%s" % (image.stem, k, image.suffix))
                        for k in range(2, args.boards + 1)]
    with contextlib.ExitStack() as all_of_them:
        boards = [all_of_them.enter_context(board) for board in boards_of(args, images, spec)]
        try:
            say(args, boards)  # it says that Ctrl-C ends it
            while all(board.relay.is_alive() for board in boards):
                time.sleep(0.2)
        except KeyboardInterrupt:
            pass
    return 0
