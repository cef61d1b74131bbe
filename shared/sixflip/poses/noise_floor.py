"""The sensor's own noise and gyro bias, learnt at rest, and what they say about a window.

Nothing here is a fixed threshold on motion: a window is compared with the noise of this very
sensor. Two things are fixed, both far from it: the most that can pass for a sensor's noise
(CAP: an ADXL345 has 4 mg, an ITG3205 0.4 deg/s; a hand has more), and what a still sensor's
mean may wander (ALLOW; a bias moves by 0.1 to 0.2 deg/s per g when the box is turned over).
"""

import math
from array import array

from sixflip.poses.still_window import SPAN

CAP = (30.0, 1.0)  # mg, deg/s: standard deviations
ALLOW = (2.0, 0.15)  # mg, deg/s: wander of the mean while still
BIAS_ALLOW = 0.5  # deg/s: gyro mean against the bias, from face to face
ENTER = 2.0  # times the noise: below it a window is still,
LEAVE = 3.0  # and it remains so up to here (hysteresis)
SIGMAS = 5.0  # on the standard error of a mean
WINDOWS = 4  # consecutive quiet windows to learn from
TOO_HIGH = 0.6  # of the noise so far: chance does not take four windows there
EVEN = 6.0  # their variances differ by no more than this factor
UNITS = ("mg", "deg/s")


def _zeros(n):
    """n floats in one piece: as a list each of them would be an object of its own."""
    return array("d", [0.0] * n)


class NoiseFloor:
    """look(window) learns; judge(...) names what is wrong with it.

    sd    six standard deviations in counts (0 before `known`)
    bias  three gyro means in counts, free to move until a pose fixed it (`bias_fixed`)
    reason, value, limit, unit   why the window is not still, "" when it is; or the nearest
    """

    def __init__(self, accel_lsb_per_g, gyro_lsb_per_dps):
        self.lsb = (accel_lsb_per_g / 1000, gyro_lsb_per_dps)  # counts per mg, per deg/s
        self.axes = 6 if gyro_lsb_per_dps else 3
        self.known = False
        self.sd = _zeros(6)
        self.bias = _zeros(3)
        self.bias_fixed = False
        self.mean = _zeros(6)
        self._before = _zeros(6)
        self._var = _zeros(6)
        self._forget()
        self.say("", 0, 0, "")

    def say(self, reason, value, limit, unit):
        """Sets why a window is not still, the measured value, its limit and unit."""
        self.reason = reason
        self.value = value
        self.limit = limit
        self.unit = unit

    def _forget(self):
        self._run = 0
        self._var_sum = _zeros(6)
        self._var_low = _zeros(6)
        self._var_high = _zeros(6)
        self._mean_sum = _zeros(3)

    def look(self, window):
        """Take a window's statistics, say what speaks against rest, learn from quiet ones."""
        for i in range(self.axes):
            self._before[i] = self.mean[i]
            self.mean[i] = window.mean(i)
            step = window.step(i // 3)
            self._var[i] = max(window.variance(i), step * step / 12)
        if not self._fault(window) and self._within_cap() and self._quiet(window.n):
            self._learn()
        else:
            self._forget()

    def _fault(self, window):
        """A window that says nothing about noise; True with the reason said."""
        if window.accel_saturated:
            self.say("saturated", abs(window.accel_saturated), window.accel_rail, "counts")
        elif window.gyro_saturated:
            self.say("saturated", abs(window.gyro_saturated), window.gyro_rail, "counts")
        elif window.stale:
            self.say("stale", window.stale, window.stale, "readings")
        elif window.jumped:
            self.say("moving", SPAN, SPAN, "counts")
        else:
            return False
        return True

    def _within_cap(self):
        for i in range(self.axes):
            limit = CAP[i // 3]
            sd = math.sqrt(self._var[i]) / self.lsb[i // 3]
            if sd > limit:
                if not self.known:
                    self.say("noisy", sd, limit, UNITS[i // 3])
                return False
        if not self.known:
            self.say("", 0, 0, "")
        return True

    def _quiet(self, n):
        """Even among themselves and without wander, whatever the bias may be."""
        if self.known:
            return self._ratio() <= ENTER and self.wander(self._before, 1, n) == ""
        for i in range(self.axes):
            v = self._var[i]
            if self._run == 0:
                self._var_low[i] = self._var_high[i] = v
            self._var_low[i] = min(v, self._var_low[i])
            self._var_high[i] = max(v, self._var_high[i])
            if self._var_high[i] > EVEN * self._var_low[i]:
                even = math.sqrt(self._var_high[i] / self._var_low[i])
                self.say("moving", even, math.sqrt(EVEN), "x noise")
                return False
            self.sd[i] = math.sqrt(v)
        return self._run == 0 or self.wander(self._before, 1, n) == ""

    def _learn(self):
        self._run += 1
        for i in range(self.axes):
            self._var_sum[i] += self._var[i]
            if i >= 3:
                self._mean_sum[i - 3] += self.mean[i]
        if self._run < WINDOWS:
            return
        for i in range(self.axes):
            sd = math.sqrt(self._var_sum[i] / WINDOWS)
            # downward only: what a hand made too large at the start is learnt again at rest
            if not self.known or sd < TOO_HIGH * self.sd[i]:
                self.sd[i] = sd
            if i >= 3 and not self.bias_fixed:
                self.bias[i - 3] = self._mean_sum[i - 3] / WINDOWS
        self.known = True
        self._forget()

    def _ratio(self):
        worst = 0.0
        for i in range(self.axes):
            worst = max(worst, self._var[i] / (self.sd[i] * self.sd[i]))
        return math.sqrt(worst)

    def wander(self, reference, windows, n):
        """"" or "moving": this window's mean against a mean over `windows` of n samples."""
        share = SIGMAS * math.sqrt((1 + 1 / windows) / n)
        for i in range(self.axes):
            lsb = self.lsb[i // 3]
            value = abs(self.mean[i] - reference[i]) / lsb
            limit = ALLOW[i // 3] + share * self.sd[i] / lsb
            if value > limit:
                self.say("moving", value, limit, UNITS[i // 3])
                return "moving"
        return ""

    def judge(self, window, limit):
        """Reason why this window, looked at before, is not still; limit ENTER or LEAVE."""
        if not self._fault(window):
            ratio = self._ratio()
            if ratio > limit:
                still = self.wander(self._before, 1, window.n) == ""
                self.say("noisy" if still else "moving", ratio, limit, "x noise")
            elif self.wander(self._before, 1, window.n) == "" and self._turning() == "":
                self.say("", ratio, limit, "x noise")
        return self.reason

    def _turning(self):
        for i in range(3, self.axes):
            value = abs(self.mean[i] - self.bias[i - 3]) / self.lsb[1]
            limit = BIAS_ALLOW + SIGMAS * self.sd[i] / self.lsb[1] / 5
            if value > limit:
                self.say("moving", value, limit, UNITS[1])
                return "moving"
        return ""
