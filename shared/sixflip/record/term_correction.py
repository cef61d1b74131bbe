"""The correction with the terms of a record: what follows the temperature, and the g-sensitivity.

It runs sample by sample, with floats on the board and on the host with arrays of samples that
have one temperature count. The order is the reverse of that in which the errors come about:

1. P, unit and bias of the record, in the sensor's axes (correction.py)
2. accelerometer: less the thermal bias, then divided by the thermal scale, because a drifting
   offset is not stretched by the scale
3. gyro: less the thermal bias and the g-sensitivity, which takes the specific force of step 2
   (in g of the record), then divided by the thermal scale
4. the mounting turns both

P holds the bias and the scale at the temperature of the calibration, the last rest the gyro's at
its own: terms count from there, so that a calibration or a rest at another temperature leaves
them valid. Outside of the temperatures that a term was measured at, its value at the edge holds.

The numbers of a term stand first in its section of the record, 64 bits each; the host's
record_terms.py has the rest:

    accel_thermal_bias, gyro_thermal_bias     k1 [3], k2 [3], t0_c, low_c, high_c,
                                              temp_lsb_per_c, temp_offset_c
    accel_thermal_scale, gyro_thermal_scale   k1 [3], then likewise
    g_sensitivity                             k [3 x 3], row by row
"""

import struct

from sixflip.record.correction import Correction

TERMS = ((16, "accel_thermal_bias"), (17, "gyro_thermal_bias"), (18, "accel_thermal_scale"),
         (19, "gyro_thermal_scale"), (20, "g_sensitivity"))
# Of a coefficient: beyond it, it is no sensor's. mg and deg/s per degree C, percent, deg/s per g.
_MOST = (100.0, 30.0, 2.0, 2.0, 10.0)


def numbers(record):
    """[(name, [numbers])] of a Record's terms; ValueError, a sentence, when one cannot be."""
    terms = []
    names = dict(TERMS)
    for tag, payload in record.terms:
        name = names[tag]
        if [1 for known, _ in terms if known == name]:
            raise ValueError("section %s is there twice in the record" % name)
        sizes = 6 if tag < 18 else 3 if tag < 20 else 9
        n = sizes if tag == 20 else sizes + 5
        if len(payload) < 8 * n:
            raise ValueError("section %s of the record is too short" % name)
        values = list(struct.unpack_from("<%dd" % n, payload, 0))
        check(name, values, sizes, record)
        terms.append((name, values))
    return terms


def check(name, values, sizes, record):
    """ValueError unless the first `sizes` values are coefficients and the rest a range."""
    most = [limit for limit, (_, known) in zip(_MOST, TERMS) if known == name][0]
    for x in values[:sizes]:
        if not abs(x) <= most:
            raise ValueError("section %s holds %s: expected %s at most" % (name, x, most))
    if name[0] == "g" and not record.gyro_lsb_per_dps:
        raise ValueError("section %s is of a gyro, the %s has none" % (name, record.chip))
    if len(values) == sizes:
        return
    t0, low, high, lsb, offset = values[sizes:]
    if record.chip == "adxl345" or record.temp_c is None:
        raise ValueError("section %s needs the temperature of the calibration: the record has "
                         "none" % name)
    if not (-60.0 <= low < high <= 150.0 and -60.0 <= t0 <= 150.0):
        raise ValueError("section %s is for %s to %s degrees C, about %s: expected a range of a "
                         "chip" % (name, low, high, t0))
    if not (1.0 <= lsb <= 1e5 and abs(offset) <= 1000.0):
        raise ValueError("section %s reads degrees C as counts / %s + %s" % (name, lsb, offset))
    if sizes == 3 and max([abs(k) for k in values[:3]]) * (high - low) > 50.0:
        raise ValueError("section %s changes the scale by more than half" % name)


