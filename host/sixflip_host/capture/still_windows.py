"""The board's still windows over a whole recording, in arrays, and what they say of rest.

The same whole numbers as sixflip.poses.still_window adds up one sample after another, so that what
the host finds is what the board would have found; the tests compare the two bit by bit.
"""
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sixflip import RAIL
from sixflip.poses.noise_floor import CAP, ENTER, LEAVE, WINDOWS, NoiseFloor
from sixflip.poses.still_window import SAME, SPAN, window_length

from ..progress import steps

POSE_SAMPLES = 400  # sets the length of a window as on the board, a quarter of a second
# Times 1 g, or its inverse: within both it is gravity. A range that is told wrong makes it 2 or 4
# times 1 g, and an offset is added, so that the middle of those two parts no rests of one sensor.
WEIGHS = 8.0 ** 0.5
# A gyro that hangs is stiller than it ever is at rest, and the accelerometer is not, by more than
# HANGS; it reads LEVEL_DPS or more, farther off than most zero-rate levels.
HANGS, LEVEL_DPS = 2.0, 5.0
AT_A_TIME = 400  # windows whose samples are there as wide integers at once


@dataclass(frozen=True)
class StillWindows:
    """The statistics of a recording's n full windows, arrays that are read only.

    length  samples in a window; rails (2,): counts at which accelerometer and gyro are
            saturated, 0 without a gyro; lsb (2,): counts per g and per deg/s, 0 without
    mean, variance      (n, axes) counts, counts squared
    step                int (n, 2) of accelerometer and gyro
    saturated           int (n, 2), the counts at the rail or 0
    stale, jumped       bool (n,)
    """

    length: int
    rails: tuple
    lsb: tuple
    mean: np.ndarray
    variance: np.ndarray
    step: np.ndarray
    saturated: np.ndarray
    stale: np.ndarray
    jumped: np.ndarray

    def __len__(self):
        return len(self.mean)

    def unusual(self):
        """Which of the windows cannot be a rest's, whatever their noise; bool (n,)."""
        return self.saturated.any(axis=1) | self.stale | self.jumped

    def heavy(self, means):
        """bool (n,): which of means (n, 3 or more) counts read about 1 g."""
        size = np.linalg.norm(means[:, :3], axis=1) / self.lsb[0]
        return (size > 1.0 / WEIGHS) & (size < WEIGHS)

    def one(self, index):
        """A window as NoiseFloor asks a StillWindow."""
        return _Window(self, index)


class _Window:
    def __init__(self, windows, index):
        self.n = windows.length
        self.accel_rail, self.gyro_rail = windows.rails
        self.accel_saturated, self.gyro_saturated = windows.saturated[index].tolist()
        self.stale = SAME if windows.stale[index] else 0
        self.jumped = bool(windows.jumped[index])
        self.mean = windows.mean[index].tolist().__getitem__
        self.variance = windows.variance[index].tolist().__getitem__
        self.step = windows.step[index].tolist().__getitem__


def cut_into_windows(capture):
    """StillWindows of a capture."""
    rate = capture.meta["rate_hz"]
    length = window_length(rate, POSE_SAMPLES)
    count = len(capture) // length
    full_scale = capture.meta.get("accel_range_g", np.inf) * capture.meta["accel_lsb_per_g"]
    gyro = capture.gyro is not None
    rails = int(min(RAIL, full_scale - 1)), RAIL if gyro else 0
    lsb = capture.meta["accel_lsb_per_g"], capture.meta["gyro_lsb_per_dps"] if gyro else 0
    axes = 6 if gyro else 3
    table = {"mean": np.zeros((count, axes)), "variance": np.zeros((count, axes)),
             "step": np.ones((count, 2), np.int32), "saturated": np.zeros((count, 2), np.int32),
             "stale": np.zeros(count, bool), "jumped": np.zeros(count, bool)}
    triads = [_Triad(counts, rail, _span(capture.meta, sensor)) for counts, rail, sensor in zip(
        (capture.accel, capture.gyro), rails, ("accel", "gyro")) if counts is not None]
    for first in steps(range(0, count, AT_A_TIME), "looking for rests"):
        some = slice(first, min(first + AT_A_TIME, count))
        for which, triad in enumerate(triads):
            triad.fill(table, which, some, length)
    for values in table.values():
        values.setflags(write=False)
    return StillWindows(length, rails, lsb, **table)


def _span(meta, sensor):
    """How far a reading may be from the first of its window: what the board's sums hold; of an
    import's own counts, which are as fine as 16 bits allow, noise alone may go further."""
    return 2 * RAIL + 1 if meta.get(sensor + "_values") == "float" else SPAN


