"""The Pico's firmware image: named by SIXFLIP_PICO_UF2, or in the emulator's cache.

Nothing is fetched here: no package registry carries the image.
"""

import importlib.util
import os
import re
from pathlib import Path

from .. import optional
from ..errors import NoBoard

NAMED = "SIXFLIP_PICO_UF2"
OLDEST = (1, 21)
START = b"UF2\n"
NO_IMAGE = ("no firmware image for the emulated Pico: set %s to MicroPython's .uf2 for it, or "
            "have the emulator fetch one: rp2040py micropython --fetch-fw-only" % NAMED)
OF_A_PICO = re.compile(r"RPI_PICO-\d+-v(\d+)\.(\d+)\.(\d+)\.uf2")


def cached():
    """{(1, 21, 0): path} of the images in the emulator's cache; previews are left out."""
    found = {}
    for path in (Path.home() / ".cache" / "rp2040py").glob("RPI_PICO-*.uf2"):
        match = OF_A_PICO.fullmatch(path.name)
        if match:
            found[tuple(map(int, match.groups()))] = path
    return found


def find():
    """Path of the image; NoBoard with one line when there is none, or no emulator."""
    if importlib.util.find_spec("rp2040py") is None:
        raise NoBoard("no emulator of the Pico is installed: %s" % optional.how("pico"))
    named = os.environ.get(NAMED)
    if named:
        return checked(Path(named))
    usable = {version: path for version, path in cached().items() if version >= OLDEST}
    if not usable:
        raise NoBoard(NO_IMAGE)
    return checked(usable[min(usable)])  # the emulator's own default is 1.21 too


def checked(path):
    try:
        with open(path, "rb") as file:
            if file.read(len(START)) == START:
                return path
    except OSError:
        pass
    raise NoBoard("%s: expected MicroPython's .uf2 for a Raspberry Pi Pico (%s)" % (path, NAMED))
