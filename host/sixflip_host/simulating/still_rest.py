"""The longest rest of a recording, by the board's still windows, or the reason there is none.

For what is measured at rest and no session: mounting, and whether a calibration still holds.
"""

import math

import numpy as np

from sixflip.noise_floor import ENTER, LEAVE, WINDOWS, NoiseFloor
from sixflip.still_window import StillWindow, window_length

INT16_RAIL = 32767
POSE_SAMPLES = 400      # sets the length of a window as on the board, a quarter of a second
MOSTLY = 0.5            # of the recording: a shorter rest is a pause of something that moves


class Rest:
    """n samples from index first on.

    means   seven: counts of ax ay az gx gy gz temp; noise: six standard deviations, counts
    reason  "" or why the recording is no rest, one sentence; then the rest is a fragment
    """

    def __init__(self):
        self.first = self.n = 0
        self.means = [0.0] * 7
        self.noise = [0.0] * 6
        self.reason = ""


def find(capture):
    """The Rest of a capture.Capture."""
    windows = _windows(capture)
    lsb = (capture.meta["accel_lsb_per_g"],
           capture.meta["gyro_lsb_per_dps"] if capture.gyro is not None else 0)
    rest = Rest()
    if len(windows) < WINDOWS:
        rate = capture.meta["rate_hz"]
        rest.reason = "%.1f s are too short, %.1f s of rest are needed" % (
            len(capture) / rate, WINDOWS * window_length(rate, POSE_SAMPLES) / rate)
        return rest
    floor, against = _learnt(windows, lsb)
    if not floor.known:
        rest.reason = _most_common(against) or "it moves: the windows differ too much for rest"
        return rest
    start, end, against = _longest_still(windows, floor)
    if end - start < MOSTLY * len(windows):
        rest.reason = "still for %d %% of the recording only: %s" % (
            100 * (end - start) // len(windows), _most_common(against))
    _average(rest, capture, windows[start:end])
    rest.first = start * windows[0].length
    rest.noise = list(floor.sd)
    return rest


def _windows(capture):
    """The recording as full windows, every one a StillWindow of its own."""
    rate = capture.meta["rate_hz"]
    length = window_length(rate, POSE_SAMPLES)
    rail = int(min(INT16_RAIL, capture.meta.get("accel_range_g", np.inf)
                   * capture.meta["accel_lsb_per_g"] - 1))
    gyro = capture.gyro if capture.gyro is not None else np.zeros((len(capture), 3), int)
    temp = capture.temp if capture.temp is not None else np.zeros(len(capture), int)
    samples = np.column_stack([capture.accel, gyro, temp]).tolist()
    intervals = np.diff(capture.t_us, prepend=capture.t_us[:1]).tolist()
    out = []
    for start in range(0, len(samples) - length + 1, length):
        window = StillWindow(length, rail, INT16_RAIL if capture.gyro is not None else 0,
                             int(1e6 / rate + 0.5))
        if out:     # the board has one window only: what hangs, hangs across their borders
            window.last, window.same = list(out[-1].last), list(out[-1].same)
            window.bits = list(out[-1].bits)
        for k in range(start, start + length):
            window.add(intervals[k], samples[k])
        out.append(window)
    return out


def _sentence(floor):
    """Why a window is not still, with the number and its limit."""
    words = {"saturated": "full scale is touched", "stale": "the readings do not change"}
    text = words.get(floor.reason) or {
        "noisy": "it shakes", "moving": "it moves"}.get(floor.reason, floor.reason)
    form = "%d" if floor.unit in ("counts", "readings") else "%.3g"
    return "%s (%s %s, limit %s)" % (text, form % floor.value, floor.unit, form % floor.limit)


def _learnt(windows, lsb):
    """(NoiseFloor, sentences against rest)."""
    floor, against = NoiseFloor(*lsb), []
    for window in windows:
        floor.look(window)
        if floor.reason:
            against.append(_sentence(floor))
    return floor, against


def _longest_still(windows, floor):
    """(start, end, sentences): the longest run of windows that are still."""
    best, start, against, still = (0, 0), 0, [], False
    for k, window in enumerate(windows):
        floor.look(window)
        if k == 0:      # nothing before it to wander from
            floor.look(window)
        still = not floor.judge(window, LEAVE if still else ENTER)
        if not still:
            against.append(_sentence(floor))
            start = k + 1
        elif k + 1 - start > best[1] - best[0]:
            best = start, k + 1
    return best[0], best[1], against


def _most_common(sentences):
    """The reason most windows gave, with the numbers of its first window."""
    kinds = [one.split(" (")[0] for one in sentences]
    if not kinds:
        return ""
    kind = max(kinds, key=kinds.count)
    return sentences[kinds.index(kind)]


def _average(rest, capture, windows):
    rest.n = sum(w.n for w in windows)
    if rest.n:
        rest.means = [sum(w.total(i) for w in windows) / rest.n for i in range(7)]


def noise_mg(rest, lsb_per_g):
    """Root mean square of the three axes' noise, mg; and that of the noisiest one."""
    noise = [1e3 / lsb_per_g * x for x in rest.noise[:3]]
    return math.sqrt(sum(x * x for x in noise) / 3), max(noise)