class _Triad:
    """One sensor's columns of the table, some windows after the other; what the board's window
    carries over its border: the last reading, how long it has been the same, the bits seen."""

    def __init__(self, counts, rail, span):
        self.counts, self.rail, self.span = counts, rail, span
        self.last, self.same, self.bits = np.zeros(3, np.int64), 1, 0

    def fill(self, table, which, some, length):
        n = some.stop - some.start
        x = self.counts[some.start * length:some.stop * length].astype(np.int64)
        cut = x.reshape(n, length, 3)
        own = slice(3 * which, 3 * which + 3)
        off = cut - cut[:, :1]
        total = off.sum(axis=1)
        table["mean"][some, own] = cut[:, 0] + total / length
        far = np.abs(off) > self.span
        squares = (np.where(far, self.span, off) ** 2).sum(axis=1)
        spread = np.maximum(length * squares - total * total, 0)
        table["variance"][some, own] = spread / (length * (length - 1))
        table["jumped"][some] |= far.any(axis=(1, 2))
        table["stale"][some] |= self._stuck(x).reshape(n, length).any(axis=1)
        at_rail = np.abs(cut) >= self.rail
        for k in np.flatnonzero(at_rail.any(axis=(1, 2))):
            table["saturated"][some.start + k, which] = cut[k][at_rail[k]][-1]
        seen = np.bitwise_or.accumulate(np.bitwise_or.reduce(cut, axis=(1, 2))) | self.bits
        self.bits = int(seen[-1])
        table["step"][some, which] = np.where(seen == 0, 1, seen & -seen)

    def _stuck(self, x):
        """(n,) True where a reading has been the same SAME times."""
        before = np.vstack([self.last, x[:-1]])
        changed = (x != before).any(axis=1)
        place = np.arange(len(x))
        since = place - np.maximum.accumulate(np.where(changed, place, -1))
        same = np.where(since == place + 1, self.same + since, 1 + since)
        self.last, self.same = x[-1], int(min(same[-1], SAME))
        return same >= SAME


def quietest(windows, among=None):
    """A NoiseFloor that knows the quietest second, or None when there is none; among: bool (n,),
    the windows that may be in it."""
    axes = windows.mean.shape[1]
    if len(windows) < WINDOWS:
        return None
    step = np.repeat(windows.step, 3, axis=1)[:, :axes]
    wrong = windows.unusual() if among is None else windows.unusual() | ~among
    spread, means, unusual = (sliding_window_view(each, WINDOWS, axis=0) for each in (
        np.maximum(windows.variance, step ** 2 / 12), windows.mean, wrong))
    scale = np.repeat([windows.lsb[0] / 1e3, windows.lsb[1]], 3)[:axes]
    total = ((spread.mean(axis=-1) + means.var(axis=-1, ddof=1)) / scale ** 2
             / np.repeat(CAP, 3)[:axes] ** 2)
    total = np.where((total < 1).all(axis=1) & ~unusual.any(axis=-1), total.sum(axis=1), np.inf)
    best = int(np.argmin(total))
    if total[best] == np.inf:
        return None
    noise = NoiseFloor(*windows.lsb)
    noise.known = True
    for axis in range(axes):
        noise.sd[axis] = float(np.sqrt(spread[best, axis].mean()))
    noise.bias = means[best].mean(axis=-1)[3:].tolist() or [0.0] * 3
    return noise


def floors(windows):
    """[(NoiseFloor, StillWindows that it judges)]: of the quietest second, of those that read
    about 1 g where there are any; and where a gyro may hang in it, of the quietest one in which it
    reads half as much at most, and of such windows alone."""
    heavy = windows.heavy(windows.mean)
    first = quietest(windows, heavy) or quietest(windows)
    if first is None:
        return []
    level = np.linalg.norm(first.bias)
    if not windows.lsb[1] or level < LEVEL_DPS * windows.lsb[1]:
        return [(first, windows)]
    slow = replace(windows, jumped=windows.jumped | (
        2.0 * np.linalg.norm(windows.mean[:, 3:], axis=1) > level))
    other = quietest(slow, heavy)
    alike = other is not None and all(b < HANGS * a for a, b in zip(first.sd[:3], other.sd))
    return [(first, windows), (other, slow)] if alike else [(first, windows)]


def learnt(windows):
    """(NoiseFloor that learns from what comes first, as the board's does; sentences against
    rest of the windows it looked at)."""
    noise, against = NoiseFloor(*windows.lsb), []
    for k in range(len(windows)):
        noise.look(windows.one(k))
        if noise.reason:
            against.append(sentence(noise))
    return noise, against


def still(windows, noise, first_twice=False):
    """(bool (n,), sentences against rest): which windows a NoiseFloor judges to be still, with
    its hysteresis. first_twice: the first window has nothing before it to wander from, where
    the floor has looked at others already."""
    at_rest, against = np.zeros(len(windows), bool), []
    for k in range(len(windows)):
        window = windows.one(k)
        for _ in range(2 if first_twice and not k else 1):
            noise.look(window)
        at_rest[k] = not noise.judge(window, LEAVE if k and at_rest[k - 1] else ENTER)
        if not at_rest[k]:
            against.append(sentence(noise))
    return at_rest, against


def sentence(noise):
    """Why a window is not still, with the number and its limit."""
    words = {"saturated": "full scale is touched", "stale": "the readings do not change"}
    text = words.get(noise.reason) or {
        "noisy": "it shakes", "moving": "it moves"}.get(noise.reason, noise.reason)
    form = "%d" if noise.unit in ("counts", "readings") else "%.3g"
    return "%s (%s %s, limit %s)" % (text, form % noise.value, noise.unit, form % noise.limit)
