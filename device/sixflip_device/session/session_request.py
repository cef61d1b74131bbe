"""What kind of calibration is wanted? The line of the host says, or the file of the flag.

    empty, or {"cmd": "calibrate"}          six faces in any order
    {"poses": "Z+a Z+b L1 Z+b", "samples": [400, 400, 300, 400], "rest_s": 30}
                                            a plan: these, in this order; samples may be one
                                            number for all, rest_s is stillness at both ends
    {"redo": "X+"}                          that face of the session before again
    {"continue": true}                      the session before goes on where it ended; when
                                            there is none, or nothing is missing: six faces

"record": true with the first two: every block of the capture is sent to the host as well.
"""

import json

from sixflip.poses.faces import FACES, pose_code

from ..flash_files import FLAG, remove
from .session_values import SessionRequest

MOST_POSES = 200
MOST_TEXT = 4096  # characters of the flag's file
SHORTEST, LONGEST = 50, 60000  # samples of a pose


def _flag(root):
    """The request in the flag's file, {} when it is empty or not there; ValueError."""
    try:
        with open(root + FLAG) as f:
            text = f.read(MOST_TEXT + 1)
    except OSError:
        return {}
    finally:
        remove(root + FLAG)
    if len(text) > MOST_TEXT:
        raise ValueError("more than %d characters" % MOST_TEXT)
    return json.loads(text) if text.strip() else {}


def _whole(value, low, high, what):
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise ValueError("%s is %s, expected %d to %d" % (what, str(value)[:20], low, high))
    return value


def parse(request, pose_samples):
    """The SessionRequest of a dict; ValueError with a sentence. pose_samples: as set."""
    if not isinstance(request, dict):
        raise ValueError("expected a JSON object")
    unasked = request.get("unasked") is True
    if request.get("continue"):
        return SessionRequest(goes_on=True, unasked=unasked)
    if "redo" in request:
        if request["redo"] not in FACES:
            raise ValueError("redo without a face, expected one of " + " ".join(FACES))
        return SessionRequest(goes_on=True, face=FACES.index(request["redo"]))
    record = request.get("record") is True
    if "poses" not in request:
        return SessionRequest(record=record, unasked=unasked)
    poses = request["poses"]
    if not isinstance(poses, str) or not 0 < len(poses.split()) <= MOST_POSES:
        raise ValueError("poses: expected 1 to %d names in one text" % MOST_POSES)
    plan = [pose_code(name) for name in poses.split()]
    lengths = request.get("samples", pose_samples)
    if not isinstance(lengths, list):
        lengths = [lengths] * len(plan)
    if len(lengths) != len(plan):
        raise ValueError("%d poses and %d times samples" % (len(plan), len(lengths)))
    return SessionRequest(plan, [_whole(n, SHORTEST, LONGEST, "samples") for n in lengths],
                          _whole(request.get("rest_s", 0), 0, 3600, "rest_s"), record=record)


def run(firmware):
    """The SessionRequest; None, and an error event, when it cannot be understood."""
    request, firmware.request = firmware.request, None
    recording, firmware.recording = firmware.recording, False
    try:
        request = request or _flag(firmware.board.root)
        wanted = parse(request, firmware.settings["pose_samples"])
    except (ValueError, RuntimeError) as e:  # RuntimeError: JSON that is nested too deep
        firmware.events.error(
            "no calibration: what was asked for cannot be understood: %s" % e,
            "%s empty, or a plan or a face as sixflip calibrate writes it" % FLAG)
        return None
    if recording and not request:  # a host that writes down the stream gets the session as well
        wanted.record = True
    return wanted
