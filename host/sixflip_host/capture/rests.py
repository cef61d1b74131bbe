"""Where a recording rests: the one finder, with the settings of each use as values.

A rest is an unbroken run of samples that are all still, and long enough. Two things tell what
is still: a label (the board's, or an importer's), or the board's own still windows against the
sensor's noise (find, longest). What differs from use to use is a Stillness or an argument, and
nothing else. Free-hand recordings, whose rests are cut where the motion begins, and gyros
alone are rests_by_variance.py's.
"""
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sixflip.poses.faces import FACES, nearest_face
from sixflip.poses.noise_floor import WINDOWS, NoiseFloor
from sixflip.poses.pose_label import CROOKED_DEG

from . import still_windows


class Run(NamedTuple):
    """Samples first..end-1 with one pose code (0: not named)."""

    code: int
    first: int
    end: int


@dataclass(frozen=True)
class Stillness:
    """shortest_s: of a rest; hand_s: of a rest that a hand steadies, taken only where the others
    leave a face out, None: never; hand (2,), hand_wander: how still a hand is, mg and deg/s
    within a window and mg from one window to the next."""

    shortest_s: float = 1.0
    hand_s: float | None = None
    hand: tuple = (30.0, 4.0)
    hand_wander: float = 50.0


# Held by hand the box never is as still as its sensor's noise. A turn by 90 degrees in 3 s moves
# gravity by 130 mg a window. A rest shorter than a second is a pause in a move.
POSES = Stillness(1.0, 2.0)


@dataclass(frozen=True)
class Rest:
    """Samples first..end-1 without motion: mean accelerometer counts, the face that points up
    and how far off it is, whether a hand held it; code and why: what it was taken for."""

    first: int
    end: int
    mean: tuple
    face: int
    off_deg: float
    by_hand: bool = False
    code: int = 0
    why: str = ""


@dataclass(frozen=True)
class Found:
    """rests: tuple of Rest in time order; noise: NoiseFloor of the quietest second or None."""

    rests: tuple
    noise: NoiseFloor | None


@dataclass(frozen=True)
class LongestRest:
    """n samples from index first on.

    means   seven: counts of ax ay az gx gy gz temp; noise: six standard deviations, counts
    reason  "" or why the recording is no rest, one sentence; then the rest is a fragment
    """

    first: int = 0
    n: int = 0
    means: tuple = (0.0,) * 7
    noise: tuple = (0.0,) * 6
    reason: str = ""

    def noise_mg(self, lsb_per_g):
        """(root mean square of the three axes' noise, that of the noisiest one), mg."""
        noise = 1e3 / lsb_per_g * np.array(self.noise[:3])
        return float(np.sqrt(np.mean(noise ** 2))), float(noise.max())


# deg/s that a bias moves at most from one rest to the next: 15 degC of an ITG-3205, of which
# a degree moves it by 0.3. What is further from all rests turns at a steady rate, on a table or in
# a bend, which is as still as a rest but for that, and takes a while to come to it. What has
# jumped is between the two levels for no longer than a low pass of 5 Hz takes, the slowest of an
# MPU-6050 [register map rev 4.2, register 26]: 0.07 s from a tenth to nine tenths of a step.
TURNS_DPS, AT_ONCE_S, ACROSS_S, ACROSS = 5.0, 1.5, 0.15, (0.25, 0.75)
MOSTLY = 0.5  # of a recording at rest: a shorter one is a pause of something that moves


def labelled(pose, shortest=1, without=()):
    """list of Run: unbroken runs of a label in pose (n,), moving left out; those of at least so
    many samples and with none of these codes. None of it where pose is None."""
    if pose is None:
        return []
    pose = np.asarray(pose)
    edges = np.flatnonzero(np.diff(pose)) + 1
    starts = np.concatenate(([0], edges)).tolist()
    ends = np.concatenate((edges, [len(pose)])).tolist()
    return [Run(int(pose[start]), start, end) for start, end in zip(starts, ends)
            if end > start and pose[start] and end - start >= shortest
            and pose[start] not in without]


def find(capture, stillness=POSES):
    """Found: every rest of a capture, against the noise of its quietest second. Unlike the
    board, which must learn that from what comes first, the whole recording is there."""
    windows = still_windows.cut_into_windows(capture)
    tried = [(sum(rest.end - rest.first for rest in found), found, noise) for noise, found in (
        (noise, _rests(capture, some, still_windows.still(some, noise)[0], stillness.shortest_s))
        for noise, some in still_windows.floors(windows))]
    if not tried:
        return Found((), None)
    _, rests, noise = max(tried, key=lambda one: one[0])
    faces = {rest.face for rest in rests if rest.off_deg <= CROOKED_DEG}
    if stillness.hand_s is not None and len(faces) < len(FACES):
        taken = np.zeros(len(capture), bool)
        for rest in rests:
            taken[rest.first:rest.end] = True
        by_hand = _rests(capture, windows, _steadied(capture, windows, stillness),
                         stillness.hand_s, True)
        rests += [rest for rest in by_hand if rest.face not in faces
                  and not taken[rest.first:rest.end].any()]
    # What reads less flies freely, and what reads more is pushed, where others read gravity.
    rests = [rest for rest in rests if windows.heavy(np.array([rest.mean]))[0]] or rests
    return Found(tuple(at_one_rate(capture, sorted(rests, key=lambda rest: rest.first))), noise)


