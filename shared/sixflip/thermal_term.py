"""One term that follows the chip's temperature."""


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
        return count / self.lsb + self.offset

    def _distance(self, t):
        return min(max(t, self.low), self.high) - self.t0

    def count_from(self, t):
        d = self._distance(t)
        for j in range(3):
            self.base[j] = self._nominal - (self.k1[j] + self.k2[j] * d) * d

    def at_rest(self, count):
        if self._is_gyro_bias:
            self.count_from(self.celsius(count))

    def fill(self, t):
        d = self._distance(t)
        for j in range(3):
            self.into[self.first + j] = self.base[j] + (self.k1[j] + self.k2[j] * d) * d
