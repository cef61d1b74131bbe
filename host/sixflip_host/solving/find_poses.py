"""Rests and poses in a recording nobody labelled, by the board's own still windows.

Unlike the board, which must learn the sensor's noise from what comes first, the whole recording
is there: the noise is that of its quietest second.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sixflip.faces import AXIS, FACES, LEANING, SIGN, nearest_face, pose_name
from sixflip.noise_floor import CAP, ENTER, LEAVE, WINDOWS, NoiseFloor
from sixflip.pose_label import CROOKED_DEG, HALF_TURN_DEG, SAME_DEG
from sixflip.still_window import SAME, StillWindow, window_length

from ..progress import steps
from .attitude import heading_change

POSE_SAMPLES = 400      # sets the window's length as on the board, a quarter of a second
SHORTEST_S = 1.0        # a rest shorter than this is a pause in a move
# Held by hand the box never is as still as its sensor's noise; such rests are taken only when
# the others leave a face out. A turn by 90 degrees in 3 s moves gravity by 130 mg a window.
HAND = (30.0, 4.0)      # mg, deg/s: standard deviations within a window
HAND_WANDER_MG = 50.0   # from one window to the next
HAND_S = 2.0
RAIL = 32767
HELD_BY_HAND = "held_by_hand"   # key of a capture's header: names of poses that were not at rest


class FoundPoses:
    """pose: int16 (n,) codes; rests: list of Rest; noise: NoiseFloor of the quietest part."""

    def __init__(self, pose, rests, noise):
        self.pose = pose
        self.rests = rests
        self.noise = noise

    def label(self, capture):
        """Write the poses into the capture, and into its header which were held by hand."""
        capture.pose = self.pose
        by_hand = [pose_name(rest.code) for rest in self.rests if rest.by_hand]
        if by_hand:
            capture.meta[HELD_BY_HAND] = by_hand

    def remarks(self):
        """Lines for a person: what was found and what each rest was taken for."""
        if self.noise is None:
            return ["no rest found: nowhere a second without motion"]
        lines = ["%d rests found; noise %.2f mg" % (
            len(self.rests), np.mean(self.noise.sd[:3]) / self.noise.lsb[0])]
        for rest in self.rests:
            lines.append("%-4s samples %d to %d, %.1f deg off %s%s" % (
                pose_name(rest.code), rest.first, rest.end - 1, rest.off_deg, FACES[rest.face],
                "".join("; " + why for why in (rest.why, rest.by_hand and "held by hand") if why)))
        return lines


class Rest:
    """Samples first..end-1 without motion; mean accelerometer counts; what it was taken for."""

    def __init__(self, capture, first, end, by_hand=False):
        self.first = first
        self.end = end
        self.mean = capture.accel[first:end].mean(axis=0).tolist()
        self.by_hand = by_hand
        self.face, self.off_deg = nearest_face(*self.mean)
        self.code = 0
        self.why = ""


def find_poses(capture):
    """Label every sample of a Capture; returns FoundPoses. Nothing is changed in the capture."""
    windows = _windows(capture)
    noise = _quietest(capture, windows)
    rests = _rests(capture, windows, noise) if noise else []
    _name(capture, rests, noise)
    pose = np.zeros(len(capture), np.int16)
    for rest in rests:
        pose[rest.first:rest.end] = rest.code
    return FoundPoses(pose, rests, noise)


class _Windows:
    """The statistics of a recording's full windows, in arrays: as many objects would take more
    memory than the samples do. One window after the other is what NoiseFloor looks at.

    length  samples in a window
    mean, variance      float (n, axes)
    step                int (n, 2) of accelerometer and gyro
    saturated           int (n, 2), the counts at the rail or 0
    stale, jumped       bool (n,)
    """

    def __init__(self, length, count, axes):
        self.length = length
        self.axes = axes
        self.mean = np.zeros((count, axes))
        self.variance = np.zeros((count, axes))
        self.step = np.ones((count, 2), np.int32)
        self.saturated = np.zeros((count, 2), np.int32)
        self.stale, self.jumped = np.zeros((2, count), bool)

    def __len__(self):
        return len(self.mean)

    def keep(self, index, window):
        """Take what a full StillWindow found."""
        for axis in range(self.axes):
            self.mean[index, axis] = window.mean(axis)
            self.variance[index, axis] = window.variance(axis)
        for which in range(2):
            self.step[index, which] = window.step(which)
        self.saturated[index] = window.accel_saturated, window.gyro_saturated
        self.stale[index], self.jumped[index] = bool(window.stale), window.jumped

    def unusual(self):
        """Which of the windows cannot be a rest's, whatever their noise; bool (n,)."""
        return self.saturated.any(axis=1) | self.stale | self.jumped


class _Window:
    """One of _Windows as NoiseFloor asks a StillWindow."""

    def __init__(self, windows, index, rails):
        self.n = windows.length
        self.accel_rail, self.gyro_rail = rails
        self.accel_saturated, self.gyro_saturated = windows.saturated[index].tolist()
        self.stale = SAME if windows.stale[index] else 0
        self.jumped = bool(windows.jumped[index])
        self.mean = windows.mean[index].tolist().__getitem__
        self.variance = windows.variance[index].tolist().__getitem__
        self.step = windows.step[index].tolist().__getitem__


