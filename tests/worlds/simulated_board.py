"""A board of boards/board.py around a simulated world, with a host that reacts to events."""

import json

from sixflip_device import power_up, settings
from sixflip_device.boards.board import Board
from sixflip_sim import worlds

QUICK = {"grace_ms": 100, "pose_samples": 150, "rest_s": 3, "timeout_s": 40}
SHORT_WORLD = {"first_rest_s": 6.0, "dwell_s": 4.0, "move_s": 1.5, "tilt_deg": 2.0,
               "flip_error_deg": 0.0}


class TooLong(BaseException):
    """The firmware ran past the time the test gave it. (Not an Exception: nothing of ours
    may swallow it.)"""


class SimulatedBoard(Board):
    """answers: list of [event name or a function of the event, line to send, times]."""

    name = "simulated"
    unique_id = "0011223344556677"

    def __init__(self, world, root, answers=(), limit_s=400.0):
        self.world = world
        self.root = str(root) + "/"
        self.i2c = world.i2c
        self.answers = [list(a) for a in answers]
        self.events = []
        self.lamp = []
        self.pressed = False
        self._limit_us = world.clock.now_us() + int(limit_s * 1e6)
        self._lines = []

    def ticks_us(self):
        if self.world.clock.now_us() > self._limit_us:
            raise TooLong("still running after the time it was given")
        return self.world.clock.ticks_us()

    def ticks_diff(self, a, b):
        return self.world.clock.ticks_diff(a, b)

    def sleep_us(self, us):
        self.world.clock.sleep_us(us)

    def scl_pulse(self):
        self.world.i2c.pulse_scl()

    def led(self, on):
        self.lamp.append(1 if on else 0)

    def button(self):
        return self.pressed

    def read_line(self):
        return self._lines.pop(0) if self._lines else None

    def write_line(self, text):
        event = json.loads(text)
        event["at_s"] = self.world.clock.now_us() / 1e6
        self.events.append(event)
        for answer in self.answers:
            wanted, line, left = answer
            hit = event["event"] == wanted if isinstance(wanted, str) else wanted(event)
            if hit and left:
                answer[2] -= 1
                self._lines.append(line if isinstance(line, str) else json.dumps(line))

    def named(self, name):
        return [e for e in self.events if e["event"] == name]

    def only(self, name):
        found = self.named(name)
        assert len(found) == 1, (name, found)
        return found[0]

    def names(self):
        """Names of the events in order, repetitions of state and sample left out."""
        names = []
        for e in self.events:
            if e["event"] not in ("state", "sample") or names[-1:] != [e["event"]]:
                names.append(e["event"])
        return names


STOP_WHEN_READY = ["ready", {"cmd": "stop"}, 1]


def power_on(root, world=None, answers=(STOP_WHEN_READY,), limit_s=400.0, board=None,
             **changes):
    """One power-up in a folder that stands for the flash -> the board with its events.

    world: a description for worlds.make, on top of SHORT_WORLD; changes: settings.
    """
    if board is None:
        board = SimulatedBoard(worlds.make(dict(SHORT_WORLD, **(world or {}))), root, answers,
                               limit_s)
    values, problems = settings.merge(dict(QUICK, **changes))
    power_up.run(board, values, problems)
    return board
