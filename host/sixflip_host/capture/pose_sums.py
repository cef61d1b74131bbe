"""Labelled stretches of a capture as placements and moves, for the shared solvers."""

import numpy as np

from sixflip.poses.placement import LATE_US, Move, Placement
from sixflip.poses.placement_log import PlacementLog
from sixflip.poses.still_window import window_length

from . import registers, rests
from .still_windows import POSE_SAMPLES

AT_A_TIME = 1000        # windows as floats, which take four times the room of counts


def placements(capture):
    """list of Placement, one for every run of a label in capture.pose; none when unlabelled."""
    return [one(capture, *run) for run in rests.labelled(capture.pose)]


def one(capture, code, first, end):
    """The Placement of samples first..end-1."""
    n = end - first
    sums = [int(s) for s in capture.accel[first:end].sum(axis=0, dtype=np.int64)]
    sums += ([int(s) for s in capture.gyro[first:end].sum(axis=0, dtype=np.int64)]
             if capture.gyro is not None else [0, 0, 0])
    sums.append(int(capture.temp[first:end].sum(dtype=np.int64))
                if capture.temp is not None else 0)
    window = window_length(capture.meta["rate_hz"], POSE_SAMPLES)
    noise = white_noise(capture.accel[first:end], window)
    noise += (white_noise(capture.gyro[first:end], window) if capture.gyro is not None
              else [0.0] * 3)
    span = int(capture.t_us[end - 1] - capture.t_us[first])
    return Placement(code, first, n, sums, noise, span * n // (n - 1) if n > 1 else 0)


def white_noise(counts, window):
    """Standard deviation within windows of so many samples, counts, list of one per column.

    Deviations from the mean of each short window, so that a drift over the pose is no noise;
    the board measures it the same way.
    """
    windows = len(counts) // window
    if windows:
        cut = counts[:windows * window].reshape(windows, window, -1)
        variance = [cut[first:first + AT_A_TIME].astype(float).var(axis=1, ddof=1)
                    for first in range(0, windows, AT_A_TIME)]
        return np.sqrt(np.concatenate(variance).mean(axis=0)).tolist()
    if len(counts) > 1:
        return counts.astype(float).std(axis=0, ddof=1).tolist()
    return [0.0] * counts.shape[1]


def moves(capture, placements):
    """list of Move between consecutive placements; none without a gyro, or where the board did
    not keep all of the samples."""
    if capture.gyro is None or capture.sums_only or len(placements) < 2:
        return []
    return [_move(capture, index, *pair)
            for index, pair in enumerate(zip(placements, placements[1:]))]


def _move(capture, index, before, after):
    """The Move from the end of one placement to the start of the next."""
    first, end = before.first + before.n, after.first
    gyro = capture.gyro[first:end]
    gaps = np.diff(capture.t_us[first - 1:end])
    move = Move(index, index + 1, first, end - first,
                [int(s) for s in gyro.sum(axis=0, dtype=np.int64)],
                # n samples span n intervals, each sample the one before it, as on the board
                int(capture.t_us[end - 1] - capture.t_us[first - 1]),
                _late(capture, first, end, gaps),
                registers.gyro_railed(capture, first, end), int(gaps.max(initial=0)))
    move.path = _path(capture, before, after)
    return move


class _Window:
    """Samples first..end-1 as PlacementLog takes them from a StillWindow."""

    def __init__(self, capture, first, end):
        self.n = end - first
        self.us = int(capture.t_us[end - 1] - capture.t_us[first - 1])
        self.late = _late(capture, first, end, np.diff(capture.t_us[first - 1:end]))
        self._sums = capture.gyro[first:end].sum(axis=0, dtype=np.int64)

    def total(self, i):
        """Sum of gyro axis i - 3."""
        return int(self._sums[i - 3])


def _path(capture, before, after):
    """Move.path, by windows as long as the board's; None where no sample of it was kept."""
    if after.first == before.first + before.n:
        return None
    log = PlacementLog(0, capture.meta["gyro_lsb_per_dps"])
    log.accept(before)
    length = window_length(capture.meta["rate_hz"], POSE_SAMPLES)
    first, end = before.first + before.n, after.first
    for at in range(first, end, length):
        log.turn(_Window(capture, at, min(at + length, end)))
    log.accept(after)
    return log.moves[-1].path


def _late(capture, first, end, gaps):
    """Move.late of samples first..end-1, which gaps (us) lead to."""
    period = int(1e6 / capture.meta["rate_hz"] + 0.5)
    off = gaps - period
    off = np.where(np.abs(off) > period // 4, off // LATE_US, 0)
    gyro = capture.gyro[first - 1:end].astype(np.int64)
    return [int(x) for x in off @ (gyro[:-1] + gyro[1:])] + [int(off.sum())]
