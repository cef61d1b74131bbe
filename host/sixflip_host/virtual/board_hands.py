"""The hands of virtual boards: each asks the simulated operator for the pose that the board wants.

The hand of one board reads what a person at the board's terminal reads, and lets the box lie
while it is measured. Several boards in one jig have one hand, which turns all of them as they
want it together: it hears what the boards say as `sixflip calibrate --all` does, and by the same
rules; every board is then brought to its own pose, which is the jig's through the way it lies in
the jig.
"""

import json
import threading
import time
from dataclasses import replace

from ..board import board_events
from ..guide.board_values import poses
from ..guide.next_step import following
from ..tray import tray_events
from ..tray.jig import AS_THE_JIG, jig_to_own, learned
from ..tray.member import Member
from ..tray.tray_value import tray

LEAN = (0.6, 0.64, 0.48)    # 50 degrees off the nearest face
LONGEST = 4096              # bytes of a line
FIRST = "Z+a"               # how the jig lies in the beginning


class Heard:
    """events(data) of every byte that a board sends: those whose lines are whole now."""

    def __init__(self):
        self.line = b""

    def events(self, data):
        *lines, self.line = (self.line + data).split(b"\n")
        self.line = self.line[-LONGEST:]
        found = (board_events.parse(line.decode("utf-8", "replace")) for line in lines)
        return [event for event in found if event]


class AskedHand:
    """hear() every byte the board sends."""

    def __init__(self):
        self.heard = Heard()
        self.wanted = ""

    def hear(self, data):
        """The commands for the simulated operator, a line of JSON each."""
        return [self.command() for event in self.heard.events(data) if self.now(event)]

    def now(self, event):
        """Takes in what is wanted; whether the board waits for it with the box at rest."""
        if isinstance(event.get("missing"), list):
            missing = poses(event["missing"])
            self.wanted = missing[0] if event.get("plan") and missing else following(missing)
        elif "next" in event:
            self.wanted = next(iter(poses(event["next"])), "")
        return event["event"] == "state" and event.get("state") == "moving" and bool(self.wanted)

    def command(self):
        command = {"pose": self.wanted}
        if self.wanted[0] == "L":
            k = int(self.wanted[1:])
            command["up"] = [LEAN[(axis + k) % 3] * (-1) ** (k >> axis) for axis in range(3)]
        return json.dumps(command).encode() + b"\n"



def mounted(pairs):
    """The whole mounting {face of the board: face of the jig} of two of its pairs."""
    mounting = {}
    for own, face in pairs.items():
        mounting = learned(mounting, own, face)
    return mounting


# As the jig, upside down, a quarter turn on, on its edge.
WAYS = (AS_THE_JIG, mounted({"Z-": "Z+", "Y-": "Y+"}), mounted({"X+": "Y+", "Z+": "Z+"}),
        mounted({"Y+": "Z+", "Z+": "X+"}))


class JigHand:
    """The jig, and its boards by any name. mountings: {name: {its face: the jig's}, see jig}."""

    def __init__(self, mountings, clock=time.monotonic):
        self.mountings = mountings
        self.clock = clock
        self.lock = threading.Lock()    # every board is heard in a thread of its own
        self.tray = self.seated(tray(dict.fromkeys(mountings)))
        self.lies = FIRST
        self.lay = {}       # {face: the pose in which the jig lay on it last}
        self.visit = None
        self.swapped = False

    def of(self, name):
        """The jig's hand as one of its boards has it, for VirtualBoard."""
        return JigHandOf(self, name)

    def own(self, name, pose):
        """A board's own pose in a pose of the jig."""
        return jig_to_own(self.mountings[name])[pose[:2]] + pose[2:]

    def first(self, name):
        """More of the world of a board, whose box lies as the jig does in the beginning."""
        return {"order": [self.own(name, FIRST)], "dwell_s": 0}

    def hear(self, name, event):
        """The pose that the board is to be brought to now."""
        with self.lock:
            if event["event"] == "hello":
                self.restarted(name)
            heard, _ = tray_events.after(self.tray, name, event, self.clock())
            self.tray = self.seated(heard)
            return self.own(name, self.pose())

    def seated(self, now_tray):
        """The Tray with every board as it sits in the jig, whatever its words made of that. A
        board that was not yet moved, or that speaks late, would seem to sit otherwise than it
        does, and would wait for ever for a face that is never up."""
        return replace(now_tray, members=tuple(
            replace(member, mounting=self.mountings[member.port])
            for member in now_tray.members))

    def restarted(self, name):
        """A board begins anew; the jig does when nothing of a session is left."""
        members = tuple(Member(name, member.number) if member.port == name else member
                        for member in self.tray.members)
        self.tray = self.seated(replace(self.tray, members=members))
        if not any(member.running and member.state.taken for member in members):
            self.tray = self.seated(tray(dict.fromkeys(self.mountings)))
            self.lies, self.lay, self.visit = FIRST, {}, None

    def pose(self):
        """The jig's pose. A face that is taken again as it lies begins with how it lies; one that
        a board tells late of having taken, with how the jig lay on it before it was turned on."""
        face = self.tray.face
        if face and self.tray.running:
            visit = (face, self.tray.visits[face])
            if visit != self.visit:
                lay = self.lies if self.tray.letter == "a" else self.lay.get(face)
                self.swapped = lay == face + "b"
                self.visit = visit
            self.lies = face + "ab"[(self.tray.letter == "b") != self.swapped]
            self.lay[face] = self.lies
        return self.lies


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
            if event["event"] == "state":
                commands.append(json.dumps({"pose": pose, "anew": False}).encode() + b"\n")
        return commands
