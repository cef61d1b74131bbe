"""While samples are streamed: is the corrected reading at rest still as long as gravity?

The rest at power-up says so once, with the same limits (sixflip/record/still_valid.py); a register
that strays or a sensor that is knocked later is seen here. Sample by sample only the window's
integers are summed.
"""

from sixflip.poses.still_window import StillWindow, window_length
from sixflip.record.still_valid import GOOD_MG, NOISE_TIMES

WINDOWS = 20  # still ones in a row, 5 s: nothing that drives speeds up evenly for so long
NOISE_G = 0.005  # of a record that does not know its noise; most sensors have half of it or less
TURN_RADPS = 0.05  # corrected; a rest's is that of the bias since power-up, below 0.02


class GravityWatch:
    """step(dt_us, sample) with every sample; a "gravity" event says once that |a| is off, and
    again only after a rest in which it was right, or with another record."""

    def __init__(self, firmware):
        imu = firmware.sensor.imu
        rate_hz = firmware.settings["rate_hz"]
        self._firmware = firmware
        self._imu = imu
        self._window = StillWindow(window_length(rate_hz, rate_hz), imu.accel_rail,
                                   imu.gyro_rail, 1000000 // rate_hz)
        self._record = None
        self._said = False
        self._rest_begins()

    def _rest_begins(self):
        self._n = 0
        self._sum_mg = 0.0

    def step(self, dt_us, sample):
        """One sample, dt_us after the one before."""
        if self._window.add(dt_us, sample):
            self._look()

    def _look(self):
        firmware = self._firmware
        if firmware.record is not self._record:
            self._record = firmware.record
            self._said = False
            self._rest_begins()
        error_mg = None if firmware.record is None else self._error_mg()
        if error_mg is None:
            self._rest_begins()
            return
        self._n += 1
        self._sum_mg += error_mg
        if self._n < WINDOWS:
            return
        error_mg = self._sum_mg / self._n
        off = abs(error_mg) > GOOD_MG
        if off and not self._said:
            firmware.events.emit("gravity", a_error_mg=error_mg, limit_mg=GOOD_MG)
        self._said = off
        self._rest_begins()

    def _error_mg(self):
        """By how much |a| of the window is off g; None when it is no rest."""
        firmware, window = self._firmware, self._window
        noise_g = firmware.record.accel["noise_g"] or NOISE_G
        noise = NOISE_TIMES * noise_g * self._imu.accel_lsb_per_g
        if window.jumped or max([window.variance(k) for k in range(3)]) > noise * noise:
            return None
        means = [window.mean(k) for k in range(6)]
        means.append(window.total(6) / window.n)
        out = firmware.correction.apply(means, [0.0] * 6)
        if self._imu.has_gyro and max([abs(x) for x in out[3:]]) > TURN_RADPS:
            return None
        length = (out[0] * out[0] + out[1] * out[1] + out[2] * out[2]) ** 0.5
        return (length / firmware.settings["g"] - 1) * 1000