class ThermalTerm:
    """into[first + j] = nominal + p_j(T) - p_j(of the temperature it counts from), with
    p_j = k1_j d + k2_j d^2 and d = T - T0, T held within low ... high.

    limits: t0_c, low_c, high_c, temp_lsb_per_c, temp_offset_c; is_gyro_bias: a rest measures what
    it is at the time.
    """

    def __init__(self, first, into, k1, k2, nominal, limits, is_gyro_bias):
        self.first = first
        self.into = into
        self.k1 = k1
        self.k2 = k2
        self._nominal = nominal
        self.base = [nominal] * 3
        self.t0, self.low, self.high, self.lsb, self.offset = limits
        self._is_gyro_bias = is_gyro_bias

    def celsius(self, count):
        """Degrees C of a temperature count."""
        return count / self.lsb + self.offset

    def _distance(self, t):
        return min(max(t, self.low), self.high) - self.t0

    def count_from(self, t):
        """The term counts from this temperature in degrees C: there it is nothing."""
        d = self._distance(t)
        for j in range(3):
            self.base[j] = self._nominal - (self.k1[j] + self.k2[j] * d) * d

    def at_rest(self, count):
        """A rest at a temperature count has measured the gyro's bias anew."""
        if self._is_gyro_bias:
            self.count_from(self.celsius(count))

    def fill(self, t):
        """Writes the term at t degrees C into its place."""
        d = self._distance(t)
        for j in range(3):
            self.into[self.first + j] = self.base[j] + (self.k1[j] + self.k2[j] * d) * d


class TermCorrection(Correction):
    """tell(temp_c, low_c, high_c) is called once, at the first sample outside of the range.

    thermal    ThermalTerms; coupling [rate][force], rad/s for 1 m/s2; turn, 3 x 3 of the
               mounting; range_c of the accelerometer's drift; each None or empty where there is
               none (fill())
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
        for term in self.thermal:
            t = term.celsius(count)
            if self._tell and (t < term.low or t > term.high):
                tell, self._tell = self._tell, None
                tell(t, term.low, term.high)
            term.fill(t)

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
        """As Correction.set_rest; the gyro's terms count from this rest."""
        Correction.set_rest(self, means)
        for term in self.thermal:
            term.at_rest(means[6])
        self._count = None
        if self.coupling:
            a = self._in_sensor_axes(means, [0.0] * 6)
            for j in range(3):
                # the rest's own gravity is in its bias
                self.gyro[3][j] += sum([self.coupling[j][k] * a[k] for k in range(3)])


def fill(correction, terms):
    """A TermCorrection with the terms of numbers()."""
    for name, values in terms:
        if name == "g_sensitivity":
            _couple(correction, values)
        elif name.endswith("scale"):
            _stretch(correction, name, values)
        else:
            _drift(correction, name, values)
    if correction.record.mounting:
        from sixflip.record.mounting import compensation
        correction.turn = compensation(correction.record.mounting)


def _couple(correction, k):
    columns = [_rates(correction, k[j::3]) for j in range(3)]
    g = correction.record.g
    correction.coupling = [[column[j] / g for column in columns] for j in range(3)]


def _stretch(correction, name, values):
    term = ThermalTerm(3 if name[0] == "g" else 0, correction.scale,
                       [k / 100.0 for k in values[:3]], [0.0] * 3, 1.0, values[3:], False)
    term.count_from(correction.record.temp_c)
    correction.thermal.append(term)


def _drift(correction, name, values):
    record = correction.record
    then = record.temp_c
    gyro = name[0] == "g"
    if gyro:
        k1, k2 = [_rates(correction, values[i:i + 3]) for i in (0, 3)]
        if record.gyro_bias and record.gyro_bias["temp_c"] is not None:
            then = record.gyro_bias["temp_c"]
    else:
        k1, k2 = [[k * 1e-3 * record.g for k in values[i:i + 3]] for i in (0, 3)]
        correction.range_c = values[7], values[8]
    term = ThermalTerm(3 if gyro else 0, correction.shift, k1, k2, 0.0, values[6:], gyro)
    term.count_from(then)
    correction.thermal.append(term)


def _rates(correction, dps):
    """rad/s, corrected, that so many deg/s more as read make."""
    M = correction.gyro
    lsb = correction.record.gyro_lsb_per_dps
    return [sum([dps[i] * lsb * M[i][j] for i in range(3)]) for j in range(3)]
