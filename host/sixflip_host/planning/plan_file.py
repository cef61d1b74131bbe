"""The plan file: written by `sixflip plan --save FILE`, led through by `calibrate --plan FILE`;
and what a board is asked for by a plan, as the request the firmware reads and in words.

    {"sixflip_plan": 1, "name": "recommended", "sessions": [
        {"state": "warming", "start_c": 22, "change_c": 9, "tau_s": 300, "rest_s": 30,
         "poses": [{"pose": "Z+a", "dwell_s": 5, "move_s": 10, "turn": "left"}, …]}, …]}

A bare list of poses (names, or objects as above) stands for one session. Only "pose" is
mandatory; L1, L2 … are leaning poses, for which "up" may give the direction of the upward axis
in the box. Poses may come back: each time is a placement of its own.
"""
import json
import math

from sixflip.poses import faces

from ..atomic_write import write_text
from ..did_you_mean import instead
from ..errors import BadFile, UsageError
from . import protocols
from .protocols import DWELL_S, MOVE_S, Protocol, Rest, SessionPlan, face_rest

VERSION = 1  # of the file's form
MOST_POSES = 2000  # of 5 s each: three hours
LARGEST = 1 << 20       # characters of a plan's file
# What a person, an oven or a robot can do: a day, and the parts' own temperatures and beyond.
LIMITS = {"dwell_s": (0.5, 86400.0), "move_s": (0.0, 3600.0), "start_c": (-60.0, 150.0),
          "change_c": (-150.0, 150.0), "tau_s": (1.0, 1e5), "rest_s": (0.0, 86400.0)}
POSE_KEYS = ("pose", "dwell_s", "move_s", "turn", "up")
SESSION_KEYS = ("state", "start_c", "change_c", "tau_s", "rest_s", "poses")
SETTLING_S = 1.0        # of a dwell: until the board has seen that the box is at rest
SHORTEST, LONGEST = 50, 60000   # samples of a pose, as session_request.py on the board says
MOST_OF_A_BOARD, MOST_TEXT = 200, 4096  # poses, and characters of a request, as it says too


def to_plan(protocol):
    """The plan file's content as a dict."""
    sessions = []
    for session in protocol.sessions:
        poses = []
        for rest in session.rests:
            pose = {"pose": rest.pose, "dwell_s": rest.dwell_s, "move_s": rest.move_s,
                    "turn": rest.turn}
            if rest.leaning:
                pose["up"] = [round(c, 3) for c in rest.up]
            poses.append(pose)
        sessions.append({"state": session.state, "start_c": session.start_c,
                         "change_c": session.change_c, "tau_s": session.tau_s,
                         "rest_s": session.rest_s, "poses": poses})
    return {"sixflip_plan": VERSION, "name": protocol.name, "sessions": sessions}


def write(path, protocol):
    """Write a Protocol into a plan file."""
    write_text(path, json.dumps(to_plan(protocol), indent=1) + "\n")


def read(path):
    """The Protocol in a plan file; BadFile names the file and what was expected."""
    try:
        with open(path, encoding="utf-8") as stream:
            text = stream.read(LARGEST + 1)
        if len(text) > LARGEST:
            raise BadFile("%s: more than %d KB, expected a plan" % (path, LARGEST >> 10))
        content = json.loads(text)
    except OSError as error:
        raise BadFile("%s: %s" % (path, error.strerror)) from None
    except (ValueError, RecursionError) as error:
        raise BadFile("%s: not JSON: %s" % (path, error)) from None
    try:
        return from_plan(content, str(path))
    except ValueError as error:
        raise BadFile("%s: %s" % (path, error)) from None


def from_plan(content, name="plan"):
    """The Protocol a plan's content stands for; ValueError says what was expected."""
    if isinstance(content, list):
        content = {"sessions": [{"poses": content}]}
    if not isinstance(content, dict):
        raise ValueError("expected an object with sessions, or a list of poses")
    if content.get("sixflip_plan", VERSION) != VERSION:
        raise ValueError("version of the plan is %r, expected %d"
                         % (content["sixflip_plan"], VERSION))
    sessions = content.get("sessions")
    if not isinstance(sessions, list) or not sessions:
        raise ValueError("no sessions, expected a list with at least one")
    plan = Protocol(str(content.get("name", name)),
                    [_session(s, "session %d" % (k + 1)) for k, s in enumerate(sessions)])
    if sum(len(s.rests) for s in plan.sessions) > MOST_POSES:
        raise ValueError("more than %d poses" % MOST_POSES)
    return plan


def _session(spec, where):
    _keys(spec, SESSION_KEYS, where)
    poses = spec.get("poses")
    if not isinstance(poses, list) or not poses:
        raise ValueError("%s has no poses, expected a list of at least one" % where)
    rests = [_pose(p, "%s pose %d" % (where, k + 1)) for k, p in enumerate(poses)]
    state = spec.get("state", "warming")
    if not isinstance(state, str):
        raise ValueError("%s: state is %r, expected a word" % (where, state))
    return SessionPlan(rests, state, *[_number(spec, key, default, where) for key, default in
                                       (("start_c", 25.0), ("change_c", 8.0), ("tau_s", 300.0),
                                        ("rest_s", 0.0))])


