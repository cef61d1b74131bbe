"""sixflip restore: the correction before the present one, or one from a file, into force."""

import json

from .. import atomic_write
from ..board.board_events import wait_for
from ..board.console import Console
from ..board.ports import add_port, open_link
from ..calibrate.verify_files import decode_record
from ..errors import CheckFailed
from ..file_arguments import add_input

EXAMPLE = ("sixflip restore\n"
           "         sixflip restore --from mounted.bin")
OFFERED = "offered.bin"     # where the firmware looks for it at its next power-up


def add_arguments(parser):
    add_input(parser, "--from", dest="source", metavar="FILE", help="a correction record, of "
              "pull, mount -o or refine -o: the board checks it and makes it its newest one")
    add_port(parser)


def run(args):
    console = Console()
    if args.source:
        data = atomic_write.read_bytes(args.source)
        decode_record(args.source, data)
        with open_link(args.port) as link:
            return offer(link, data, console)
    with open_link(args.port) as link:
        link.reset()
        started = wait_for(link, ("ready", "calibrating"), seen=console.show)
        if started["event"] == "calibrating":
            raise CheckFailed("%s: no correction is in force, so the board is calibrating; there "
                              "is nothing to go back from" % link.port)
        link.send(json.dumps({"cmd": "restore"}))
        answer = wait_for(link, ("restored", "error"))
    if answer["event"] == "error":
        raise CheckFailed("%s; expected %s" % (answer["what"], answer.get("expected")))
    console.show(answer)
    return 0


def offer(link, data, console):
    """A record's bytes to the board, which takes it or not; CheckFailed with its reason."""
    link.put(OFFERED, data)
    link.reset()
    # The board looks at it before it says what is in force; one without a sensor never gets there.
    answer = wait_for(link, ("restored", "not_restored", "record", "no_record"),
                      seen=lambda event: event["event"] == "not_restored" or console.show(event))
    if answer["event"] == "not_restored":
        raise CheckFailed("%s: the board does not take this record: %s; what it had goes on"
                          % (link.port, answer.get("reason")))
    if answer["event"] != "restored":
        raise CheckFailed("%s: the firmware there does not know of records from files; sixflip "
                          "provision" % link.port)
    return 0
