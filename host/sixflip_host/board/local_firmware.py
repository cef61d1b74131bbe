"""python -m sixflip_host.board.local_firmware FOLDER WORLD: the board's main.py under CPython.

WORLD is JSON: null for this computer's own I2C bus (main.py runs as it is), or the spec of a
simulated world, which then gives the bus and the clock.
"""

import json
import os
import runpy
import sys
from pathlib import Path

from .board_files import shared_dir


def own_copy(folder):
    """The firmware has to bring its own copy of sixflip, as on a board."""
    sys.path.remove(str(shared_dir()))
    forget_shared()
    sys.path.insert(0, str(folder))


def forget_shared():
    for name in [n for n in sys.modules if n.split(".")[0] == "sixflip"]:
        del sys.modules[name]


def board_on(clock):
    """The class of a Linux board whose time is a virtual clock's."""
    from sixflip_device.boards.raspberry_pi import LinuxBoard

    class ClockedBoard(LinuxBoard):
        """A Linux board on somebody else's bus and clock."""

        def reopen_i2c(self):
            return self.i2c

        def ticks_us(self):
            return clock.ticks_us()

        def ticks_diff(self, later, earlier):
            return clock.ticks_diff(later, earlier)

        def sleep_us(self, us):
            clock.sleep_us(us)
    return ClockedBoard


def run_on(folder, make):
    """The firmware of the folder. make(root): its board."""
    from sixflip_device import power_up, settings
    root = os.path.join(str(folder), "")
    values, problems = settings.load(root)
    power_up.run(make(root), values, problems)


def run_simulated(folder, spec):
    """The firmware of the folder on a simulated bus and a virtual clock."""
    # the world has every chip's tables, the folder those of the board's own sensor
    sys.path.insert(0, str(shared_dir()))
    forget_shared()
    from sixflip_sim import worlds
    world = worlds.make(spec)
    own_copy(folder)
    run_on(folder, lambda root: board_on(world.clock)(lambda: world.i2c, root))


def main(argv):
    folder, spec = Path(argv[0]), json.loads(argv[1])
    if not (folder / "main.py").is_file():
        print("%s holds no firmware: sixflip provision --port local:%s" % (folder, folder))
        return 3
    try:
        if spec is None:
            sys.path.insert(0, str(folder))
            runpy.run_path(str(folder / "main.py"), run_name="__main__")
        else:
            run_simulated(folder, spec)
    except BrokenPipeError:  # the host has gone; nobody is left to tell
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
