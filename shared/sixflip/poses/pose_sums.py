"""One pose while it is captured: exact integer sums, and refusal of what moves meanwhile."""

import math
from array import array

from sixflip.poses.noise_floor import SIGMAS
from sixflip.poses.placement import Placement
from sixflip.poses.placement_log import add_window, empty_move

DRIFT_MG = 1.0  # first half against second half, beyond the noise of both


class PoseSums:
    """`windows` windows of equal length beginning at sample `first`.

    span is the same stretch as a Move: where the capture fails, the move takes it back.
    """

    def __init__(self, pose, first, windows):
        self.pose = pose
        self.windows = windows
        self.added = 0
        self.sums = [0] * 7
        self.half = None
        self.squares = array("d", [0.0] * 6)
        self.span = empty_move(first)

    def add(self, window, noise):
        """Take a window that was found still; "" or the reason why the pose moved."""
        if self.added and noise.wander(self.means(), self.added, window.n):
            return noise.reason
        add_window(self.span, window)
        for i in range(7):
            self.sums[i] += window.total(i)
        for i in range(6):
            self.squares[i] += window.variance(i)
        self.added += 1
        if self.added == self.windows // 2:
            self.half = self.sums[:3]
        if self.full() and self.half:
            return self._drift(window, noise)
        return ""

    def full(self):
        """Whether all windows are taken."""
        return self.added == self.windows

    def means(self):
        """Six means in counts, one float each."""
        return [self.sums[i] / self.span.n for i in range(6)]

    def _drift(self, window, noise):
        """A creep too slow for the windows shows between the halves."""
        early = self.windows // 2 * window.n
        late = self.span.n - early
        lsb = noise.lsb[0]
        step = window.step(0)
        for i in range(3):
            apart = abs((self.sums[i] - self.half[i]) / late - self.half[i] / early) / lsb
            limit = DRIFT_MG + SIGMAS * noise.sd[i] * math.sqrt(1 / early + 1 / late) / lsb
            if noise.sd[i] < step / 2:
                limit += step / lsb  # too little noise to average over the steps
            if apart > limit:
                noise.say("moving", apart, limit, "mg")
                return "moving"
        return ""

    def placement(self):
        """The Placement of the windows taken."""
        noise = array("f", [math.sqrt(v / self.added) for v in self.squares])
        span = self.span
        placement = Placement(self.pose, span.first, span.n, self.sums, noise, span.duration_us)
        if span.late[3]:
            placement.late = span.late
        return placement
