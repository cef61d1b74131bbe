"""The hand of several virtual boards in one jig: it turns all of them as they want it together.

It hears what the boards say as `sixflip calibrate --all` does, and by the same rules; every
board is then brought to its own pose, which is the jig's through the way it lies in the jig.
"""

import json
import threading
import time
from dataclasses import replace

from ..board import board_events
from ..tray import tray_events
from ..tray.jig import AS_THE_JIG, jig_to_own, learned
from ..tray.member import Member
from ..tray.tray_value import tray

LONGEST = 4096      # bytes of a line
FIRST = "Z+a"       # how the jig lies in the beginning


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
        self.tray = tray(dict.fromkeys(mountings))
        self.lies = FIRST
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
            self.tray, _ = tray_events.after(self.tray, name, event, self.clock())
            return self.own(name, self.pose())

    def restarted(self, name):
        """A board begins anew; the jig does when nothing of a session is left."""
        members = tuple(Member(name, member.number) if member.port == name else member
                        for member in self.tray.members)
        self.tray = replace(self.tray, members=members)
        if not any(member.running and member.state.taken for member in members):
            self.tray = tray(dict.fromkeys(self.mountings))
            self.lies, self.visit = FIRST, None

    def pose(self):
        """The jig's pose. A face that is taken again as it lies begins with how it lies."""
        face = self.tray.face
        if face and self.tray.running:
            visit = (face, self.tray.visits[face])
            if visit != self.visit:
                self.swapped = self.lies == face + "b"
                self.visit = visit
            self.lies = face + "ab"[(self.tray.letter == "b") != self.swapped]
        return self.lies


class JigHandOf:
    """hear() every byte that one board sends, as asked_hand.AskedHand does.

    With every window that a board in its session tells of, its box is asked for into the pose
    that the jig is to have now; whether it lies so already, or is to be left alone yet, its own
    operator knows best (sixflip_sim.operator.Operator.asked).
    """

    def __init__(self, hand, name):
        self.hand, self.name = hand, name
        self.line = b""

    def hear(self, data):
        """The commands for the simulated operator, a line of JSON each."""
        commands = []
        *lines, self.line = (self.line + data).split(b"\n")
        self.line = self.line[-LONGEST:]
        for line in lines:
            event = board_events.parse(line.decode("utf-8", "replace"))
            if event:
                pose = self.hand.hear(self.name, event)
                if event["event"] == "state":
                    commands.append(json.dumps({"pose": pose, "anew": False}).encode() + b"\n")
        return commands
