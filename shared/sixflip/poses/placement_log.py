"""Placements that are accepted and the moves between them, in the order of the session.

While a move lasts its path (see Move) grows window by window, R from 0 and J from 9 on, behind
them what the last window turned. Within a window of a quarter of a second the axis of the turn
goes on changing as since the window before: a + (b x a) / 12 (Bortz' equation by two samples;
Savage 1998, eq. 33).
"""

import math
from array import array

from sixflip.poses.placement import COARSE, FINE, LATE_US, Move

STILL = 1e-3  # rad in a window: nothing turns
MOST = 32767  # that an array of "h" holds: 32 rad in units of COARSE


IN_TIME = (0, 0, 0, 0)  # late of every move whose samples came when they should: one object


def empty_move(first):
    """A Move that begins at a sample and has none yet."""
    return Move(-1, -1, first, 0, [0, 0, 0], 0, [0, 0, 0, 0], False, 0)


def add_window(move, window):
    """Append a window's samples to a move: exact sums, true elapsed time."""
    move.n += window.n
    move.duration_us += window.us
    for i in range(4):
        move.late[i] += window.late[i]
    move.saturated = move.saturated or window.gyro_saturated != 0
    move.largest_gap_us = max(move.largest_gap_us, window.largest_gap_us)
    for i in range(3):
        move.gyro_sums[i] += window.total(3 + i)


def absorb(move, later):
    """Append a later, adjoining stretch to a move."""
    move.n += later.n
    move.duration_us += later.duration_us
    move.late = [move.late[i] + later.late[i] for i in range(4)]
    move.saturated = move.saturated or later.saturated
    move.largest_gap_us = max(move.largest_gap_us, later.largest_gap_us)
    for i in range(3):
        move.gyro_sums[i] += later.gyro_sums[i]


def span_of(placement, period_us):
    """A placement's own samples as a Move; the largest gap is the most it can have been."""
    move = empty_move(placement.first)
    move.n = placement.n
    move.gyro_sums = placement.sums[3:6]
    move.duration_us = placement.duration_us
    move.late = placement.late or [0, 0, 0, 0]
    move.largest_gap_us = max(0, move.duration_us - move.n * period_us) + period_us
    return move


class PlacementLog:
    """moves[i] leads to placements[i]: before is i - 1 (-1: session's start), after is i.

    open is the move under way since the last placement. lsb_per_dps: of the gyro, 0 without.
    """

    def __init__(self, period_us, lsb_per_dps=0):
        self.period_us = period_us
        self.lsb_per_dps = lsb_per_dps
        self.placements = []
        self.moves = []
        self.open = empty_move(0)
        self._path = array("f", range(42)) if lsb_per_dps else None  # of the open move
        self._known = False  # since the placement before

    def follow(self, known):
        """From here on the open move's path is followed, or not known."""
        self._known = known and self._path is not None
        if self._known:
            for k in range(42):
                self._path[k] = k in (0, 4, 8)

    def add(self, window):
        """Append a window to the open move."""
        add_window(self.open, window)
        self.turn(window)

    def turn(self, window):
        """The path goes on by a window; the bias is what the gyro read in the last placement."""
        if not (self._known and window.n):
            return
        path = self._path
        rest = self.placements[-1]
        us = window.us - LATE_US * window.late[3]
        for k in range(3):
            path[39 + k] = path[36 + k]
            path[36 + k] = math.radians(
                (window.total(3 + k) / window.n * us + window.late[k] * (LATE_US // 2)
                 - rest.sums[3 + k] / rest.n * window.us) / self.lsb_per_dps / 1000000)
        x, y, z, a, b, c = path[36:]
        a, b, c = (x + (b * z - c * y) / 12, y + (c * x - a * z) / 12, z + (a * y - b * x) / 12)
        angle = math.sqrt(a * a + b * b + c * c)
        if angle < STILL:
            return
        turned = (a, b, c)
        s = math.sin(angle) / angle
        for i in (0, 3, 6):
            x, y, z = row = path[i:i + 3]
            d = (1 - math.cos(angle)) / angle * (x * a + y * b + z * c) / angle
            for k in range(3):
                x = (math.cos(angle) * row[k] + d * turned[k]
                     + s * (row[k - 2] * turned[k - 1] - row[k - 1] * turned[k - 2]))
                path[i + k] = x
                for j in range(3):
                    path[9 + 3 * (i + k) + j] += (row[k] + x) / 2 * turned[j]

    def accept(self, placement):
        """Close the open move with a placement that begins where it ends."""
        i = len(self.placements)
        self.open.before = i - 1
        self.open.after = i
        self.placements.append(placement)
        self.moves.append(self.open)
        if self._known and (self.placements[-2].pose - 1) // 2 != (placement.pose - 1) // 2:
            self.open.path = self._whole()  # of a flip the sums tell enough
        if not any(self.open.late):
            self.open.late = IN_TIME
        self.open = empty_move(placement.first + placement.n)
        self.follow(True)

    def _whole(self):
        """The path in whole numbers; None where it turned farther than they tell."""
        path = array("h", range(36))
        for k in range(36):
            value = int(self._path[k] * (FINE if k < 9 else COARSE))
            if abs(value) > MOST:
                return None
            path[k] = value
        return path

    def drop(self, code):
        """Withdraw every placement of a pose; its samples join the moves around it."""
        dropped = False
        i = 0
        while i < len(self.placements):
            if self.placements[i].pose == code:
                dropped = True
                self.drop_at(i)
            else:
                i += 1
        return dropped

    def drop_at(self, i):
        """Takes out the placement at an index; the moves around it become one."""
        merged = self.moves.pop(i)
        absorb(merged, span_of(self.placements.pop(i), self.period_us))
        merged.path = None
        if i < len(self.moves):
            absorb(merged, self.moves[i])
            self.moves[i] = merged
        else:
            absorb(merged, self.open)
            self.open = merged
            self.follow(False)
        for k in range(i, len(self.moves)):
            self.moves[k].before = k - 1
            self.moves[k].after = k
        self.open.before = len(self.moves) - 1
        self.open.after = -1
