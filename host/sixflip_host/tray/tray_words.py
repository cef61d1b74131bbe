"""A tray in words: what the person does now, and what came of each board."""

from ..board.event_words import saved
from ..guide.board_values import text
from ..guide.next_step import why_it_waits
from ..guide.session_state import CALIBRATING, SOLVING, WAITING

COLUMNS = ("board", "port", "verdict", "saved", "why")


def outcome(member):
    """The line on a board whose session is over."""
    state = member.state
    if not state.verdict:
        return "%s: not calibrated: %s" % (member.name, why_none(member))
    reason = text(state.solved.get("reason"))
    return "%s: %s%s%s" % (member.name, state.verdict, "; " + saved(state.saved)
                           if state.saved else "", ": " + reason if reason else "")


def why_none(member):
    """Why a board that is over has no verdict."""
    return member.gone or member.state.error or "its session ended without one"


def why_not(member, now):
    """Why a board takes nothing."""
    if member.silent_s(now):
        return "it has said nothing for %d s" % member.silent_s(now)
    state = member.state
    return why_it_waits(state) or state.refusal or state.box or "it does not say why"


def count(now_tray, placements):
    """"X+ taken by 7 of 8 boards": of those in the tray, the solved ones included."""
    there = [member for member in now_tray.members if not member.gone]
    have = [member for member in there if member.placements(now_tray.face) >= placements]
    return "%s %s by %d of %d boards" % (now_tray.face, "taken" if placements == 1 else
                                         "and its half turn taken", len(have), len(there))


def instruction(now_tray):
    """What the person does now, in a line."""
    if not now_tray.face:
        return "waiting for the boards to begin"
    if now_tray.letter == "b":
        lift = any(member.state.vector and not member.state.rate for member in now_tray.running)
        return "half a turn, %s, %s stays up" % (
            "lifted and put down again" if lift else "flat on the table", now_tray.face)
    for_all = len(now_tray.awaited()) == len(now_tray.running)
    whom = "" if for_all else " (for %s)" % ", ".join(
        str(member.number) for member in now_tray.awaited())
    if now_tray.up() == now_tray.face and now_tray.visits.get(now_tray.face, 0) > 1:
        return "%s again, as the jig lies%s" % (now_tray.face, whom)
    return "lay the jig down with %s up%s" % (now_tray.face, whom)


def keeps_still(now_tray):
    """Whether the jig is to be left alone: it is being captured, or some are waited for."""
    awaited = now_tray.awaited()
    return bool(awaited) and (now_tray.first_at is not None or any(
        member.state.box == "capturing" for member in awaited))


def headline(now_tray):
    """What the person does, with what is going on."""
    if now_tray.over:
        return "done: the jig may be opened"
    if now_tray.face and not now_tray.running:
        return "the boards compute their calibrations; the jig may be moved"
    if not keeps_still(now_tray):
        return instruction(now_tray)
    awaited = now_tray.awaited()
    have = len(now_tray.running) - len(awaited)
    return "KEEP STILL, %s: %d of %d have it, still to come: %s" % (
        now_tray.face, have, len(now_tray.running),
        ", ".join(str(member.number) for member in awaited))


def status(now_tray, member):
    """In a few words what a board does, or what came of it."""
    state = member.state
    if member.gone:
        return member.gone
    if state.stage == WAITING:
        return "starts"
    if state.stage == SOLVING:
        return "computes"
    if state.stage != CALIBRATING:
        return outcome(member).partition(": ")[2]
    if state.box == "capturing":
        return "captured %d %%" % (100 * state.progress / max(1, state.total))
    if member not in now_tray.awaited():
        return "has it"
    return why_not(member, now_tray.now)


def results(now_tray, passed):
    """Rows of the table at the end, see COLUMNS."""
    rows = []
    for member in now_tray.members:
        state = member.state
        reason = text(state.solved.get("reason")) if state.verdict and not member.gone \
            else why_none(member)
        written = state.saved.get("written", True) if state.saved else None
        rows.append(["%d %s" % (member.number, state.board), member.port,
                     "none" if member.gone else state.verdict or "none",
                     {True: "yes", False: "old one kept", None: "no"}[written], reason])
    return rows + [["-", port, "none", "no", why] for port, why in passed.items()]
