"""Sums of raw counts over a short window: small integers only, nothing allocated per sample.

Squares are of deviations from the window's first sample, so that 64 of them stay below 2**30,
where the small integers of 32-bit boards end; a deviation beyond SPAN is motion at once and
is clamped. The plain sums stay exact.
"""

from sixflip.poses.placement import LATE_US

SPAN = 4096
MOST = 64  # samples in a window: MOST * SPAN**2 = 2**30, and equal deviations never all reach it
SAME = 32  # readings of a triple identical so many times over: the chip is stuck


class StillWindow:
    """Window of `length` samples; add() answers True when it is full, then read it.

    s, q        deviations and their squares summed, per axis ax ay az gx gy gz
    us          elapsed microseconds; late: as of a sixflip.poses.placement.Move
    accel_rail, gyro_rail  |count| at or beyond: saturated; gyro_rail 0: there is no gyro
    """

    def __init__(self, length, accel_rail, gyro_rail, period_us):
        if not 4 <= length < MOST:
            raise ValueError("a window has 4 to %d samples, not %d" % (MOST - 1, length))
        self.length = length
        self.accel_rail = accel_rail
        self.gyro_rail = gyro_rail
        self.period_us = period_us
        self.n = 0
        self.s = [0] * 6
        self.q = [0] * 6
        self.ref = [0] * 6
        self.last = [0] * 6
        self.bits = [0, 0]  # every bit ever seen set, accelerometer and gyro: shows the step
        self.same = [1, 1]  # identical readings so far, accelerometer and gyro
        self.late = [0] * 4
        self.clear()

    def clear(self):
        """Begins a new window."""
        for i in range(6):
            self.s[i] = 0
            self.q[i] = 0
        self.n = 0
        self.temp = 0
        self.us = 0
        for i in range(4):
            self.late[i] = 0
        self.largest_gap_us = 0
        self.jumped = False
        self.accel_saturated = 0
        self.gyro_saturated = 0
        self.stale = 0

    def add(self, dt_us, sample):
        """Take one sample (ax ay az gx gy gz temp, counts), dt_us after the one before."""
        if self.n == self.length:
            self.clear()
        if self.n == 0:
            for i in range(6):
                self.ref[i] = sample[i]
        self.n += 1
        self.us += dt_us
        if dt_us > self.largest_gap_us:
            self.largest_gap_us = dt_us
        off = dt_us - self.period_us
        if abs(off) > self.period_us // 4:
            off //= LATE_US
            for i in range(3):
                self.late[i] += (self.last[3 + i] + sample[3 + i]) * off
            self.late[3] += off
        self.temp += sample[6]
        peak = self._triple(sample, 0, self.accel_rail)
        if peak:
            self.accel_saturated = peak
        if self.gyro_rail:
            peak = self._triple(sample, 1, self.gyro_rail)
            if peak:
                self.gyro_saturated = peak
        return self.n == self.length

    def _triple(self, sample, sensor, rail):
        """Sums accelerometer (sensor 0) or gyro (1); a saturated count, or 0."""
        s = self.s
        last = self.last
        same = True
        peak = 0
        for i in range(3 * sensor, 3 * sensor + 3):
            v = sample[i]
            if v != last[i]:
                last[i] = v
                same = False
            if v >= rail or v <= -rail:
                peak = v
            self.bits[sensor] |= v
            d = v - self.ref[i]
            s[i] += d
            if d > SPAN or d < -SPAN:
                self.jumped = True
                d = SPAN
            self.q[i] += d * d
        if not same:
            self.same[sensor] = 1
        elif self.same[sensor] < SAME:
            self.same[sensor] += 1
        if self.same[sensor] >= SAME:
            self.stale = SAME
        return peak

    def total(self, i):
        """Exact sum of the raw counts of axis i (6: temperature) over the window."""
        if i == 6:
            return self.temp
        return self.s[i] + self.n * self.ref[i]

    def mean(self, i):
        """Mean of an axis (0..5) in counts."""
        return self.ref[i] + self.s[i] / self.n

    def spread(self, i):
        """n times the sum of squared deviations from the mean: an exact integer, of a window
        that has not jumped; of one that has, whose squares are clamped, 0 at least."""
        return max(0, self.n * self.q[i] - self.s[i] * self.s[i])

    def variance(self, i):
        """Counts squared, unbiased."""
        return self.spread(i) / (self.n * (self.n - 1))

    def step(self, sensor):
        """The step of the counts (1, 2, 4 ...) of accelerometer (0) or gyro (1): some chips
        deliver multiples of 4 only."""
        bits = self.bits[sensor]
        if bits == 0:
            return 1
        return bits & -bits


def window_length(rate_hz, samples):
    """Samples in a window of about 0.25 s of which a whole number makes `samples` or more."""
    target = min(MOST - 1, max(12, rate_hz * 0.25))  # fewer make a poor variance
    windows = max(1, int(samples / target + 0.5))
    if samples > windows * (MOST - 1):
        windows += 1
    return max(12, -(-samples // windows))
