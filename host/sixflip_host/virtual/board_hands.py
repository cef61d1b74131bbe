"""The hand of one virtual board: it asks the simulated operator for the pose that the board wants.

It reads what a person at the board's terminal reads, and lets the box lie while it is measured.
"""

import json

from ..board import board_events
from ..guide.board_values import poses
from ..guide.next_step import following

LEAN = (0.6, 0.64, 0.48)    # 50 degrees off the nearest face
LONGEST = 4096              # bytes of a line


class Heard:
    """events(data) of every byte that a board sends: those whose lines are whole now."""

    def __init__(self):
        self.line = b""

    def events(self, data):
        *lines, self.line = (self.line + data).split(b"\n")
        self.line = self.line[-LONGEST:]
        parsed = (board_events.parse(line.decode("utf-8", "replace")) for line in lines)
        return [event for event in parsed if event]


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
