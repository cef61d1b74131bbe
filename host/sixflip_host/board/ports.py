"""From --port to a link: a serial port, local:DIR for this computer, or the only board there."""

import os

from ..errors import NoBoard
from . import serial_ports

VARIABLE = "SIXFLIP_PORT"
HELP = ("serial port of the board (default: $SIXFLIP_PORT, or the only one plugged in), or "
        "local:DIR for the firmware on this computer with DIR as its flash")


def add_port(parser):
    parser.add_argument("--port", metavar="PORT", help=HELP)


def open_link(port=None):
    """A Link; NoBoard with one line when there is none or the choice is not clear."""
    if port is None:
        port = os.environ.get(VARIABLE) or only_board()
    if port.startswith("local:"):
        from .local_link import LocalLink
        return LocalLink(port[len("local:"):] or None)
    from .board_link import MpremoteLink
    return MpremoteLink(port)


def only_board():
    rows = serial_ports.boards()
    if not rows:
        raise NoBoard("no board is plugged in, expected one on USB; name its port with --port, "
                      "or try without hardware: sixflip virtual-board")
    if len(rows) > 1:
        raise NoBoard("%d boards are plugged in, choose one with --port: %s"
                      % (len(rows), " ".join(row["port"] for row in rows)))
    return rows[0]["port"]
