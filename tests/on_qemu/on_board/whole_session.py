"""A power-up of the firmware with a whole session, its files compiled as provision sends them.

run(sensor): bursts from a tape; run(sensor, world={}): a simulated chip inside; mode: a module
that changes the board (locked_loop: the heap is locked while it samples; redo_late: a face is
asked for again); heap: bytes of it for the firmware, the harness's not counted; give(): a record
that is active already, when a session is asked for; other names are settings. Prints the events
with the bytes in use after each, and the newest record in hexadecimal, if there is one.
"""

import gc
import sys

import vfs
from disk import Disk


def tape(sensor):
    import io

    import tapes

    from sixflip_sim.tape import open_tape
    return open_tape(sensor, [io.BytesIO(data) for data in tapes.BURSTS[sensor]]), None


def live(sensor, world):
    from sixflip_sim import worlds
    made = worlds.make(dict(world, sensor=sensor))
    return made.i2c, made.clock


class Teller:
    """Prints events with the bytes in use, the ballast's not counted."""

    def __init__(self, ballast):
        self.ballast = ballast

    def told(self, text):
        gc.collect()
        print(gc.mem_alloc() - self.ballast, text)


given = []


def give(record):
    """A record in bytes for the flash; in an exec of its own, whose text is gone afterwards."""
    given.append(record)


def run(sensor, world=None, mode="", heap=0, **changed):
    import provisioned
    disk = Disk(provisioned.FILES)
    if given:
        disk.open("record_a.bin", "wb").write(given.pop())
        disk.open("calibrate.flag", "wb")
    i2c, clock = tape(sensor) if world is None else live(sensor, world)
    for name in list(sys.modules):
        if name.split(".")[0] in ("sixflip", "sixflip_sim", "provisioned"):
            del sys.modules[name]  # the firmware brings its own
    vfs.mount(disk, "/")
    sys.path[:] = ["", ".frozen"]
    gc.collect()
    harness = gc.mem_alloc()
    weight = bytearray(max(0, gc.mem_free() - heap) if heap else 0)
    gc.collect()
    print("harness", harness, "heap", gc.mem_free())
    held = harness + len(weight)

    from sixflip_device import power_up, settings
    assert power_up.__file__ == "sixflip_device/power_up.mpy", power_up.__file__
    from taped_board import TapedBoard
    values, problems = settings.merge(dict(grace_ms=0, **changed))
    del settings
    board = TapedBoard(i2c, "/", Teller(held).told, clock)
    if mode:
        __import__(mode).install(board, power_up)
    power_up.run(board, values, problems)
    assert len(weight) <= held
    for name in ("record_b.bin", "record_a.bin"):
        if name in disk.written:
            print("record", "".join(["%02x" % b for b in disk.written[name].data]))
            break
