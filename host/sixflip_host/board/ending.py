"""When a calibration is over, and what came of it."""

from ..errors import CheckFailed, NoBoard
from .board_events import unusable


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
