"""The chip's temperature over a capture: smoothed, with its rate, and as a part feels it that
follows the thermometer with a lag."""
from dataclasses import dataclass

import numpy as np

STEP_S = 1.0  # a chip's temperature follows its surroundings over tens of seconds
SMOOTH_S = 8.0  # shorter than that, averaged over the steps of the thermometer
RATE_S = 40.0  # a rate is a difference, whose noise falls with this to the power 1.5
# degC that the temperature has to move over a whole capture to say anything: at 0.9 mg/degC (GAP,
# MPU6050 Z) less is below half of what a hand scatters a pose by (0.05 deg, 0.87 mg).
MOVES_C = 0.4


@dataclass(frozen=True, eq=False)
class Thermometer:
    """The temperature c (n,) degC at times t (n,) s, one each STEP_S, its rate (n,) degC/s and
    range_c: its lowest and its highest, degC."""

    t: np.ndarray
    c: np.ndarray
    rate: np.ndarray
    range_c: tuple

    def at(self, t):
        """degC at times t."""
        return np.interp(t, self.t, self.c)

    def rate_at(self, t):
        """degC/s at times t."""
        return np.interp(t, self.t, self.rate)

    def lagged(self, t, lag_s):
        """What a part sees that follows the thermometer with a lag (s); a negative lag: the
        thermometer follows the part, to first order."""
        if lag_s <= 0.0:
            return np.interp(t, self.t, self.c - lag_s * self.rate)
        return np.interp(t, self.t, _follow(self.c, lag_s))

    def lagged_rate(self, t, lag_s):
        """Rate of what `lagged` returns."""
        if lag_s > 0.0:  # what follows begins where the thermometer does: its rate with 0
            return np.interp(t, self.t, (self.c - _follow(self.c, lag_s)) / lag_s)
        bend = np.gradient(_smooth(self.rate, RATE_S), STEP_S) if len(self.c) > 2 else 0.0
        return np.interp(t, self.t, self.rate - lag_s * bend)


def _follow(values, lag_s):
    """One a second, after a first-order lag (s)."""
    felt = np.empty_like(values)
    felt[0] = values[0]
    share = 1.0 - np.exp(-STEP_S / lag_s)
    for i in range(1, len(felt)):
        felt[i] = felt[i - 1] + share * (values[i] - felt[i - 1])
    return felt


def moved_c(sessions):
    """degC between the lowest and the highest temperature of all Sessions, nil where one of them
    has no thermometer."""
    if any(s.thermometer is None for s in sessions):
        return 0.0
    return float(np.ptp([end for s in sessions for end in s.thermometer.range_c]))


def of_course(t, c):
    """Thermometer of temperatures c (n,) degC that are smooth already, at times t (n,) s that are
    STEP_S apart."""
    rate = np.gradient(_smooth(c, RATE_S), STEP_S) if len(c) > 2 else np.zeros(len(c))
    return Thermometer(t, c, rate, (float(c.min()), float(c.max())))


def of_capture(capture, t_s):
    """Thermometer of a capture whose samples were taken at t_s (N,) s, or None where it has no
    column of temperatures or lasts for less than three seconds."""
    if capture.temp is None:
        return None
    meta = capture.meta
    celsius = capture.temp / meta["temp_lsb_per_c"] + meta["temp_offset_c"]
    edges = np.arange(0.0, t_s[-1] + STEP_S, STEP_S)
    where = np.searchsorted(t_s, edges)
    sums = np.concatenate([[0.0], np.cumsum(celsius)])
    number = np.diff(where)
    filled = number > 0
    mean = (sums[where[1:]] - sums[where[:-1]])[filled] / number[filled]
    t = (edges[:-1] + 0.5 * STEP_S)[filled]
    if len(t) < 3:
        return None
    grid = np.arange(t[0], t[-1] + 0.5 * STEP_S, STEP_S)
    return of_course(grid, _smooth(np.interp(grid, t, mean), SMOOTH_S))


def _smooth(values, seconds):
    """Running straight-line fit over so many seconds: level without lag, also at the ends."""
    half = max(1, int(seconds / STEP_S / 2))
    if len(values) < 2 * half + 1:
        return values.copy()
    width = 2 * half + 1
    smooth = np.empty(len(values))
    # In the middle of a line lies its mean.
    smooth[half:-half] = np.convolve(values, np.full(width, 1.0 / width), "valid")
    u = np.arange(width)
    smooth[:half] = np.polyval(np.polyfit(u, values[:width], 1), u[:half])
    smooth[-half:] = np.polyval(np.polyfit(u, values[-width:], 1), u[-half:])
    return smooth
