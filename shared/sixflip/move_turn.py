"""How far a move turned the box, by the sums of its samples; functions of a placement.Move."""

from sixflip.placement import LATE_US

# A brisk half turn in 1.2 s, its rate rising and falling like a cosine: bridged by a straight
# line, a pause of 80 ms at its worst place leaves 0.3 degrees, of 150 ms 1.4 degrees.
GAP_US = 150000


def turned(move, k):
    """The integral of gyro axis k, counts times seconds, bias still in it.

    Each sample stands for the usual interval. Where one was late, the rate went in a straight
    line from the one before to it: a board that writes to its flash pauses for some 50 ms, in
    the middle of a flip too.
    """
    us = move.duration_us - LATE_US * move.late[3]
    return (move.gyro_sums[k] / move.n * us + move.late[k] * (LATE_US // 2)) * 1e-6


def has_gap(move):
    """Whether a pause was too long to be bridged: part of a turn was not seen."""
    return move.largest_gap_us - move.duration_us / move.n > GAP_US
