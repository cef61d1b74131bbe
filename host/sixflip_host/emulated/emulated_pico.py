"""A Pico without hardware: a pty as its USB port, the emulator in a process of its own.

Slow: a second of Python on the board takes three quarters of a minute. The simulated world
goes by the emulated time, in which waiting costs nothing.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from ..board.board_files import host_dir, shared_dir
from ..errors import NoBoard
from . import firmware_image

PATIENCE = 60  # how much longer than on a board everything may take
ENDS_S = 60


class PicoBoard:
    """Context manager. While it is entered a process runs and .port names its serial port.

    world       spec for sixflip_sim.worlds.make
    image_path  the flash with MicroPython on it, kept there at the end; a new one when it is
                not there
    """

    def __init__(self, world, image_path, uf2=None):
        self.world = dict(world)
        self.image_path = Path(image_path).resolve()
        self.uf2 = Path(uf2 or firmware_image.find()).resolve()
        self.port = None
        self.child = None

    def __enter__(self):
        config = {"uf2": str(self.uf2), "world": self.world, "image": str(self.image_path)}
        self.folder = tempfile.TemporaryDirectory(prefix="sixflip-pico-")
        path = Path(self.folder.name) / "pico.json"
        path.write_text(json.dumps(config))
        paths = [str(host_dir()), str(shared_dir())]
        self.child = subprocess.Popen(
            [sys.executable, "-m", "sixflip_host.emulated.pico_process", str(path)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env=dict(os.environ, PYTHONPATH=os.pathsep.join(paths)))
        try:
            self.port = self.answer()["port"]
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *error):
        child, self.child = self.child, None
        if child:
            try:
                child.communicate(timeout=ENDS_S)
            except subprocess.TimeoutExpired:
                child.kill()
                child.communicate()
        self.folder.cleanup()

    def answer(self):
        line = self.child.stdout.readline() or '{"failed": "it ended"}'
        found = json.loads(line)
        if "failed" in found:
            raise NoBoard("the emulated Pico does not run: %s; is %s MicroPython's image for it?"
                          % (found["failed"], self.uf2))
        return found

    def ask(self, command):
        """One command of pico_process; its answer, the state after it."""
        self.child.stdin.write(json.dumps(command) + "\n")
        self.child.stdin.flush()
        return self.answer()

    def state(self):
        """Counts: boots, cuts, emulated_us, transactions, refused, flash_operations."""
        return self.ask({})

    def power_cycle(self, world=None):
        """Supply off and on, the flash stays; optionally into another world. The port stays."""
        if world is not None:
            self.world = dict(world)
        self.ask({"power_cycle": world})

    def cut_after(self, operations):
        """The supply fails in the erase or page write that comes after so many."""
        self.ask({"cut_after": operations})
