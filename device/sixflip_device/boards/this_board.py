"""Which board this is, and what sixflip.json beside main.py says of it."""

import os
import sys

BOARDS = {"rp2": "pico", "esp32": "esp32", "pyboard": "pyboard"}


def _here():
    """(name of the board, folder of its files) where nothing else is known."""
    if sys.implementation.name == "micropython":
        cwd = os.getcwd()
        return BOARDS.get(sys.platform, "pico"), cwd if cwd.endswith("/") else cwd + "/"
    from .raspberry_pi import folder
    return "raspberry_pi", folder()


def board_here():
    """(board, settings, problems) from sixflip.json beside main.py."""
    from .. import settings
    name, root = _here()
    values, problems = settings.load(root)
    name = values["board"] or name
    if name not in ("pico", "esp32", "pyboard", "raspberry_pi"):
        raise ValueError("board %s in sixflip.json, expected pico, esp32, pyboard or "
                         "raspberry_pi" % name)
    module = __import__("sixflip_device.boards." + name, None, None, ["make"])
    return module.make(values), values, problems
