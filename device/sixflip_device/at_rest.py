"""A few seconds at rest: gyro bias, |a| and temperature, with a check that a kick cannot fool.

The last windows (quiet_run.py) must be even in noise and must not wander, window by window
and third by third, and they must be so many that a turn of RATE_DPS would have shown in
gravity's direction. A turn about the vertical does not show there: along it the bias is
held against the stored one (turn_or_bias.py).
"""

from array import array

from sixflip.poses.still_window import StillWindow, window_length

from .pacer import pacer
from .quiet_run import QuietRun


class Rest:
    """still False: reason says why; else means (7) and noise (6) in counts of n samples.

    unseen_dps  a turn about the vertical slower than this would pass for bias; None: no gyro
    """

    def __init__(self):
        self.still = False
        self.reason = "moving"
        self.n = 0
        self.means = [0.0] * 7
        self.noise = [0.0] * 6
        self.unseen_dps = None

    def bias_dps(self, imu):
        return [self.means[3 + k] / imu.gyro_lsb_per_dps for k in range(3)]


def watch(board, sensor, rate_hz, longest_s, stored=None, poll=None):
    """Waits up to longest_s for rest -> Rest; longer while what it saw last was a rest.

    stored: a record's gyro_bias, {"bias_dps", "temp_c"}, or None. poll() -> True ends the
    wait (the host asked).
    """
    imu = sensor.imu
    rest = Rest()
    window = StillWindow(window_length(rate_hz, rate_hz), imu.accel_rail, imu.gyro_rail,
                         1000000 // rate_hz)
    quiet = QuietRun(imu.accel_lsb_per_g, imu.gyro_lsb_per_dps, rate_hz)
    paced = pacer(board, sensor, rate_hz)
    sample = array("h", [0] * 7)
    longest = int(longest_s * rate_hz / window.length)
    seen = 0
    while seen < longest or 1 < len(quiet.totals) and seen < longest + quiet.most:
        full = False
        while not full:
            dt = paced.next(sample)
            if dt >= 0:
                full = window.add(dt, sample)
        seen += 1
        rest.reason = quiet.look(window)
        if not rest.reason:
            quiet.result(rest)
            if imu.has_gyro:
                from .turn_or_bias import judge
                judge(rest, imu, stored)
            rest.still = not rest.reason
            return rest
        if poll is not None and poll():
            rest.reason = "interrupted"
            return rest
    if not seen:
        rest.reason = "not waited for (rest_s is %s)" % longest_s
    return rest
