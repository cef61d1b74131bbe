"""The hand of several virtual boards in one jig, which turns all of them as they want it together.

It hears what the boards say as `sixflip calibrate --all` does, and by the same rules; every board
is then brought to its own pose, which is the jig's through the way it lies in the jig. A board
calls the first placement on a face "a" however the jig lies; so the hand remembers in which half
turn each took it, and turns the jig to the other one for its second.
"""

import json
import threading
import time
from dataclasses import replace

from ..guide.board_values import poses
from ..tray import tray_events
from ..tray.jig import AS_THE_JIG, FACES, jig_to_own, learned
from ..tray.leading import turned
from ..tray.member import Member
from ..tray.tray_events import NOISE
from ..tray.tray_value import put, tray
from .board_hands import Heard

FIRST = "Z+a"               # how the jig lies in the beginning
OTHER = {"a": "b", "b": "a"}
AT_REST = 2                 # windows at rest, at least, before a box is moved as was asked for
PAUSE_S = 0.25              # a hand is no faster; a host that is busy has heard all boards by then
UNMOVED = 40                # windows at rest after which a box lay as was asked for already


def mounted(pairs):
    """The whole mounting {face of the board: face of the jig} of two of its pairs."""
    mounting = {}
    for own, face in pairs.items():
        mounting = learned(mounting, own, face)
    return mounting


# As the jig, upside down, a quarter turn on, on its edge.
WAYS = (AS_THE_JIG, mounted({"Z-": "Z+", "Y-": "Y+"}), mounted({"X+": "Y+", "Z+": "Z+"}),
        mounted({"Y+": "Z+", "Z+": "X+"}))


class Box:
    """The box of one board, of which the hand learns late and only by the board's words.

    lies      the jig's pose that the box lies in, or is being brought to
    asked     the pose that its operator is asked for: kept to until the box moves, so that it is
              known where to, or rests for so long that it must have lain so already
    still     windows at rest since then
    wanted    the pose that the box is to have, since the second wanted_at
    lacks     names of the placements that the board says are missing
    firsts    {face of the jig: half turn "a" or "b" of the board's first placement there}
    """

    def __init__(self, mounting):
        self.mounting = mounting
        self.lies = self.asked = self.wanted = FIRST
        self.wanted_at = 0.0
        self.still, self.lacks, self.firsts = 0, (), {}

    def hear(self, event):
        """Takes in how the box lies, and what the board has of it."""
        if event["event"] == "state":
            self.window(event.get("state"), event.get("reason"))
        if isinstance(event.get("missing"), list):
            self.lacks = poses(event["missing"])
        for pose in poses([event.get("pose")]):
            if event["event"] == "pose" and pose[2:] == "a":
                self.took_first(self.mounting[pose[:2]])

    def window(self, state, reason):
        """A window: the box rests, or moves."""
        moves = reason == "moving" or state == NOISE and reason == "noisy"
        if self.still >= (AT_REST if moves else UNMOVED):
            self.lies = self.asked
        self.still = 0 if moves else self.still + 1

    def took_first(self, face):
        """Of the face the board is sure, even if no move to it showed."""
        if face == self.asked[:2] != self.lies[:2]:
            self.lies = self.asked
        self.firsts[face] = self.lies[2]

    def second(self, face):
        """The half turn for the board's second placement on a face, "" unless it lacks just it."""
        own = jig_to_own(self.mounting)[face]
        halfway = own + "a" not in self.lacks and own + "b" in self.lacks
        return OTHER[self.firsts.get(face, "a")] if halfway else ""

    def ask(self, pose, now, pause_s):
        """The pose to ask for at a second now, where this one is wanted: itself once it has been
        wanted for pause_s."""
        if pose != self.wanted:
            self.wanted, self.wanted_at = pose, now
        if self.lies == self.asked != pose and now - self.wanted_at >= pause_s:
            self.asked, self.still = pose, 0
        return self.asked


def tells_its_seat(event):
    """Whether a tray learns of an event how the board sits in the jig."""
    return event["event"] == "pose" or (
        event["event"] == "refused" and event.get("reason") == tray_events.DONE)


