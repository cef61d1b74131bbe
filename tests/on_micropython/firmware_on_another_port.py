"""The firmware with its own board file, on the virtual board's machine and time modules.

    micropython firmware_on_another_port.py FOLDER

FOLDER is the flash: the firmware, sixflip.json, port.json ({"world": …, "wiring": …}) and
asked, a pipe (see sixflip_sim/micropython/time.py). Prints the events up to "ready", then the
pins that were driven or pulled. "Ready" ends it.
"""

import json
import os
import sys

HERE = __file__[: __file__.rindex("/")]
HOST = HERE + "/../../host"
folder = sys.argv[1]
sys.path[:] = [HOST + "/sixflip_sim/micropython", HOST, HERE + "/../../shared", ".frozen"]

import time  # noqa: E402  the virtual board's

import machine  # noqa: E402  the virtual board's

from sixflip_sim import worlds  # noqa: E402

with open(folder + "/port.json") as f:
    config = json.load(f)
world = worlds.make(config["world"])
machine.start(world, b"\x01\x02\x03\x04", config["wiring"])
time.start(world.clock, None, open(folder + "/asked", "r+b"))  # noqa: SIM115 - for the whole run

# the firmware has to bring its own copy of sixflip
for name in list(sys.modules):
    if name.split(".")[0] in ("sixflip", "sixflip_sim"):
        del sys.modules[name]
os.chdir(folder)
sys.path[:] = ["", ".frozen"]

from sixflip_device.boards import machine_board  # noqa: E402


class Ready(BaseException):
    """The firmware streams: the end. Nothing of ours may swallow it."""


def write_line(board, text):
    print(text)
    if text.startswith('{"event": "ready"'):
        raise Ready


machine_board.MachineBoard.write_line = write_line
machine_board = None
try:
    with open("main.py") as f:
        exec(f.read(), {"__name__": "__main__"})
except Ready:
    print(json.dumps({"event": "pins", "touched": [str(pin) for pin in machine._levels]}))