def _windows(capture):
    """The recording's full windows as _Windows."""
    rate = capture.meta["rate_hz"]
    length = window_length(rate, POSE_SAMPLES)
    no_gyro = np.broadcast_to(np.int16(0), (length, 3))
    out = _Windows(length, len(capture) // length, 3 if capture.gyro is None else 6)
    for index in steps(range(len(out)), "looking for rests"):
        start = index * length
        some = slice(start, start + length)
        samples = np.column_stack([
            capture.accel[some], no_gyro if capture.gyro is None else capture.gyro[some],
            np.zeros(length, int)]).tolist()
        intervals = np.diff(capture.t_us[some],
                            prepend=capture.t_us[max(0, start - 1)]).tolist()
        window = StillWindow(length, *_rails(capture), int(1e6 / rate + 0.5))
        for interval, sample in zip(intervals, samples):
            window.add(interval, sample)
        out.keep(index, window)
    return out


def _rails(capture):
    """Counts at which accelerometer and gyro are saturated; 0 where there is no gyro."""
    full_scale = capture.meta.get("accel_range_g", np.inf) * capture.meta["accel_lsb_per_g"]
    return int(min(RAIL, full_scale - 1)), RAIL if capture.gyro is not None else 0


def _quietest(capture, windows):
    """A NoiseFloor that knows the quietest second, or None when there is none."""
    lsb = (capture.meta["accel_lsb_per_g"],
           capture.meta["gyro_lsb_per_dps"] if capture.gyro is not None else 0)
    axes = windows.axes
    if len(windows) < WINDOWS:
        return None
    step = np.repeat(windows.step, 3, axis=1)[:, :axes]
    spread, means, unusual = (sliding_window_view(each, WINDOWS, axis=0) for each in (
        np.maximum(windows.variance, step ** 2 / 12), windows.mean, windows.unusual()))
    scale = np.repeat([lsb[0] / 1e3, lsb[1]], 3)[:axes]
    total = ((spread.mean(axis=-1) + means.var(axis=-1, ddof=1)) / scale ** 2
             / np.repeat(CAP, 3)[:axes] ** 2)
    total = np.where((total < 1).all(axis=1) & ~unusual.any(axis=-1), total.sum(axis=1), np.inf)
    best = int(np.argmin(total))
    if total[best] == np.inf:
        return None
    noise = NoiseFloor(*lsb)
    noise.known = True
    for axis in range(axes):
        noise.sd[axis] = float(np.sqrt(spread[best, axis].mean()))
    noise.bias = means[best].mean(axis=-1)[3:].tolist() or [0.0] * 3
    return noise


def _rests(capture, windows, noise):
    """Stretches without motion, as Rests in time order."""
    still = []
    rails = _rails(capture)
    for index in range(len(windows)):
        window = _Window(windows, index, rails)
        noise.look(window)
        still.append(not noise.judge(window, LEAVE if still and still[-1] else ENTER))
    rests = _runs(capture, windows, still, SHORTEST_S)
    faces = {rest.face for rest in rests if rest.off_deg <= CROOKED_DEG}
    if len(faces) < len(FACES):
        taken = np.zeros(len(capture), bool)
        for rest in rests:
            taken[rest.first:rest.end] = True
        by_hand = _runs(capture, windows, _steadied(capture, windows), HAND_S, by_hand=True)
        rests += [rest for rest in by_hand if not taken[rest.first:rest.end].any()]
    return sorted(rests, key=lambda rest: rest.first)


def _runs(capture, windows, still, shortest_s, by_hand=False):
    """A Rest for every unbroken run of still windows that lasts long enough."""
    length = windows.length
    shortest = max(2, int(shortest_s * capture.meta["rate_hz"] / length))
    edges = np.flatnonzero(np.diff([0, *still, 0]))
    return [Rest(capture, start * length, end * length, by_hand)
            for start, end in zip(edges[::2].tolist(), edges[1::2].tolist())
            if end - start >= shortest]


def _steadied(capture, windows):
    """For every window: does it look like a box steadied by hand?"""
    scale = np.repeat([capture.meta["accel_lsb_per_g"] / 1e3,
                       capture.meta.get("gyro_lsb_per_dps", 1)], 3)[:windows.axes]
    means = windows.mean[:, :3]
    wander = np.abs(np.diff(means, axis=0, prepend=means[:1])).max(axis=1) / scale[0]
    return ((np.sqrt(windows.variance) / scale <= np.repeat(HAND, 3)[:windows.axes]).all(axis=1)
            & (wander <= HAND_WANDER_MG) & ~windows.unusual())


def _name(capture, rests, noise):
    """Give every rest its pose: face from gravity, a or b from the gyro, leaning otherwise."""
    leaning = 0
    for index, rest in enumerate(rests):
        if rest.off_deg <= CROOKED_DEG:
            rest.code, rest.why = _letter(capture, rests[:index], rest, noise)
        else:
            rest.why = "leaning"
        if not rest.code:
            leaning += 1
            rest.code = LEANING + leaning


def _letter(capture, before, rest, noise):
    """a or b of a rest on a face, and why; code 0 when the gyro cannot say."""
    a = 1 + 2 * rest.face
    seen = [one for one in before if one.code in (a, a + 1)]
    if not seen:
        return a, ""
    last = seen[-1]
    if capture.gyro is None:
        if before[-1] is last or len({one.code for one in seen}) == 1:
            return 2 * a + 1 - last.code, "moved since %s, no gyro to tell" % pose_name(last.code)
        return 0, "on its face again, no gyro to tell a from b"
    turned = heading_change(capture, before[before.index(last):] + [rest], noise.bias,
                            AXIS[rest.face], SIGN[rest.face])
    if turned is None:
        return 0, "on its face again, but the gyro was saturated or samples are missing"
    why = "turned by %.0f deg since %s" % (turned, pose_name(last.code))
    if abs(turned) <= SAME_DEG:
        return last.code, why
    if abs(turned) >= HALF_TURN_DEG:
        return 2 * a + 1 - last.code, why
    return 0, why + ", neither a half turn nor none"
