"""What the page shows, as JSON: a State and what is to be done next, all texts escaped."""

from ..board.event_words import ROUND
from ..guide.next_step import following, next_step, noise_share, why_it_waits
from ..guide.session_state import CALIBRATING


def faces(state):
    """One entry a face, in the order of the round; n: samples, null: not taken."""
    return [{"face": face, "a": state.taken.get(face + "a"), "b": state.taken.get(face + "b")}
            for face in ROUND]


def last_placement(state):
    """The pose that an undo takes back, "" when there is none; of a plan its number."""
    if state.stage != CALIBRATING:
        return ""
    if state.plan:
        return str(state.at) if state.at else ""
    return list(state.taken)[-1] if state.taken else ""


def snapshot(state, step=None):
    """A dict for json.dumps."""
    here = next_step(state, step)
    share = noise_share(state)
    pose = state.pose if here.kind == "hold" else following(state.missing, state.taken_back)
    return {
        "stage": state.stage, "board": state.board, "chip": state.chip,
        "faces": faces(state), "plan": {"at": state.at, "of": state.planned, "next": state.next}
        if state.plan else None,
        "step": {"kind": here.kind, "face": here.face, "up": here.now, "head": here.head,
                 "detail": here.detail, "pose": pose},
        "waits": why_it_waits(state), "box": state.box, "pose": state.pose,
        "noise": {"value": share[0], "limit": share[1]} if share else None,
        "capture": {"progress": state.progress, "total": state.total, "left_s": state.left_s}
        if state.box == "capturing" else None,
        "vector": state.vector, "rate": state.rate,
        "gone_s": max(0.0, state.now - state.since) if state.stage == CALIBRATING else None,
        "left_s": state.left(), "undo": last_placement(state),
        "verdict": state.verdict, "solved": state.solved, "saved": state.saved,
        "error": state.error, "log": list(state.log),
    }


def trail(state):
    """[[second, [x, y, z] g, [x, y, z] deg/s or null], …] of the last minute."""
    return [[t, vector, rate] for t, vector, rate in state.trail]
