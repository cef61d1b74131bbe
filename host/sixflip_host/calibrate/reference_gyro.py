"""The gyro again from the raw samples, by another route than the shared solver.

Integrals by cumulative sums over the samples, flips chosen here, least squares by SVD on rows
that still hold the bias (the board takes it out first and puts it back afterwards).
"""

import math

import numpy as np

from sixflip.poses.faces import AXIS, face_of_code
from sixflip.poses.placement import GAP_US, LATE_US

from ..capture import registers
from ..errors import CheckFailed

# Standard deviations of a hand (along the axis, across it), rad, and of the bias, rad/s.
HAND, FLAT, WANDER = np.radians(0.4), np.radians(0.1), np.radians(0.005)
OLD = HAND / math.sqrt(1000.0)  # of the old matrix, where an axis was not flipped
FLAT_DEG, NEAR_DEG = 5.0, 40.0
MISALIGNED_DEG = 15.0   # as much as a gyro's own axes may be off, when two flips agree


class Interval:
    """turned (3,) rad with the bias in it, T s: the integral over samples first..end-1.

    Each stands for the usual interval before it; what was late or early in a move goes by the
    trapezoidal rule, its time counted in whole LATE_US as on the board.
    """

    def __init__(self, capture, first, end, moving):
        gyro = capture.gyro[first:end].astype(np.int64)
        times = capture.t_us[max(first - 1, 0):end]
        self.T = (times[-1] - times[0]) / 1e6
        self.gaps = np.diff(times)
        late, bridge = _late(capture, first, end) if moving else (0.0, np.zeros(3))
        self.turned = np.radians((gyro.mean(axis=0) * (self.T - late) + bridge)
                                 / capture.meta["gyro_lsb_per_dps"])
        self.saturated = registers.gyro_railed(capture, first, end)


def _late(capture, first, end):
    """(s by which samples were late in all, counts times s over that time)."""
    begin = max(first - 1, 0)
    period = int(1e6 / capture.meta["rate_hz"] + 0.5)
    late = 0.0
    bridge = np.zeros(3)
    for number, gap in enumerate(np.diff(capture.t_us[begin:end]).tolist(), begin + 1):
        if abs(gap - period) > period // 4:
            off = (gap - period) // LATE_US * LATE_US / 1e6
            late += off
            bridge += off * (capture.gyro[number - 1] / 2 + capture.gyro[number] / 2)
    return late, bridge


class GyroReference:
    """P (4, 3), sigma (4, 3), missing [axes], used [pose before, pose after] of every flip."""


def solve(capture, placements, accel_P, old=None):
    """The GyroReference; placements in the order of the session, with the board's noise.

    old  4 x 3, where the board kept an older matrix; None: nominal
    Raises CheckFailed when the samples do not determine it.
    """
    lsb = capture.meta["gyro_lsb_per_dps"]
    rests = [one for one in placements if one.n > 1]
    n = sum(one.n for one in rests)
    bias = np.radians(sum(capture.gyro[one.first:one.first + one.n].sum(axis=0, dtype=np.int64)
                          for one in rests) / n / lsb)
    flips = half_turns(capture, placements, bias, np.asarray(accel_P)[:3, :3])
    solved = GyroReference()
    solved.missing = [k for k in range(3) if k not in {flip[1] for flip in flips}]
    rows, truths, weights, spreads = [], [], [], []

    def add(row, truth, weight, spread):
        rows.append(row)
        truths.append(truth)
        weights.append(weight)
        spreads.append(spread)

    for rest in rests:
        at = Interval(capture, rest.first, rest.first + rest.n, moving=False)
        noise = np.radians(np.array(rest.noise[3:6]) / lsb) * at.T / math.sqrt(rest.n)
        variance = noise ** 2 + (WANDER * at.T) ** 2
        add([*at.turned, at.T], np.zeros(3), variance.max(), variance)
    for at, k, truth, _ in flips:
        add([*at.turned, at.T], truth, HAND ** 2, np.where(np.arange(3) == k, np.nan, FLAT ** 2))
    A = np.linalg.inv(np.asarray(old)[:3]) if old is not None else np.eye(3)
    for k in solved.missing:
        add([*(math.pi * A[k]), 0.0], math.pi * np.eye(3)[k], OLD ** 2, np.full(3, OLD ** 2))
    X, Y, root = np.array(rows), np.array(truths), 1 / np.sqrt(np.array(weights))[:, None]
    if np.linalg.matrix_rank(X * root, tol=1e-9 * np.abs(X * root).max()) < 4:
        raise CheckFailed("rests and flips of the capture do not determine the gyro")
    H = np.linalg.pinv(X * root, rcond=1e-14) * root.T
    solved.P = H @ Y
    solved.used = [flip[3] for flip in flips]
    free = len(flips) - (3 - len(solved.missing))
    left = [abs((np.append(at.turned, at.T) @ solved.P)[k]) - math.pi for at, k, _, _ in flips]
    hand = max(HAND ** 2, float(np.square(left).sum()) / free if free > 0 else 0.0)
    solved.sigma = np.sqrt(H ** 2 @ np.where(np.isnan(spreads), hand, spreads))
    return solved


def half_turns(capture, placements, bias, rotation):
    """[(Interval, axis, true turn (3,), (pose before, pose after))] of the flips that count."""
    turns = []
    for before, after in zip(placements, placements[1:]):
        face = face_of_code(before.pose)
        if face < 0 or face_of_code(after.pose) != face or before.pose == after.pose:
            continue
        first, end = before.first + before.n, after.first
        if end <= first:
            continue
        at = Interval(capture, first, end, moving=True)
        if at.saturated or at.gaps.max() - at.T * 1e6 / (end - first) > GAP_US:
            continue
        turned = np.degrees(at.turned - bias * at.T)
        k = AXIS[face]
        if abs(abs(turned[k]) - 180) <= NEAR_DEG:
            turns.append((at, k, turned, (before.pose, after.pose)))
    counted = []
    for index, (at, k, turned, poses) in enumerate(turns):
        lean = min(_across(turned, k), _across(turned @ rotation, k))
        alike = any(_across(turned - turned[k] / other[k] * other, k) <= FLAT_DEG
                    for at_other, (_, j, other, _) in enumerate(turns)
                    if j == k and at_other != index)
        if lean <= FLAT_DEG or (lean <= MISALIGNED_DEG and alike):
            truth = np.zeros(3)
            truth[k] = math.copysign(math.pi, turned[k])
            counted.append((at, k, truth, poses))
    return counted


def _across(turned, k):
    return np.linalg.norm(np.delete(turned, k))