def _pose(spec, where):
    if isinstance(spec, str):
        spec = {"pose": spec}
    _keys(spec, POSE_KEYS, where)
    name = spec.get("pose")
    if not isinstance(name, str) or not name:
        raise ValueError("%s: pose is %r, expected a name like Z+a or L1" % (where, name))
    code = faces.pose_code(name)
    turn = spec.get("turn", "left")
    if turn not in ("left", "right"):
        raise ValueError("%s: turn is %r, expected left or right" % (where, turn))
    timing = {"dwell_s": _number(spec, "dwell_s", DWELL_S, where),
              "move_s": _number(spec, "move_s", MOVE_S, where)}
    if faces.face_of_code(code) >= 0:
        return face_rest(code, turn=turn, **timing)
    return Rest(name, _up(spec.get("up"), code, where), turn=turn, **timing)


def _up(up, code, where):
    """A unit vector; where none is given, one spread over the sphere by the pose's number."""
    if up is None:
        height = 1.0 - 2.0 * (((code - faces.LEANING) * 0.618033988749895) % 1.0)
        turn = 2.399963229728653 * (code - faces.LEANING)
        across = math.sqrt(1.0 - height * height)
        return (across * math.cos(turn), across * math.sin(turn), height)
    good = isinstance(up, list) and len(up) == 3 and all(
        isinstance(c, (int, float)) and not isinstance(c, bool) and abs(c) <= 1e6 for c in up)
    length = math.sqrt(sum(c * c for c in up)) if good else 0.0
    if length < 1e-6:
        raise ValueError("%s: up is %r, expected three numbers, not all 0" % (where, up))
    return tuple(c / length for c in up)


def _number(spec, key, default, where):
    value = spec.get(key, default)
    low, high = LIMITS[key]
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
        raise ValueError("%s: %s is %r, expected a number from %g to %g"
                         % (where, key, value, low, high))
    return float(value)


def _keys(spec, known, where):
    if not isinstance(spec, dict):
        raise ValueError("%s is %r, expected an object" % (where, spec))
    for key in spec:
        if key not in known:
            raise ValueError("%s has an unknown key %r, expected %s"
                             % (where, key, " ".join(known)))


def session_of(name, number):
    """The protocols.SessionPlan meant by --plan NAME or FILE and --session NUMBER (from 1)."""
    try:
        protocol = protocols.named(name)
    except ValueError:
        if name in protocols.NAMES:
            raise UsageError("--plan %s is a motion, no placements: expected paper, recommended "
                             "or a plan file" % name) from None
        if not any(c in name for c in "./\\"):
            raise UsageError("no plan named %r, %s, or a plan file" % (
                name, instead(name, protocols.STILL))) from None
        protocol = read(name)
    if not 1 <= number <= len(protocol.sessions):
        raise UsageError("--session %d: the plan %s has %d" % (
            number, protocol.name, len(protocol.sessions)))
    return protocol.sessions[number - 1]


def request(session, rate_hz):
    """What goes into calibrate.flag; UsageError where a board cannot hold it."""
    samples = [max(SHORTEST, round((rest.dwell_s - SETTLING_S) * rate_hz))
               for rest in session.rests]
    if len(samples) > MOST_OF_A_BOARD:
        raise UsageError("the plan has %d placements, %d is the most a board takes"
                         % (len(samples), MOST_OF_A_BOARD))
    if max(samples) > LONGEST:
        raise UsageError("the plan rests for %.0f s in one pose, %.0f s is the most a board takes"
                         % (max(r.dwell_s for r in session.rests), LONGEST / rate_hz))
    return {"poses": " ".join(rest.pose for rest in session.rests),
            "samples": samples[0] if len(set(samples)) == 1 else samples,
            "rest_s": round(session.rest_s)}


def leaning(up):
    """"Z+ up, leaning 38 degrees over so that X- rises" of an upward axis in the box."""
    face, off = faces.nearest_face(*up)
    others = sorted(((abs(up[axis]), "XYZ"[axis] + ("+" if up[axis] > 0 else "-"))
                     for axis in range(3) if axis != faces.AXIS[face]), reverse=True)
    rising = others[0][1]
    if others[1][0] > 0.5 * others[0][0]:
        rising += " and " + others[1][1]
    return "%s up, but leaned over by about %.0f degrees so that %s rises" % (
        faces.FACES[face], 5 * math.floor(off / 5 + 0.5), rising)


def what_to_do(session, at):
    """What to do for placement number at (from 0) of a session, in words."""
    if at >= len(session.rests):
        if not session.rest_s:
            return "all placements done"
        return "all placements done; leave the box alone for %.0f s" % session.rest_s
    rest = session.rests[at]
    if rest.leaning:
        return "%s: lean the box on something, still: %s" % (rest.pose, leaning(rest.up))
    face = rest.pose[:2]
    before = [r.pose for r in session.rests[:at]]
    if not before:
        return "%s: lay the box down with %s up" % (rest.pose, face)
    if before[-1] == rest.pose:
        return "%s: lift the box and put it back just as it lay" % rest.pose
    if before[-1][:2] == face:
        return "%s: half a turn to the %s (%s from above), %s stays up" % (
            rest.pose, rest.turn,
            "anticlockwise" if rest.turn == "left" else "clockwise", face)
    if rest.pose in before:
        return "%s: %s up, turned as it lay for %s before" % (rest.pose, face, rest.pose)
    other = face + ("b" if rest.pose[2:] == "a" else "a")
    if other in before:
        return "%s: %s up, turned half round against %s" % (rest.pose, face, other)
    return "%s: lay the box down with %s up" % (rest.pose, face)
