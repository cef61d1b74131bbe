"""What is known of a guided session, as a value: events of the firmware in, a new State out.

One model for the terminal and the browser. Everything a board sends is checked on its way in:
text is escaped and cut, numbers are finite, names of poses are poses; nothing raises.
"""

import math
from dataclasses import dataclass, field, replace
from statistics import median

from sixflip import STANDARD_G
from sixflip.poses.faces import FACES

from ..board.event_words import lasting
from .board_values import TEXT, cleaned, number, poses, text, three, whole

LOG = 200               # lines kept
TRAIL = 240             # vectors kept: a minute, at four a second
SIX = tuple(face + letter for face in FACES for letter in "ab")
WAITING, CALIBRATING, SOLVING, OVER = "waiting", "calibrating", "solving", "over"


@dataclass(frozen=True)
class State:
    """stage     waiting (for the board), calibrating, solving, over
    taken        {pose: n samples} accepted and in force; of a plan the last one of that name
    missing      poses still to come, in a session of six faces
    plan, at, planned, next   a session by a plan: how many are done, of how many, the next
    box, pose, reason, value, limit, unit, progress, total, left_s   the live state, see
                 device/sixflip_device/session/teller.py; heard: number of live states
    vector, rate three numbers each, g and deg/s, or None; trail: tuple of (second, vector, rate)
    refusal      why the last placement was not taken, "" once one was
    solved, saved, record   those events' own values, {} before
    verdict      good, doubtful, refused; "" before
    since, taken_at, now   seconds of the caller's clock: begin of the session, last placement
                 taken, last event; paces: seconds from placement to placement
    log          lasting lines, oldest first; error: the last one that is in force
    redone       how often placements were taken back in this session; taken_back: the face, or the
                 plan's pose, that was taken back last, "" once a placement is taken
    """

    stage: str = WAITING
    board: str = ""
    chip: str = ""
    taken: dict = field(default_factory=dict)
    missing: tuple = ()
    plan: bool = False
    at: int = 0
    planned: int = 0
    next: str = ""
    box: str = ""
    pose: str = ""
    reason: str = ""
    value: float = 0.0
    limit: float = 0.0
    unit: str = ""
    progress: int = 0
    total: int = 0
    left_s: float = 0.0
    heard: int = 0
    vector: tuple = None
    rate: tuple = None
    trail: tuple = ()
    refusal: str = ""
    solved: dict = field(default_factory=dict)
    saved: dict = field(default_factory=dict)
    record: dict = field(default_factory=dict)
    verdict: str = ""
    since: float = 0.0
    taken_at: float = 0.0
    now: float = 0.0
    paces: tuple = ()
    log: tuple = ()
    error: str = ""
    redone: int = 0
    taken_back: str = ""

    def left(self):
        """Seconds until all placements are taken, at the usual pace so far; None before the
        first one."""
        if self.stage != CALIBRATING or not self.paces:
            return None
        todo = self.planned - self.at if self.plan else len(self.missing)
        pace = median(self.paces)
        return max(0.0, pace * todo - min(self.now - self.taken_at, pace))


def after(state, event, now, step=None):
    """The State after an event (a dict with "event"). now: seconds; step(at): see Console."""
    state = replace(state, now=now)
    kind = event.get("event")
    make = AFTER.get(kind) if isinstance(kind, str) else None
    if make:
        state = make(state, event)
    if kind in ("state", "sample", "heading"):
        return state
    return logged(state, lasting(event, step) if isinstance(kind, str) else [])


def logged(state, lines):
    """State with more lasting lines."""
    return replace(state, log=(state.log + tuple(line[:TEXT] for line in lines))[-LOG:])


def _hello(state, event):
    return replace(state, board=text(event.get("id"), 40), chip=text(event.get("chip"), 60))


def _calibrating(state, event):
    """A session begins; what it goes on with is all that is not missing."""
    missing = poses(event.get("missing"))
    plan = event.get("plan") is True
    taken = {} if plan else {pose: 0 for pose in SIX if pose not in missing}
    return replace(State(), board=state.board, chip=state.chip, log=state.log, record=state.record,
                   stage=CALIBRATING, plan=plan, missing=missing, taken=taken,
                   planned=len(missing) if plan else 0,
                   next=missing[0] if plan and missing else "",
                   vector=state.vector, trail=state.trail, since=state.now, taken_at=state.now,
                   now=state.now)


