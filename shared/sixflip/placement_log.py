"""Placements in force and the moves between them, in the order of the session."""

from sixflip.placement import Move


def empty_move(first):
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
    for i in range(4):
        move.late[i] += later.late[i]
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

    open is the move under way since the last placement.
    """

    def __init__(self, period_us):
        self.period_us = period_us
        self.placements = []
        self.moves = []
        self.open = empty_move(0)

    def accept(self, placement):
        """Close the open move with a placement that begins where it ends."""
        i = len(self.placements)
        self.open.before = i - 1
        self.open.after = i
        self.placements.append(placement)
        self.moves.append(self.open)
        self.open = empty_move(placement.first + placement.n)

    def drop(self, code):
        """Withdraw every placement of a pose; its samples join the moves around it."""
        found = False
        i = 0
        while i < len(self.placements):
            if self.placements[i].pose == code:
                found = True
                self.drop_at(i)
            else:
                i += 1
        return found

    def drop_at(self, i):
        merged = self.moves.pop(i)
        absorb(merged, span_of(self.placements.pop(i), self.period_us))
        if i < len(self.moves):
            absorb(merged, self.moves[i])
            self.moves[i] = merged
        else:
            absorb(merged, self.open)
            self.open = merged
        for k in range(i, len(self.moves)):
            self.moves[k].before = k - 1
            self.moves[k].after = k
        self.open.before = len(self.moves) - 1
        self.open.after = -1