def at_one_rate(capture, rests):
    """Those of the rests, in time order, in which the gyro reads about the same: the most time. A
    rest that follows at once is the same one, whatever the gyro reads."""
    if capture.gyro is None or len(rests) < 2:
        return rests
    rates = np.array([capture.gyro[rest.first:rest.end].mean(axis=0) for rest in rests]
                     ) / capture.meta["gyro_lsb_per_dps"]
    near = np.linalg.norm(rates[:, None] - rates, axis=2) <= TURNS_DPS
    for place, (rest, following) in enumerate(zip(rests, rests[1:])):
        at_once = _jumps(capture, rest, following, rates[place], rates[place + 1])
        near[place, place + 1] |= at_once
        near[place + 1, place] |= at_once
    while True:  # alike is what a chain of near ones leads to
        further = near @ near
        if (further == near).all():
            break
        near = further
    seconds = near @ np.array([rest.end - rest.first for rest in rests])
    return [rest for rest, alike in zip(rests, near[seconds.argmax()]) if alike]


def _jumps(capture, rest, following, before, after):
    """Whether the gyro comes from one level (3,) deg/s to the next without staying between them,
    as a bias that jumps does and a box that turns does not."""
    rate = capture.meta["rate_hz"]
    if following.first - rest.end > AT_ONCE_S * rate:
        return False
    between = capture.gyro[rest.end:following.first] / capture.meta["gyro_lsb_per_dps"]
    step = after - before
    way = (between - before) @ step / max(float(step @ step), 1e-9)
    return np.count_nonzero((way > ACROSS[0]) & (way < ACROSS[1])) <= max(1.0, ACROSS_S * rate)


def longest(capture):
    """LongestRest of a capture, for what is measured at rest and no session: mounting, and
    whether a calibration still holds. The noise is learnt as the board learns it."""
    windows = still_windows.cut_into_windows(capture)
    if len(windows) < WINDOWS:
        rate = capture.meta["rate_hz"]
        return LongestRest(reason="%.1f s are too short, %.1f s of rest are needed" % (
            len(capture) / rate, WINDOWS * windows.length / rate))
    noise, against = still_windows.learnt(windows)
    if not noise.known:
        return LongestRest(reason=_most_common(against)
                           or "it moves: the windows differ too much for rest")
    still, against = still_windows.still(windows, noise, first_twice=True)
    start, end = max(stretches(still), key=lambda s: s[1] - s[0], default=(0, 0))
    reason = ""
    if end - start < MOSTLY * len(windows):
        reason = "still for %d %% of the recording only: %s" % (
            100 * (end - start) // len(windows), _most_common(against))
    first, n = start * windows.length, (end - start) * windows.length
    return LongestRest(first, n, _means(capture, first, n), tuple(noise.sd), reason)


def stretches(still):
    """[(first, end)] of the unbroken runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(still, np.int8), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist()))


def _rests(capture, windows, still, shortest_s, by_hand=False):
    """A Rest for every unbroken run of still windows that lasts long enough."""
    length = windows.length
    shortest = max(2, int(shortest_s * capture.meta["rate_hz"] / length))
    return [rest(capture, start * length, end * length, by_hand)
            for start, end in stretches(still) if end - start >= shortest]


def rest(capture, first, end, by_hand=False):
    """Rest of samples first..end-1 of a capture."""
    mean = capture.accel[first:end].mean(axis=0).tolist()
    face, off_deg = nearest_face(*mean)
    return Rest(first, end, tuple(mean), face, off_deg, by_hand)


def _steadied(capture, windows, stillness):
    """For every window: does it look like a box steadied by hand?"""
    scale = np.repeat([capture.meta["accel_lsb_per_g"] / 1e3,
                       capture.meta.get("gyro_lsb_per_dps", 1)], 3)[:windows.mean.shape[1]]
    means = windows.mean[:, :3]
    wander = np.abs(np.diff(means, axis=0, prepend=means[:1])).max(axis=1) / scale[0]
    limit = np.repeat(stillness.hand, 3)[:len(scale)]
    return ((np.sqrt(windows.variance) / scale <= limit).all(axis=1)
            & (wander <= stillness.hand_wander) & ~windows.unusual())


def _means(capture, first, n):
    """Seven means, counts: exact sums over the number of samples; 0 for what there is not."""
    some = slice(first, first + n)
    sums = [*capture.accel[some].sum(axis=0, dtype=np.int64).tolist()]
    sums += capture.gyro[some].sum(axis=0, dtype=np.int64).tolist() \
        if capture.gyro is not None else [0] * 3
    sums.append(int(capture.temp[some].sum(dtype=np.int64)) if capture.temp is not None else 0)
    return tuple(each / n for each in sums) if n else (0.0,) * 7


def _most_common(sentences):
    """The reason most windows gave, with the numbers of its first window."""
    kinds = [one.split(" (")[0] for one in sentences]
    if not kinds:
        return ""
    kind = max(kinds, key=kinds.count)
    return sentences[kinds.index(kind)]
