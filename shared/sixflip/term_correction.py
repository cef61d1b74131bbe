"""The correction with the terms of a record, sample by sample; floats on the board, and on the
host arrays of samples that have one temperature count.

Order, the reverse of that in which the errors come about:
1. P, unit and bias of the record, in the sensor's axes (correction.py)
2. accelerometer: less the thermal bias, then divided by the thermal scale, because a drifting
   offset is not stretched by the scale
3. gyro: less the thermal bias and the g-sensitivity, which takes the specific force of step 2
   (in g of the record), then divided by the thermal scale
4. the mounting turns both

P holds the bias and the scale at the temperature of the calibration, the last rest the gyro's at
its own: terms count from there, so that a calibration or a rest at another temperature leaves
them valid. Outside of the temperatures a term was measured at, its edge holds.
"""

from sixflip.correction import Correction


class TermCorrection(Correction):
    """tell(temp_c, low_c, high_c) is called once, at the first sample outside of the range.

    thermal    ThermalTerms; coupling [rate][force], rad/s for 1 m/s2; turn, 3 x 3 of the
               mounting; range_c of the accelerometer's drift; each None or empty where there is
               none (term_units.py fills them)
    shift, scale   of the six, in m/s2 and rad/s, at the temperature of the sample before
    """

    def __init__(self, record, tell=None):
        Correction.__init__(self, record, False)
        self._tell = tell
        self._count = None
        self.shift = [0.0] * 6
        self.scale = [1.0] * 6
        self.thermal = []
        self.coupling = self.turn = self.range_c = None

    def _look(self, count):
        if count == self._count:
            return
        self._count = count
        for one in self.thermal:
            t = one.celsius(count)
            if self._tell and (t < one.low or t > one.high):
                tell, self._tell = self._tell, None
                tell(t, one.low, one.high)
            one.fill(t)

    def _in_sensor_axes(self, sample, out):
        self._look(sample[6])
        Correction.apply(self, sample, out)
        shift = self.shift
        scale = self.scale
        for j in range(3):
            out[j] = (out[j] - shift[j]) / scale[j]
        G = self.coupling
        for j in range(3):
            rate = out[3 + j] - shift[3 + j]
            if G:
                rate = rate - (G[j][0] * out[0] + G[j][1] * out[1] + G[j][2] * out[2])
            out[3 + j] = rate / scale[3 + j]
        return out

    def apply(self, sample, out):
        """As Correction.apply; sample[6] is the temperature in counts."""
        self._in_sensor_axes(sample, out)
        if self.turn:
            for k in (0, 3):
                x = out[k]
                y = out[k + 1]
                z = out[k + 2]
                for j in range(3):
                    row = self.turn[j]
                    out[k + j] = x * row[0] + y * row[1] + z * row[2]
        return out

    def set_rest(self, means):
        Correction.set_rest(self, means)
        for one in self.thermal:
            one.at_rest(means[6])
        self._count = None
        if self.coupling:
            a = self._in_sensor_axes(means, [0.0] * 6)
            for j in range(3):
                # the rest's own gravity is in its bias
                self.gyro[3][j] += sum([self.coupling[j][k] * a[k] for k in range(3)])
