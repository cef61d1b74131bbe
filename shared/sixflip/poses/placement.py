"""What a session yields: placements, the box at rest in one pose, and the moves between them.

Both are sums of raw counts in whole numbers, so that nothing is lost by single-precision floats.
The functions below tell how far a move has turned the box.
"""



LATE_US = 128  # unit of Move.late's times
FINE = 16384  # units of Move.path: of its rotation,
COARSE = 1024  # and of what it turns with the gyro's matrix


class Placement:
    """One unbroken rest of the box in one pose; the unit of replication of every solve.

    pose         code of faces.py (1..12 a face with a or b, 12 + k the k-th leaning pose)
    first, n     index of its first sample in the session, number of samples
    sums         seven exact integers: counts of ax ay az gx gy gz temp summed over n samples
    noise        six floats: standard deviation within the pose, counts, ax ay az gx gy gz
    duration_us  the time the n samples span, n times the mean interval
    late         as a Move's, where samples came late and the board took it itself, or None
    """

    late = None

    def __init__(self, pose, first, n, sums, noise, duration_us):
        self.pose = pose
        self.first = first
        self.n = n
        self.sums = sums
        self.noise = noise
        self.duration_us = duration_us


class Move:
    """The interval between two consecutive placements, rests at both ends included.

    before, after    indices into the list of placements (-1: none)
    first, n         index of its first sample, number of samples
    gyro_sums        three exact integers: counts of gx gy gz summed over n samples
    duration_us      true elapsed time from the device's timestamps
    late             [gx, gy, gz, time] of the samples that came early or late: the count before
                     plus the count then, times by how much, and by how much; LATE_US is the unit
    saturated        True when a gyro axis touched full scale
    largest_gap_us   the longest interval between two samples
    path             from face to face, where a placement was before, none was withdrawn since
                     and it turned less than 32 rad, else None: 36 whole numbers.
                     R (3 x 3, rows, FINE) takes vectors of the box at the end to what they
                     are in the box at the start, by the gyro's
                     nominal scale. Where w = (1 + D) w_read, the start sees it turn J D more:
                     J[row][i][j] (COARSE), the sum over the path of R[row][i] times what axis
                     j turned
    """

    path = None

    def __init__(self, before, after, first, n, gyro_sums, duration_us, late, saturated,
                 largest_gap_us):
        self.before = before
        self.after = after
        self.first = first
        self.n = n
        self.gyro_sums = gyro_sums
        self.duration_us = duration_us
        self.late = late
        self.saturated = saturated
        self.largest_gap_us = largest_gap_us


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
