"""When a session on a board is over: it came to an end, or it does not go on any more though the
board goes on talking."""

import time

from ..errors import CheckFailed, NoBoard
from .board_events import unusable

QUIET_S = 120           # longest step between two events: a Pico solves in less
SLACK_S = 60            # beyond what the board says that it will wait for a person
STATES = 8              # kinds of live states that the firmware has
PROGRESS = ("calibrating", "afresh", "pose", "redo", "refused", "capture", "solved", "saved",
            "rest", "record", "no_record", "hello")


class Ending:
    """take(event) -> True when it is over: saved, or the firmware streams again, or it stopped.

    solved: the event of that name, None before
    """

    def __init__(self):
        self.solved = None
        self.failed = self.misfit = None
        self.over = False

    def take(self, event):
        kind = event["event"]
        if kind == "calibrating":
            self.solved, self.over = None, False
        elif kind == "solved":
            self.solved = event
        elif kind == "error":
            self.failed = event
        elif kind == "misfit" and event["of"] == "solved":
            self.misfit = event
        elif kind == "saved" and self.solved or kind in ("ready", "stopped"):
            self.over = True
        return self.over

    def answer(self, port):
        """The solved event; CheckFailed or NoBoard when there is none."""
        if self.solved:
            return self.solved
        if self.misfit:
            raise NoBoard(unusable(port, self.misfit))
        if self.failed:
            raise CheckFailed("not calibrated: %s" % self.failed.get("what"))
        raise NoBoard("%s: no calibration came to an end on this board; is its firmware of this "
                      "version? (sixflip provision)" % port)


class SessionDeadline:
    """hear(event) with every event of a session; NoBoard once it should have gone on.

    A person may take long: the board says with every live state how long it will wait (left_s),
    and what it says in the first of a kind counts. Whatever shows that somebody does something
    begins anew; the same event over and over does not.
    """

    def __init__(self, link):
        self.port = link.port
        self.patience = getattr(link, "patience", 1)
        self.last = None
        self.begin()

    def begin(self):
        self.began = time.monotonic()
        self.until = self.began + QUIET_S * self.patience
        self.states = set()

    def hear(self, event):
        kind = event["event"]
        if kind in PROGRESS and event != self.last:
            self.last = event
            self.begin()
        elif kind == "state" and event.get("state") not in self.states \
                and len(self.states) < STATES:
            self.states.add(event.get("state"))
            left = (event.get("left_s") or 0) + SLACK_S
            self.until = max(self.until, time.monotonic() + left * self.patience)
        if time.monotonic() > self.until:
            raise NoBoard("%s: the session does not go on: %.0f s of nothing but %s, longer than "
                          "the board may wait; reset it, then sixflip calibrate --continue"
                          % (self.port, time.monotonic() - self.began, kind))
