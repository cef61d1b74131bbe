"""Ask a board for a calibration, join one under way, end it."""

import contextlib
import json

from ..errors import NoBoard, SixflipError
from ..value_kinds import Misfit, Number
from . import board_settings
from .board_events import events

FLAG = "calibrate.flag"
RATE = Number(1, 1000)
JOIN_S = 3
STOP_S = 10
ANSWER_S = 2.0


class NoFirmware(NoBoard):
    """A board that answers, and is none of Sixflip's."""


def ask_for_calibration(link, request=None):
    """Leave the flag on the flash, with what is asked for in it, and start the firmware.

    Returns the board's id: what the firmware says at once is lost while a USB port comes back.
    """
    if "main.py" not in link.files([]):
        raise NoFirmware("%s: the firmware is not on this board: sixflip provision" % link.port)
    try:
        link.put(FLAG, json.dumps(request).encode() if request else b"")
        board = link.board_id()
        link.reset()
        return board
    except KeyboardInterrupt:
        with contextlib.suppress(SixflipError, OSError):
            link.remove(FLAG)
        raise


def rate_of(link):
    """rate_hz of the board's settings."""
    try:
        return RATE.take(board_settings.json_settings(link.get("sixflip.json")).get("rate_hz"))
    except (SixflipError, OSError, Misfit):
        return 100


def under_way(link):
    """The names still missing in a calibration that is under way, of a plan or not known: [];
    None when there is none: a board without a record begins one by itself."""
    missing = None
    for event in events(link, JOIN_S, JOIN_S):
        if event["event"] == "state":
            missing = missing or []
            if event.get("missing") is not None:
                return event["missing"]
    return missing


def join(link, face):
    """Ask a calibration that is under way and has the face for it again. False when there is
    none."""
    missing = under_way(link)
    if not missing or {face + "a", face + "b"} <= set(missing):
        return False
    link.send(json.dumps({"cmd": "redo", "face": face}))
    return True


def unfinished(link):
    """Whether a board holds a session that can be gone on with: one under way, or one whose
    capture lacks poses. Nothing on the board is changed by asking."""
    if under_way(link) is not None:
        return True
    link.send(json.dumps({"cmd": "info"}))
    for event in events(link, ANSWER_S, ANSWER_S):
        if event["event"] == "info":
            return event.get("unfinished") is True
    return False


def stop(link, command="sixflip calibrate --continue"):
    """After Ctrl-C: end the session on the board; a sentence on what is kept. command: the one
    that goes on with it."""
    kept = 0
    with contextlib.suppress(SixflipError, OSError):
        link.send("")  # what was being sent
        link.send(json.dumps({"cmd": "stop"}))
        for event in events(link, STOP_S, STOP_S):
            if event["event"] == "capture":
                kept = event.get("samples") or 0
            elif event["event"] in ("saved", "ready", "stopped"):
                break
    if getattr(link, "thrown_away", False):
        return "stopped; of a replay nothing is kept"
    if kept:
        return ("stopped; the %s samples so far stay on the board: %s goes on with them, "
                "sixflip pull fetches them" % (kept, command))
    return "stopped; nothing on the board has changed"
