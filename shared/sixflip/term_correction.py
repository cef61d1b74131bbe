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
from sixflip.record_terms import terms


class TermCorrection(Correction):
    """tell(temp_c, low_c, high_c) is called once, at the first sample outside of the range."""

    def __init__(self, record, tell=None):
        Correction.__init__(self, record, False)
        self._tell = tell
        self._count = None
        self._shift = [0.0] * 6  # m/s2, rad/s at the temperature of _count
        self._scale = [1.0] * 6
        self._thermal = []
        self._coupling = self._turn = self._range = None
        if record.mounting:
            from sixflip.mounting import compensation
            self._turn = compensation(record.mounting)
        for name, fields in terms(record).items():
            self._take(name, fields)
        self.needs_temperature = bool(self._thermal)

    def _take(self, name, fields):
        record = self.record
        if name == "g_sensitivity":
            columns = [self._rates([row[k] for row in fields["k"]]) for k in range(3)]
            self._coupling = [[column[j] / record.g for column in columns] for j in range(3)]
            return
        first = 3 if name[0] == "g" else 0
        k2 = [0.0] * 3
        if name.endswith("scale"):
            into, nominal = self._scale, 1.0
            k1 = [k / 100.0 for k in fields["k1"]]
        else:
            into, nominal = self._shift, 0.0
            k1, k2 = fields["k1"], fields["k2"]
            if first:
                k1, k2 = self._rates(k1), self._rates(k2)
            else:
                k1 = [k * 1e-3 * record.g for k in k1]
                k2 = [k * 1e-3 * record.g for k in k2]
                self._range = fields["low_c"], fields["high_c"]
        one = _Thermal(first, into, k1, k2, nominal, fields)
        then = record.temp_c
        if first and into is self._shift and record.gyro_bias:
            then = record.gyro_bias["temp_c"]
            then = record.temp_c if then is None else then
        one.from_here(then)
        self._thermal.append(one)

    def _rates(self, dps):
        """rad/s, corrected, that so many deg/s more as read make."""
        M = self.gyro
        lsb = self.record.gyro_lsb_per_dps
        return [sum([dps[i] * lsb * M[i][j] for i in range(3)]) for j in range(3)]

    def covers(self, temp_c):
        return self._range is not None and self._range[0] <= temp_c <= self._range[1]

    def _look(self, count):
        if count == self._count:
            return
        self._count = count
        for one in self._thermal:
            t = one.celsius(count)
            if self._tell and (t < one.low or t > one.high):
                tell, self._tell = self._tell, None
                tell(t, one.low, one.high)
            one.fill(t)

    def apply(self, sample, out):
        """As Correction.apply; sample[6] is the temperature in counts."""
        self._look(sample[6])
        Correction.apply(self, sample, out)
        shift = self._shift
        scale = self._scale
        for j in range(3):
            out[j] = (out[j] - shift[j]) / scale[j]
        G = self._coupling
        for j in range(3):
            rate = out[3 + j] - shift[3 + j]
            if G:
                rate = rate - (G[j][0] * out[0] + G[j][1] * out[1] + G[j][2] * out[2])
            out[3 + j] = rate / scale[3 + j]
        if self._turn:
            for k in (0, 3):
                x = out[k]
                y = out[k + 1]
                z = out[k + 2]
                for j in range(3):
                    row = self._turn[j]
                    out[k + j] = x * row[0] + y * row[1] + z * row[2]
        return out

    def set_rest(self, means):
        Correction.set_rest(self, means)
        for one in self._thermal:
            if one.into is self._shift and one.first:
                one.from_here(one.celsius(means[6]))
        self._count = None
        if self._coupling:
            held, self._turn = self._turn, None
            a = self.apply(means, [0.0] * 6)
            self._turn = held
            for j in range(3):
                # the rest's own gravity is in its bias
                self.gyro[3][j] += sum([self._coupling[j][k] * a[k] for k in range(3)])


class _Thermal:
    """into[first + j] = nominal + p_j(T) - p_j(of the temperature it counts from)."""

    def __init__(self, first, into, k1, k2, nominal, fields):
        self.first = first
        self.into = into
        self._k1 = k1
        self._k2 = k2
        self._nominal = nominal
        self._base = [nominal] * 3
        self._t0 = fields["t0_c"]
        self.low = fields["low_c"]
        self.high = fields["high_c"]
        self._lsb = fields["temp_lsb_per_c"]
        self._offset = fields["temp_offset_c"]

    def celsius(self, count):
        return count / self._lsb + self._offset

    def _distance(self, t):
        return min(max(t, self.low), self.high) - self._t0

    def from_here(self, t):
        d = self._distance(t)
        for j in range(3):
            self._base[j] = self._nominal - (self._k1[j] + self._k2[j] * d) * d

    def fill(self, t):
        d = self._distance(t)
        for j in range(3):
            self.into[self.first + j] = self._base[j] + (self._k1[j] + self._k2[j] * d) * d
