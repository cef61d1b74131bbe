"""sixflip boards: what is plugged in."""

import json

from ..board import serial_ports
from ..errors import NoBoard, SixflipError
from ..terminal import plain

EXAMPLE = "sixflip boards --ask"


def add_arguments(parser):
    parser.add_argument("--ask", action="store_true",
                        help="ask each for its MicroPython version (stops what runs on it, "
                             "then resets it)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def ask(row):
    """Add "micropython" and "machine" to a row, or "error"."""
    from ..board.board_link import MpremoteLink
    try:
        with MpremoteLink(row["port"]) as link:
            row["micropython"], row["machine"] = link.version()
            link.reset()
    except SixflipError as error:
        row["error"] = str(error)


def run(args):
    rows = serial_ports.boards()
    if args.ask:
        for row in rows:
            ask(row)
    if args.json:
        print(json.dumps(rows, indent=1))
        return 0
    if not rows:
        raise NoBoard("no board is plugged in, expected one on USB; to try without hardware: "
                      "sixflip virtual-board")
    for row in rows:
        words = [row["port"], row["usb"], row["kind"], row["serial_number"]]
        words.append(row.get("error") or " ".join(
            (row.get("machine", ""), row.get("micropython", ""))))
        print(plain("  ".join(word for word in words if word.strip())))
    return 0
