"""What the boards of a tray say, taken in: after() and left() answer (Tray, commands).

Pure: no link, no clock, no thread; a command is (port, dict for the firmware).
"""

from dataclasses import replace

from sixflip import __version__

from ..board.board_events import unusable
from ..board.firmware_update import NO_SENSOR
from ..guide import session_state
from ..guide.board_values import text
from ..guide.session_state import OVER
from .jig import FACES
from .leading import PATIENCE_S, START_S, STOP, leaves, tick, turned
from .lying import lying, sits
from .tray_value import put, say
from .tray_words import outcome

CAPTURES = 3        # of one board on one placement that the others wait for
CAPTURE_S = 60      # longest of them; the most samples that can be set, 5000, take 50 s at 100 Hz
NOISE = "measuring noise"    # as a session begins
INFO = {"cmd": "info"}
DONE = "already done"    # of a placement on a face that the board has whole
ESSENTIAL = ("calibrating", "pose", "solved")   # events without which there is no calibration


def after(now_tray, port, event, now):
    """(Tray, commands) after an event of a board, a dict with "event"."""
    member = now_tray.member(port)
    if member.gone:
        return replace(now_tray, now=now), []
    before = member.state
    member = replace(member, state=session_state.after(before, event, now))
    now_tray = put(replace(now_tray, now=now), member)
    wrong = misfit(member, event)
    if wrong:
        now_tray, commands = tick(leaves(now_tray, member, wrong), now)
        return now_tray, [(port, STOP), *commands]
    if event["event"] == "hello":
        now_tray = say(now_tray, "%s at %s: %s" % (
            member.name, port, member.state.chip or "no sensor found"))
    asked = [(port, INFO)] if event["event"] == "calibrating" and not member.state.chip else []
    if event["event"] == "info" and not member.state.chip:
        now_tray = introduced(now_tray, member, event)
    own = text(event.get("pose"), 8)[:2]
    if own not in FACES or not now_tray.face:
        own = ""        # what is taken before all have begun, begun() looks at
    if event["event"] == "pose" and own:
        now_tray = taken(now_tray, member, own)
    elif event["event"] == "refused" and event.get("reason") == DONE and own:
        now_tray = had(now_tray, member, own)
    elif event["event"] == "state" and rests_on_done(now_tray, member):
        now_tray = sits(now_tray, member, member.state.pose[:2], now_tray.up())
    elif event["event"] == "state" and member.state.box == "capturing" != before.box:
        now_tray = put(now_tray, begins(member, now, now_tray.patience))
    elif member.state.box == NOISE and now_tray.since is not None:
        until = min(now + PATIENCE_S * now_tray.patience,
                    now_tray.since + START_S * now_tray.patience)
        now_tray = put(now_tray, replace(member, patient=until))
    if member.state.stage == OVER != before.stage:
        now_tray = say(now_tray, outcome(member))
    now_tray, commands = tick(now_tray, now)
    return now_tray, asked + commands


def introduced(now_tray, member, event):
    """A board whose first words were lost while its USB port came back says what it is."""
    member = replace(member, state=replace(
        member.state, chip=text(event.get("sensor"), 60),
        board=text(event.get("id"), 40) or member.state.board))
    return say(put(now_tray, member), "%s at %s: %s" % (
        member.name, member.port, member.state.chip or "no sensor found"))


def begins(member, now, patience):
    """The Member as it begins a capture: the others wait for it, but not for ever."""
    until = now + (min(member.state.left_s, CAPTURE_S) + 1) * patience
    return replace(member, captures=member.captures + 1,
                   patient=until if member.captures < CAPTURES else member.patient)


def misfit(member, event):
    """Why a board's event shows that it cannot be of this tray, "" when it does not."""
    kind = event["event"]
    if kind == "hello" and event.get("firmware") not in (None, __version__):
        return "%s: its firmware is %s, expected %s: sixflip provision --port %s" % (
            member.port, text(event["firmware"], 40), __version__, member.port)
    if kind == "misfit" and event["of"] in ESSENTIAL:
        return unusable(member.port, event)
    if kind == "error" and member.waiting and text(event.get("what")).startswith(NO_SENSOR):
        return "%s: %s; expected %s" % (member.port, text(event["what"]),
                                        text(event.get("expected")))
    if kind in ("ready", "stopped") and member.waiting:
        return "%s: no session began: %s" % (member.port, member.state.error or (
            "is its firmware of this version? (sixflip provision --port %s)" % member.port))
    return ""


def left(now_tray, port, sentence, now):
    """A board is lost: unplugged, silent, not to be used."""
    member = now_tray.member(port)
    now_tray = replace(now_tray, now=now)
    if member.over:
        return now_tray, []
    return tick(leaves(now_tray, member, sentence), now)


def had(now_tray, member, own):
    """A board has its face own whole already: so the jig lies, and who lacks this face, if it is
    the one asked for, has no longer to take it than if another had taken it now."""
    face = lying(now_tray, member, own)
    now_tray = sits(now_tray, member, own, face)
    if face != now_tray.face:
        return now_tray
    said = now_tray.said.get(member.port, 0) + 1    # once a rest, before the half turn and after
    now_tray = replace(now_tray, said={**now_tray.said, member.port: said})
    if now_tray.first_at is None and said > "ab".index(now_tray.letter):
        now_tray = replace(now_tray, first_at=now_tray.now)
    return now_tray


def rests_on_done(now_tray, member):
    """Whether a live state tells first how a board sits in the jig. That it has a face whole it
    says once a rest, perhaps before the sessions of the others began, when nothing is known yet
    of how the jig lies; but as long as it lies there, every live state names the face."""
    state = member.state
    return bool(not member.mounting and state.reason == DONE and state.pose[:2] in FACES
                and now_tray.face and now_tray.up())


def taken(now_tray, member, own):
    """A board took a placement on its face own: so the jig lies, and so the board sits in it."""
    face = lying(now_tray, member, own)
    if face != now_tray.face:
        now_tray = turned(now_tray, face)
    now_tray = sits(now_tray, now_tray.member(member.port), own, face)
    now_tray = replace(now_tray, here={**now_tray.here, member.port: own})
    if now_tray.first_at is None and \
            now_tray.member(member.port).placements(face) > "ab".index(now_tray.letter):
        now_tray = replace(now_tray, first_at=now_tray.now)
    return now_tray
