"""A few seconds at rest: gyro bias, |a| and temperature, with a check that a kick cannot fool.

The last windows must be even in noise and must not wander, window by window and third by third,
and they must be so many that a turn of RATE_DPS would have shown in gravity's direction. The
limits are far below what would move the bias by 0.05 deg/s. The number of windows is such that
chance alone stays at a third of the limits: a quiet sensor is done in 2 s, a noisy one needs
longer, and one that would need more than LONGEST_S is called noisy.

A steady turn about the vertical does not show in gravity's direction and looks like gyro bias.
Along the vertical a change of the bias is therefore believed as far as switching on and ageing
(SWITCHED_ON_DPS) and temperature explain it; without a stored bias, as far as the data sheet's
zero-rate output goes. Across the vertical it may have changed by any amount.
"""

import math
from array import array

from sixflip.poses.noise_floor import CAP
from sixflip.poses.still_window import StillWindow, window_length

from ..sensor import pacer

SWITCHED_ON_DPS = 1.0  # by which a bias changes from one switching-on to the next
UNKNOWN_TEMPERATURE_C = 15.0  # taken for the change of temperature of a sensor that has none
ANY_DPS = 40.0  # the largest zero-rate output of a data sheet (ITG-3205 rev. 1.0, table 3.1)
RATE_DPS = 0.03    # turn of gravity's direction
CHANGE_DPS = 0.04  # of the gyro from one third of the rest to another
ALLOW = (1.0, 0.02)  # mg, deg/s: a window's mean against all, beyond SIGMAS
SIGMAS = 4.0
EVEN = 3.5         # times the mean variance: so far chance does not take a window
FEWEST = 4         # windows before anything is said of the noise
SHORTEST_S = 2.0
LONGEST_S = 12.0


