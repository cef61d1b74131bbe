"""Before sampling: what kind of calibration is it? The flag's file or the host's line says.

    empty, or {"cmd": "calibrate"}          six faces in any order
    {"poses": "Z+a Z+b L1 Z+b", "samples": [400, 400, 300, 400], "rest_s": 30}
                                            a plan: these, in this order; samples may be one
                                            number for all, rest_s is stillness at both ends
    {"redo": "X+"}                          that face of the session before again
    {"continue": true}                      the session before goes on where it ended; when
                                            there is none, or nothing is missing: six faces

"record": true with the first two: every block of the capture is sent to the host (recording.py).
"""

import json

from sixflip.poses.faces import FACES, pose_code

from ..flash_files import FLAG, remove

MOST_POSES = 200
MOST_TEXT = 4096
SHORTEST, LONGEST = 50, 60000  # samples of a pose


class Asked:
    """For sampling. wanted, lengths, hold_s: a plan, see PlannedSession; wanted None: none.

    before  it goes on with the session before; then face: 0..5 to be taken again, or -1, and
    placements, moves, samples, seconds, us, kept, bytes, room, sums_only, reason, session: what
    redo_session.py took over of it
    """

    wanted = None
    before = False
    face = -1


def _flag(unit):
    """The request in the flag's file, None when it is empty or not there; ValueError."""
    try:
        with open(unit.board.root + FLAG) as f:
            text = f.read(MOST_TEXT + 1)
    except OSError:
        return None
    finally:
        remove(unit.board.root + FLAG)
    if len(text) > MOST_TEXT:
        raise ValueError("more than %d characters" % MOST_TEXT)
    return json.loads(text) if text.strip() else None


def _whole(value, low, high, what):
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise ValueError("%s is %s, expected %d to %d" % (what, str(value)[:20], low, high))
    return value


def parse(request, pose_samples):
    """An Asked, or None for the ordinary six faces; ValueError with a sentence."""
    if request is None:
        return None
    if not isinstance(request, dict):
        raise ValueError("expected a JSON object")
    asked = Asked()
    if request.get("continue"):
        asked.before = True
        return asked
    if "redo" in request:
        if request["redo"] not in FACES:
            raise ValueError("redo without a face, expected one of " + " ".join(FACES))
        asked.before = True
        asked.face = FACES.index(request["redo"])
        return asked
    if "poses" not in request:
        return None
    poses = request["poses"]
    if not isinstance(poses, str) or not 0 < len(poses.split()) <= MOST_POSES:
        raise ValueError("poses: expected 1 to %d names in one text" % MOST_POSES)
    asked.wanted = [pose_code(name) for name in poses.split()]
    lengths = request.get("samples", pose_samples)
    if not isinstance(lengths, list):
        lengths = [lengths] * len(asked.wanted)
    if len(lengths) != len(asked.wanted):
        raise ValueError("%d poses and %d times samples" % (len(asked.wanted), len(lengths)))
    asked.lengths = [_whole(n, SHORTEST, LONGEST, "samples") for n in lengths]
    asked.hold_s = _whole(request.get("rest_s", 0), 0, 3600, "rest_s")
    return asked


def run(unit):
    unit.recording = False
    request, unit.request = unit.request, None
    try:
        flag = _flag(unit)
        unit.taken = parse(request or flag, unit.settings["pose_samples"])
        unit.recording = (request or flag or {}).get("record") is True and (
            unit.taken is None or not unit.taken.before)
    except (ValueError, RuntimeError) as e:
        unit.events.error("no calibration: what was asked for cannot be understood: %s" % e,
                          "%s empty, or a plan or a face as sixflip calibrate writes it" % FLAG)
        unit.asked = False
        return "put_in_force"
    if unit.taken is not None and unit.taken.before:
        return "redo_session"
    return "sampling"