class JigHand:
    """The jig, and its boards by any name.

    mountings  {name: {its face: the jig's}, see jig}
    patience   of the host that the boards are led by, see board_link: a hand that leads on before
               the host does leaves boards behind
    pause_s    from when a box is to be laid otherwise until it is, times the patience
    """

    def __init__(self, mountings, clock=time.monotonic, patience=1.0, pause_s=PAUSE_S):
        self.mountings = mountings
        self.patience = patience
        self.pause_s = pause_s * patience
        self.clock = clock
        self.lock = threading.Lock()    # every board is heard in a thread of its own
        self.tray = tray(dict.fromkeys(mountings), patience)
        self.boxes = {name: Box(mountings[name]) for name in mountings}
        self.lies = FIRST

    def hand_for(self, name):
        """The jig's hand as one of its boards has it, for VirtualBoard."""
        return JigHandOf(self, name)

    def own(self, name, pose):
        """A board's own pose in a pose of the jig."""
        return jig_to_own(self.mountings[name])[pose[:2]] + pose[2:]

    def first(self, name):
        """More of the world of a board, whose box lies as the jig does in the beginning."""
        return {"order": [self.own(name, FIRST)], "dwell_s": 0}

    def hear(self, name, event):
        """The pose that the board's box is asked for now, "" where it is not asked for any."""
        with self.lock:
            if event["event"] == "hello":
                self.restarted(name)
            self.boxes[name].hear(event)
            self.stays(name, event)
            if self.tray.face and tells_its_seat(event):
                self.tray = put(self.tray, self.seated(self.tray.member(name)))
            heard, _ = tray_events.after(self.tray, name, event, self.clock())
            self.tray = replace(heard, members=tuple(
                self.seated(member) if member.mounting else member for member in heard.members))
            if event["event"] == "redo":
                self.taken_back(name, event.get("face"))
            if event["event"] != "state":
                return ""
            box, pose = self.boxes[name], self.turned_for(name, self.pose())
            return self.own(name, box.ask(pose, self.clock(), self.pause_s))

    def seated(self, member):
        """The Member as it sits in the jig, whatever its words made of that: one that was not yet
        moved, or that speaks late, would seem to sit otherwise than it does, and would wait for
        ever for a face that is never up. One that has told nothing of it yet stays unknown, as it
        is to the host, which leads the person accordingly."""
        return replace(member, mounting=self.mountings[member.port])

    def restarted(self, name):
        """A board begins anew; the jig does when nothing of a session is left."""
        members = tuple(Member(name, member.number) if member.port == name else member
                        for member in self.tray.members)
        self.tray = replace(self.tray, members=members)
        self.boxes[name] = Box(self.mountings[name])
        if not any(member.running and member.state.taken for member in members):
            self.tray = tray(dict.fromkeys(self.mountings), self.patience)
            self.lies = FIRST

    def stays(self, name, event):
        """A board that speaks in its session has not left: that the host says, and stops it."""
        if event["event"] == "state" and self.tray.member(name).gone:
            self.tray = put(self.tray, replace(self.tray.member(name), gone="", missed=0))

    def taken_back(self, name, own):
        """The host leads to the face that it has a board take back: so the jig goes there too."""
        if own in FACES and self.tray.face:
            self.tray = turned(self.tray, self.mountings[name][own])

    def pose(self):
        """The jig's pose. A face that is taken again as it lies begins with how it lies."""
        face = self.tray.face
        if face and self.tray.running:
            self.lies = face + self.half(face)
        return self.lies

    def half(self, face):
        """The half turn that is wanted on a face: that of the next board which has its first
        placement in the other one; as long as some lack the first, the jig is not turned."""
        seconds = [self.boxes[member.port].second(face)
                   for member in (*self.tray.awaited(), *self.tray.running)]
        lies = face == self.lies[:2]
        if not any(seconds) or lies and self.tray.letter == "a":
            return self.lies[2] if lies else "a"
        return next(filter(None, seconds))

    def turned_for(self, name, pose):
        """The jig's pose for one board: where it lacks the second placement only, it takes that
        as soon as it comes from another face, and so must come in the other half turn."""
        face, box = pose[:2], self.boxes[name]
        second = box.second(face)
        return face + second if second and box.lies != face + OTHER[second] else pose


class JigHandOf:
    """hear() every byte that one board sends, as AskedHand does.

    With every window that a board in its session tells of, its box is asked for into the pose
    that the jig is to have now; whether it lies so already, or is to be left alone yet, its own
    operator knows best (sixflip_sim.operator.Operator.asked).
    """

    def __init__(self, hand, name):
        self.hand, self.name = hand, name
        self.heard = Heard()

    def hear(self, data):
        """The commands for the simulated operator, a line of JSON each."""
        commands = []
        for event in self.heard.events(data):
            pose = self.hand.hear(self.name, event)
            if pose:
                commands.append(json.dumps({"pose": pose, "anew": False}).encode() + b"\n")
        return commands
