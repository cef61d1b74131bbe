"""When a session on a board does not go on any more, though the board goes on talking."""

import time

from ..errors import NoBoard

QUIET_S = 120           # longest step between two events: a Pico solves in less
SLACK_S = 60            # beyond what the board says that it will wait for a person
STATES = 8              # kinds of live states that the firmware has
PROGRESS = ("calibrating", "afresh", "pose", "redo", "refused", "capture", "solved", "saved",
            "rest", "record", "no_record", "hello")


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
