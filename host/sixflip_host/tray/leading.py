"""How the person is led: which face of the jig comes next, and who is waited for.

Every board runs its own session and takes any face in any order; what is decided here is only
how the jig is to be laid next, which is what the boards still in their sessions want together:

    a face is taken whole, its first placement and after half a turn the second;
    those who have it wait PATIENCE_S, or for a capture under way, for those who have not;
    who missed one of the two is asked for the whole face again, after all faces that nobody
    has had yet; who misses MISSES faces in a row leaves the tray.

tick(), redo() and undo() answer (Tray, commands), a command being (port, dict for the firmware).
"""

from dataclasses import replace

from ..board.event_words import ROUND
from . import jig
from .lying import sits
from .tray_value import put, say
from .tray_words import count, instruction, why_not

PATIENCE_S = 5.0    # a rest is seen as such after 0.75 s and captured in 4 s at 100 Hz
MISSES = 3          # faces in a row without both placements: the board, not the rest, is at fault
START_S = 20.0      # from the first board's session to the last one's: a USB port comes back in 15
STOP = {"cmd": "stop"}


def tick(now_tray, now):
    """(Tray, commands) as time goes by: whether the person can be led on."""
    now_tray = replace(now_tray, now=now)
    if not now_tray.face:
        return begun(now_tray)
    if not now_tray.running:
        return now_tray, []
    awaited = now_tray.awaited()
    if awaited and (now_tray.first_at is None or any(
            now < waited_until(now_tray, member) for member in awaited if not member.stuck)):
        return now_tray, []
    if awaited:
        now_tray = missing(now_tray, awaited)
    halves = tuple(member.port for member in now_tray.running
                   if member.placements(now_tray.face) == 1)
    if now_tray.letter == "a" and halves:
        had = now_tray.first_at is not None
        now_tray = afresh(replace(now_tray, letter="b", flips=halves))
        return say(now_tray, "%s; %s" % (count(now_tray, 1), instruction(now_tray))) \
            if had else now_tray, []
    if now_tray.letter == "b" and any(
            member.port in now_tray.flips and not member.placements(now_tray.face)
            for member in now_tray.running):
        # It says late that it took its first placement back: that is to be taken, not missed.
        now_tray = afresh(replace(now_tray, letter="a", flips=()))
        return say(now_tray, "next: " + instruction(now_tray)), []
    return whole(now_tray)


def waited_until(now_tray, member):
    """Until when those who have a placement wait for a board that has not."""
    return max(now_tray.first_at + PATIENCE_S * now_tray.patience, member.patient)


def begun(now_tray):
    """The first face is asked for when every board is in its session, or has had its time."""
    running = now_tray.running
    if not running:
        return now_tray, []
    since = now_tray.now if now_tray.since is None else now_tray.since
    now_tray = replace(now_tray, since=since)
    if any(member.waiting for member in now_tray.members) and \
            now_tray.now - since < START_S * now_tray.patience:
        return now_tray, []
    reference = next((member for member in running if not member.stuck), running[0])
    now_tray = put(now_tray, replace(reference, mounting=reference.mounting or jig.AS_THE_JIG))
    now_tray = replace(now_tray, reference=reference.port)
    early = {member.port: member.taken_last for member in running if member.taken_last}
    return as_it_lies(now_tray, early) if early else onward(now_tray)


def as_it_lies(now_tray, early):
    """The first face is the one that some boards, {port: their face}, have taken already."""
    face = now_tray.up() or early.get(now_tray.reference) or ROUND[0]
    now_tray = turned(now_tray, face)
    for port, own in early.items():
        now_tray = sits(now_tray, now_tray.member(port), own, face)
    now_tray = replace(now_tray, here=early, first_at=now_tray.now)
    return say(now_tray, "next: " + instruction(now_tray)), []


def missing(now_tray, awaited):
    """Those that did not take a placement say why; they are asked for the face at the end."""
    for member in awaited:
        now_tray = say(now_tray, "%s: %s%s not taken: %s; it comes again at the end" % (
            member.name, now_tray.face, " after its half turn" if now_tray.letter == "b" else "",
            why_not(member, now_tray.now)))
    return now_tray


def whole(now_tray):
    """A face is done with: who has not got it whole missed it, and perhaps leaves."""
    face, commands = now_tray.face, []
    now_tray = say(now_tray, count(now_tray, 2)) if now_tray.here else now_tray
    for member in now_tray.running:
        lacks = member.placements(face) < 2
        member = replace(member, missed=member.missed + 1 if lacks else 0)
        now_tray = put(now_tray, member)
        if lacks and member.missed >= MISSES:
            now_tray = leaves(now_tray, member, "%d faces in a row not taken: %s" % (
                MISSES, why_not(member, now_tray.now)))
            commands.append((member.port, STOP))
    now_tray, more = onward(now_tray)
    return now_tray, commands + more


def onward(now_tray):
    """To the face that some board lacks and that the person was led to least often.

    A board that has one of its two placements, or that did not take the face as the jig lies
    now, is told to take it anew.
    """
    running = now_tray.running
    wanted = [face for face in ROUND
              if any(member.placements(face) < 2 for member in running)]
    if not wanted:
        return replace(now_tray, here={}, last=now_tray.face), []
    face = min(wanted, key=lambda name: (now_tray.visits.get(name, 0), ROUND.index(name)))
    lies = now_tray.up() == face and now_tray.visits.get(face)
    repeating = [member for member in running if member.own(face) and (
        member.placements(face) == 1 or lies and not member.placements(face))]
    return repeat_face(turned(now_tray, face), face, repeating)


def turned(now_tray, face):
    """The jig is to be laid, or lies, with a face up. One that nobody took anything on is as if
    it had not been asked for."""
    visits = dict(now_tray.visits)
    if now_tray.face and not now_tray.here and now_tray.letter == "a":
        visits[now_tray.face] -= 1
    visits[face] = visits.get(face, 0) + 1
    return afresh(replace(now_tray, face=face, letter="a", here={}, said={}, visits=visits,
                          last=now_tray.face if now_tray.here else now_tray.last))


def afresh(now_tray):
    """A placement begins: nobody has it and nobody has tried."""
    return replace(now_tray, first_at=None, members=tuple(
        replace(member, captures=0, patient=0.0) for member in now_tray.members))


def repeat_face(now_tray, face, members):
    """These take the face anew; the line that leads the person there."""
    commands = [(member.port, {"cmd": "redo", "face": member.own(face)}) for member in members]
    for member in members:
        now_tray = put(now_tray, now_tray.member(member.port).without(face))
    return say(now_tray, "next: " + instruction(now_tray)), commands


def leaves(now_tray, member, sentence):
    """A board leaves the tray, the rest goes on."""
    sentence = sentence.removeprefix(member.port + ": ")
    return say(put(now_tray, replace(member, gone=sentence)),
               "%s leaves the tray: %s" % (member.name, sentence))


def redo(now_tray, face, now):
    """A face again, by all boards that have anything of it, those that are over included."""
    members = [member for member in now_tray.members if member.own(face) and not member.gone
               and (member.running or member.over)]
    now_tray = replace(now_tray, now=now, redone=now_tray.redone + 1)
    return repeat_face(turned(now_tray, face), face, members)


def undo(now_tray, now):
    """The face taken last again."""
    face = now_tray.face if now_tray.here else now_tray.last
    return redo(now_tray, face, now) if face else (now_tray, [])
