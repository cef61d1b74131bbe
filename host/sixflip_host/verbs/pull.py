"""sixflip pull: capture, records and settings from a board into a folder here."""
import json
from pathlib import Path

from ..board import pulled_files
from ..board.ports import add_port, open_link
from ..file_arguments import add_output
from ..history import logbook
from ..terminal import plain

EXAMPLE = "sixflip pull -o captures"


def add_arguments(parser):
    add_port(parser)
    # what is written there is known once the board has said its id: fetch() looks then
    add_output(parser, "-o", "--output", metavar="DIR", default=".", type=Path,
               writes=lambda value, args: [],
               help="folder to put DIR/<board id>/… into (default: here)")
    parser.add_argument("--json", action="store_true", help="what was fetched, as JSON")












def run(args):
    say = (lambda text: None) if args.json else print
    with open_link(args.port) as link:
        folder = pulled_files.fetch(link, args.output, say, args.force)
        board = link.board_id()
        link.reset()
    unreadable = pulled_files.convert(folder, say)
    logbook.pulled(folder, board)
    if args.json:
        print(json.dumps({
            "format": 1, "kind": "sixflip pull", "board": board, "folder": str(folder),
            "files": sorted(path.name for path in folder.iterdir() if path.is_file())}))
    if unreadable:
        raise unreadable[0]
    say("next: sixflip verify %s" % plain(folder))
    return 0
