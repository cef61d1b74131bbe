"""The firmware's start on this board, from main.py's import to the end of the self-test.

run(form, heap): form "source", as a board gets it whose MicroPython loads no compiled files, or
"compiled"; heap: bytes, all that the interpreter and this module hold among them, 0 for all there
is. Prints instructions (see instructions.py), the bytes that it took and "started".
"""

import gc
import io
import sys

import vfs
from disk import Disk
from instructions import start, took


class Started(Exception):
    """The self-test has been told."""


def told(text):
    if text.startswith('{"event": "selftest"'):
        raise Started


def power_up(chip):
    from sixflip_device import power_up, settings
    values, problems = settings.merge({"grace_ms": 0})
    from taped_board import TapedBoard
    try:  # noqa: SIM105 - MicroPython has no contextlib
        power_up.run(TapedBoard(chip, "/", told), values, problems)
    except Started:
        pass


def run(form, heap=0):
    import provisioned
    import tapes

    from sixflip_sim.tape import open_tape
    chip = open_tape("mpu6050", [io.BytesIO(data) for data in tapes.BURSTS["mpu6050"]])
    vfs.mount(Disk(provisioned.SOURCES if form == "source" else provisioned.FILES), "/")
    for name in [name for name in sys.modules if name.startswith("sixflip")]:
        del sys.modules[name]
    sys.path[:] = ["", ".frozen"]
    gc.collect()
    weight = bytearray(gc.mem_alloc() + gc.mem_free() - heap if heap else 0)
    gc.collect()
    before = gc.mem_alloc()
    start()
    count, _ = took(power_up, chip)
    gc.collect()
    print("started", count, gc.mem_alloc() - before, len(weight))