def _todo(state, event):
    """What is still to be done, where the event says so."""
    if "missing" in event:
        missing = poses(event["missing"])
        taken = {pose: n for pose, n in state.taken.items() if pose not in missing}
        for pose in SIX:
            if pose not in missing:
                taken.setdefault(pose, 0)
        return replace(state, missing=missing, taken=taken)
    if "at" in event:
        following = poses(event.get("next"))
        return replace(state, plan=True, at=whole(event["at"]), planned=whole(event.get("of")),
                       next=following[0] if following else "")
    return state


def _live(state, event):
    """A live state also tells a host that came later that a calibration is under way."""
    if state.stage != CALIBRATING:
        state = replace(State(), board=state.board, chip=state.chip, log=state.log,
                        stage=CALIBRATING, since=state.now, taken_at=state.now, now=state.now)
    state = replace(
        _todo(state, event), heard=state.heard + 1,
        box=text(event.get("state"), 20), pose=text(event.get("pose"), 8),
        reason=text(event.get("reason"), 60), value=number(event.get("value")),
        limit=number(event.get("limit")), unit=text(event.get("unit"), 12),
        progress=whole(event.get("progress")), total=whole(event.get("total")),
        left_s=max(0.0, number(event.get("left_s"))))
    if state.box in ("capturing", "settling"):
        state = replace(state, refusal="")
    return _moved(state, event.get("live"))


def _moved(state, live):
    """The vector of a live state: mg and deg/s."""
    live = live if isinstance(live, list) else []
    vector = three(live[:3], 1e-3)
    if vector is None:
        return state
    return _trailed(state, vector, three(live[3:], 1.0) or ((0.0,) * 3 if live[3:] else None))


def _trailed(state, vector, rate):
    return replace(state, vector=vector, rate=rate,
                   trail=(state.trail + ((state.now, vector, rate),))[-TRAIL:])


def _sample(state, event):
    """A corrected sample, once the board streams again."""
    vector = three(event.get("a"), 1 / STANDARD_G)
    if vector is None:
        return state
    return _trailed(state, vector, three(event.get("w"), math.degrees(1.0)))


def _pose(state, event):
    for name in poses([event.get("pose")]):
        others = {pose: n for pose, n in state.taken.items() if pose != name}
        state = replace(state, taken={**others, name: whole(event.get("n"))})   # the last one
    return replace(_todo(state, event), refusal="", error="", taken_back="", taken_at=state.now,
                   paces=state.paces + (state.now - state.taken_at,))


def _redo(state, event):
    """Of a plan only the last placement lies as it was: one before it is laid down anew."""
    back = text(event.get("face"), 8)
    return replace(_todo(state, event), redone=state.redone + 1,
                   taken_back="" if state.plan and state.taken_back else back)


def _refused(state, event):
    said = lasting(event)
    return replace(state, refusal=said[0][:TEXT] if said else "")


def _capture(state, event):
    return replace(state, stage=SOLVING, pose="", box="", reason="")


def _solved(state, event):
    verdict = text(event.get("verdict"), 20)
    return replace(state, stage=OVER if verdict == "refused" else SOLVING, verdict=verdict,
                   solved=cleaned(event))


def _error(state, event):
    return replace(state, error=text(event.get("what")))


def _end(state, event):
    """The firmware streams again, or it stopped."""
    return replace(state, stage=OVER) if state.stage in (CALIBRATING, SOLVING) else state


AFTER = {
    "hello": _hello, "calibrating": _calibrating, "state": _live, "sample": _sample,
    "pose": _pose, "refused": _refused, "capture": _capture, "solved": _solved,
    "redo": _redo,
    "saved": lambda s, e: replace(s, stage=OVER, saved=cleaned(e)),
    "record": lambda s, e: replace(s, record=cleaned(e)),
    "error": _error, "ready": _end, "stopped": _end,
}
