"""What the person with the box does now, and why the board waits: of a State, in words."""

from dataclasses import dataclass

from ..board.event_words import ROUND, measured, why
from .session_state import CALIBRATING, OVER, SOLVING, WAITING

PLACE, FLIP, HOLD, REST, LEAN, WAIT, DONE = "place", "flip", "hold", "rest", "lean", "wait", "done"
CAUSES = {"moving": "it moves", "noisy": "it shakes", "saturated": "full scale",
          "stale": "readings do not change"}


AS_IT_LIES = "lift it first if it lay badly, and put it back the same way"


@dataclass(frozen=True)
class Step:
    """kind: place, flip, hold, rest, lean, wait, done; face: that is to be up, "" for none;
    now: the face that is up, as far as known; head: one short line; detail: a longer one."""

    kind: str
    face: str = ""
    now: str = ""
    head: str = ""
    detail: str = ""


def face_up(state):
    """The face of the box that is up by its vector, "" when it leans or nothing is known."""
    if state.vector is None:
        return ""
    size, axis = max((abs(v), k) for k, v in enumerate(state.vector))
    if size < 0.8 * sum(v * v for v in state.vector) ** 0.5:
        return ""
    return "XYZ"[axis] + ("+" if state.vector[axis] > 0 else "-")


def following(missing, taken_back=""):
    """The pose to take next of those missing: a flip that is due, else the face that was taken
    back, else the next of the round."""
    for pose in missing:
        if pose.endswith("b") and pose[:-1] + "a" not in missing:
            return pose
    for face in (taken_back, *ROUND):
        for letter in "ab":
            if face + letter in missing:
                return face + letter
    return ""


def next_step(state, step=None):
    """The Step of a State. step(at): what a plan says of placement number at."""
    up = face_up(state)
    if state.stage == WAITING:
        return Step(WAIT, "", up, "waiting for the board", "it starts, and tests its sensor")
    if state.stage == SOLVING:
        return Step(WAIT, "", up, "the board computes its calibration", "it may be moved now")
    if state.stage == OVER:
        return Step(DONE, "", up, "done", "")
    if state.box == "capturing":
        return Step(HOLD, state.pose[:2], up, "KEEP STILL: %s is being captured" % state.pose,
                    "hands off box and table")
    if state.box in ("resting", "measuring noise"):
        what = "the board learns its own noise" if state.box[0] == "m" else "a rest of the plan"
        return Step(REST, up, up, "leave the box alone", what)
    if state.plan:
        return planned(state, up, step)
    pose = following(state.missing, state.taken_back)
    if not pose:
        return Step(WAIT, "", up, "all six faces are done", "")
    face = pose[:2]
    if pose.endswith("b"):
        no_gyro = state.vector and not state.rate  # then only the hand's own shaking shows it
        return Step(FLIP, face, up, "half a turn, %s stays up" % face,
                    "lift it, turn it, put it down again" if no_gyro
                    else "turn it flat on the table, either way round")
    if face == state.taken_back == up:
        return Step(PLACE, face, up, "%s again, as the box lies" % face, AS_IT_LIES)
    return Step(PLACE, face, up, "lay the box down with %s up" % face,
                "flat on the table, then let go")


def planned(state, up, step):
    """By a plan: the drawing where there is one, and the plan's own words."""
    if state.taken_back and state.taken_back == state.next:
        leans = state.next[:1] == "L"
        return Step(LEAN if leans else PLACE, "" if leans else state.next[:2], up,
                    "%s again, as the box lies" % state.next, AS_IT_LIES)
    words = step(state.at) if step else "next %s" % state.next
    head, _, detail = words.partition(": ")
    detail = detail or words
    face = state.next[:2]
    if state.next[:1] == "L":
        return Step(LEAN, "", up, head + ": lean it on something", detail)
    if not state.next:
        return Step(REST, up, up, "all placements are done", detail)
    flip = "half a turn" in detail
    return Step(FLIP if flip else PLACE, face, up,
                "%s: %s" % (head, "half a turn" if flip else face + " up"), detail)


def why_it_waits(state):
    """Why nothing is captured at this moment, with number and limit; "" when nothing is wrong."""
    if state.stage != CALIBRATING:
        return state.error and "error: " + state.error
    if state.box == "capturing":
        return ""
    live = {"reason": state.reason, "value": state.value, "limit": state.limit,
            "unit": state.unit}
    if state.reason in ("moving", "noisy") and state.refusal:
        return state.refusal
    if state.reason not in ("moving", "noisy"):
        try:
            return why(live)
        except (ValueError, LookupError, TypeError):
            return state.reason
    return "not at rest yet: %s%s" % (CAUSES[state.reason], measured(live))


def noise_share(state):
    """(value, limit) of the window's noise in times the sensor's own, None when it is not told."""
    if state.unit != "x noise" or not state.limit:
        return None
    return state.value, state.limit


def instead(state):
    """In a few words what keeps the box from being still, "" when it is."""
    return CAUSES.get(state.reason, "") if state.box != "capturing" else ""