class QuietRun:
    """look(window) -> "" when the windows so far are a rest, else what is missing.

    totals   per window seven sums of counts, oldest first; most: windows that may be needed
    """

    def __init__(self, accel_lsb_per_g, gyro_lsb_per_dps, rate_hz):
        self.lsb = (accel_lsb_per_g / 1000, gyro_lsb_per_dps)  # counts per mg, per deg/s
        self.axes = 6 if gyro_lsb_per_dps else 3
        self.rate_hz = rate_hz
        self.length = 1
        self.most = 3
        self._forget()

    def _forget(self):
        self.totals = []
        self.variances = []

    def look(self, window):
        """Takes a full StillWindow; "" when the windows so far are a rest, or why not."""
        self.length = window.length
        self.most = int(LONGEST_S * self.rate_hz / window.length) + 3
        if window.accel_saturated or window.gyro_saturated or window.stale or window.jumped:
            self._forget()
            return ("stale" if window.stale else "moving" if window.jumped else "saturated")
        self.totals.append(array("i", [window.total(k) for k in range(7)]))
        self.variances.append(array("f", [
            max(window.variance(i), window.step(i // 3) * window.step(i // 3) / 12)
            for i in range(self.axes)]))
        sd = self._sd()
        for i in range(self.axes):
            if sd[i] > CAP[i // 3] * self.lsb[i // 3]:
                self._forget()
                return "noisy: %.1f %s, limit %.1f" % (
                    sd[i] / self.lsb[i // 3], ("mg", "deg/s")[i // 3], CAP[i // 3])
        if len(self.totals) > 1 and self._broken(sd):
            self.totals = self.totals[-1:]
            self.variances = self.variances[-1:]
            return "moving"
        if len(self.totals) < FEWEST:
            return "moving"
        needed = self._needed(sd)
        if needed > self.most:
            self._drop(self.most)
            return "noisy: the bias would need %.0f s of rest" % (
                needed * self.length / self.rate_hz)
        self._drop(needed)
        if len(self.totals) < needed:
            return "moving"
        return "moving" if self._uneven(sd) or self._wanders() else ""

    def _drop(self, keep):
        self.totals = self.totals[-keep:]
        self.variances = self.variances[-keep:]

    def _sd(self):
        n = len(self.variances)
        return [math.sqrt(sum([v[i] for v in self.variances]) / n) for i in range(self.axes)]

    def _mean(self, i, first, end):
        return sum([t[i] for t in self.totals[first:end]]) / ((end - first) * self.length)

    def _limit(self, i, sd, share):
        return ALLOW[i // 3] * self.lsb[i // 3] + SIGMAS * sd[i] * math.sqrt(share / self.length)

    def _broken(self, sd):
        """The newest window does not go on where the one before it was: a kick, a start."""
        for i in range(self.axes):
            step = (self.totals[-1][i] - self.totals[-2][i]) / self.length
            if abs(step) > self._limit(i, sd, 2.0):
                return True
        return False

    def _needed(self, sd):
        """Windows, a multiple of three. Thirds lie 2/3 T apart and have N/3 samples each."""
        seconds = SHORTEST_S
        mg = max(sd[:3]) / self.lsb[0]
        shown = math.radians(RATE_DPS) * 1000  # mg/s
        chance = 3 * mg * math.sqrt(6.0 / self.rate_hz) * 1.5 / shown
        seconds = max(seconds, math.exp(math.log(chance) / 1.5))
        if self.axes == 6:
            dps = max(sd[3:]) / self.lsb[1]
            seconds = max(seconds, 6 * (3 * dps / CHANGE_DPS) ** 2 / self.rate_hz)
        return 3 * (int(seconds * self.rate_hz / self.length / 3) + 1)

    def _uneven(self, sd):
        n = len(self.totals)
        for i in range(self.axes):
            mean = self._mean(i, 0, n)
            limit = self._limit(i, sd, 1.0)
            most = EVEN * sd[i] * sd[i]
            for k in range(n):
                if self.variances[k][i] > most or \
                        abs(self.totals[k][i] / self.length - mean) > limit:
                    return True
        return False

    def _wanders(self):
        n = len(self.totals)
        third = n // 3
        shown = math.radians(RATE_DPS) * 1000 * 2 * third * self.length / self.rate_hz  # mg
        for i in range(self.axes):
            means = [self._mean(i, k, k + third) for k in (0, third, 2 * third)]
            limit = CHANGE_DPS if i >= 3 else shown
            if max(means) - min(means) > limit * self.lsb[i // 3]:
                return True
        return False

    def found(self):
        """(number of samples, seven mean counts, six standard deviations) of the rest."""
        n = len(self.totals)
        return (n * self.length, [self._mean(k, 0, n) for k in range(7)],
                self._sd() + [0.0] * (6 - self.axes))


class Rest:
    """What watch() found; the numbers are counts of n samples.

    still       the board was at rest; reason: "" or why not
    means       seven, ax ay az gx gy gz temp; noise: six standard deviations
    unseen_dps  a turn about the vertical that is slower would pass for bias; None without a gyro
    """

    def __init__(self, reason, n=0, means=(0.0,) * 7, noise=(0.0,) * 6, unseen_dps=None):
        self.still = not reason
        self.reason = reason
        self.n = n
        self.means = means
        self.noise = noise
        self.unseen_dps = unseen_dps


def bias_dps(means, imu):
    """The gyro's mean counts as deg/s, three."""
    return [means[3 + k] / imu.gyro_lsb_per_dps for k in range(3)]


def bias_plausibility(means, imu, stored):
    """("" or why the gyro's mean at rest is a turn and no bias, how slow a turn would not show).

    stored: a record's gyro_bias, {"bias_dps", "temp_c"}, or None; the turn in deg/s
    """
    bias = bias_dps(means, imu)
    for x in bias:
        if abs(x) > ANY_DPS:
            return "turning: %.0f deg/s are no bias" % x, None
    if stored is None:
        return "", imu.zero_rate_dps
    warmer = UNKNOWN_TEMPERATURE_C
    if imu.has_temp and stored["temp_c"] is not None:
        warmer = abs(means[6] / imu.temp_lsb_per_c + imu.temp_offset_c - stored["temp_c"])
    limit = SWITCHED_ON_DPS + imu.zero_rate_dps_per_c * warmer
    up = means[:3]
    size = sum([x * x for x in up]) ** 0.5
    change = sum([(bias[k] - stored["bias_dps"][k]) * up[k] for k in range(3)]) / size
    if abs(change) <= limit:
        return "", limit
    return ("turning about the vertical, or the gyro's bias has jumped: by %.1f deg/s, "
            "limit %.1f" % (change, limit)), limit


def watch(board, sensor, rate_hz, longest_s, stored=None, poll=None):
    """Waits up to longest_s for rest -> Rest; longer while what it saw last was a rest.

    stored: a record's gyro_bias, {"bias_dps", "temp_c"}, or None. poll() -> True ends the
    wait (the host asked).
    """
    imu = sensor.imu
    window = StillWindow(window_length(rate_hz, rate_hz), imu.accel_rail, imu.gyro_rail,
                         1000000 // rate_hz)
    quiet = QuietRun(imu.accel_lsb_per_g, imu.gyro_lsb_per_dps, rate_hz)
    paced = pacer(board, sensor, rate_hz)
    sample = array("h", [0] * 7)
    longest = int(longest_s * rate_hz / window.length)
    seen = 0
    reason = "not waited for (rest_s is %s)" % longest_s
    while seen < longest or 1 < len(quiet.totals) and seen < longest + quiet.most:
        full = False
        while not full:
            dt = paced.next(sample)
            if dt >= 0:
                full = window.add(dt, sample)
        seen += 1
        reason = quiet.look(window)
        if not reason:
            n, means, noise = quiet.found()
            unseen_dps = None
            if imu.has_gyro:
                reason, unseen_dps = bias_plausibility(means, imu, stored)
            return Rest(reason, n, means, noise, unseen_dps)
        if poll is not None and poll():
            return Rest("interrupted")
    return Rest(reason)
