"""A calibration as it happens on a board: its events into a State, commands to it."""

import json
import time

from ..board.board_events import events
from ..board.session_end import Ending, SessionDeadline
from ..errors import NoBoard
from ..history import logbook
from .session_state import CALIBRATING, State, after, logged

SILENCE_S = 30


class BoardSession:
    """state: session_state.State; ending: what came of it so far.

    board  its id where it is known already; step(at): what a plan says of placement at
    keep   whether what comes of it goes into the history: not of a replay
    """

    def __init__(self, link, board=None, step=None, keep=True, clock=time.monotonic):
        self.link = link
        self.step = step
        self.keep = keep
        self.clock = clock
        self.state = State()
        self.ending = Ending()
        self.deadline = SessionDeadline(link)
        self.witness = logbook.Witness(board)
        self.heard_at = clock()

    def pump(self, wait_s):
        """Take what the board says within wait_s seconds; the number of events.

        NoBoard when a board that should say something has been silent for long.
        """
        count = 0
        for event in events(self.link, wait_s, wait_s):
            count += event["event"] != "misfit"
            self.hear(event)
        now = self.clock()
        if count:
            self.heard_at = now
        elif not self.ending.over and now - self.heard_at > SILENCE_S:
            self.ending.answer(self.link.port)
            raise NoBoard("%s: the board has said nothing for %d s" % (self.link.port, SILENCE_S))
        return count

    def hear(self, event):
        self.state = after(self.state, event, self.clock(), self.step)
        self.witness.hear(event)
        if self.ending.take(event) and self.keep:
            self.witness.done()
        if not self.ending.over:
            self.deadline.hear(event)

    def say(self, line):
        """A lasting line of the host's own."""
        self.state = logged(self.state, [line])

    # -- what a person asks for

    def redo(self, face):
        """A face again, of the session under way or of the one that is over."""
        self.send({"cmd": "redo", "face": face})

    def undo(self):
        if self.state.stage == CALIBRATING:
            self.send({"cmd": "undo"})

    def stop(self):
        if self.state.stage == CALIBRATING:
            self.send({"cmd": "stop"})

    def send(self, command):
        self.link.send(json.dumps(command))
