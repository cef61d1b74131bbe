"""The effect put back as one numpy class that needs nothing else."""
import numpy as np

from . import put_back

CLASS = '''import numpy as np


class ImuModel:
    """The real sensor behind an ideal one. step() takes the simulator's specific force (m/s2)
    and turn rate (rad/s) in the sensor's axes, the temperature (degC) and the time since the
    last step (s), and returns what the sensor reads."""

    ACCEL_MATRIX = np.array(%(accel_matrix)s)
    ACCEL_BIAS = np.array(%(accel_bias)s)  # m/s2
    GYRO_MATRIX = np.array(%(gyro_matrix)s)
    GYRO_BIAS = np.array(%(gyro_bias)s)  # rad/s
    ACCEL_NOISE = np.array(%(accel_noise)s)  # m/s2 per root Hz
    GYRO_NOISE = np.array(%(gyro_noise)s)  # rad/s per root Hz
    ACCEL_STEP = np.array(%(accel_step)s)  # m/s2, 0: none
    GYRO_STEP = np.array(%(gyro_step)s)  # rad/s, 0: none
    ACCEL_RANGE = np.array(%(accel_limit)s)  # m/s2
    GYRO_RANGE = np.array(%(gyro_limit)s)  # rad/s
    ACCEL_DELAY, GYRO_DELAY = %(accel_delay)r, %(gyro_delay)r  # s
    ACCEL_LAG, GYRO_LAG = %(accel_lag)r, %(gyro_lag)r  # s, time constants of low-passes
    LEVER_ARM = np.array(%(lever)s)  # m, from the simulator's point to the sensor
    G_SENSITIVITY = np.array(%(coupling)s)  # rad/s per g
    THERMAL_ACCEL = np.array(%(accel_thermal_bias)s)  # m/s2 per degC
    THERMAL_GYRO = np.array(%(gyro_thermal_bias)s)  # rad/s per degC
    THERMAL_ACCEL_SCALE = np.array(%(accel_thermal_scale)s)  # 1 per degC
    THERMAL_GYRO_SCALE = np.array(%(gyro_thermal_scale)s)  # 1 per degC
    QUADRATIC = np.array(%(accel_quadratic)s)  # m/s2 per g2
    CUBIC = np.array(%(accel_cubic)s)  # m/s2 per g3
    ASYMMETRY = np.array(%(accel_asymmetry)s)  # m/s2 per g
    REFERENCE_C = %(reference_c)r
    G = 9.80665

    def __init__(self, seed=0):
        self.random = np.random.default_rng(seed)
        self.time = 0.0
        self.past = []
        self.rate = None
        self.smooth = None

    def step(self, force, rate, temperature=REFERENCE_C, dt=%(dt)r):
        """(force, rate), two arrays (3,), as the real sensor reads them."""
        force, rate = np.asarray(force, float), np.asarray(rate, float)
        before = rate if self.rate is None else self.rate
        self.rate = rate
        turning = (rate - before) / dt
        force = force + np.cross(turning, self.LEVER_ARM) + np.cross(
            rate, np.cross(rate, self.LEVER_ARM))
        warm, g = temperature - self.REFERENCE_C, force / self.G
        accel = self.ACCEL_MATRIX @ force * (1.0 + self.THERMAL_ACCEL_SCALE * warm) \\
            + self.ACCEL_BIAS + self.THERMAL_ACCEL * warm + self.QUADRATIC * g ** 2 \\
            + self.CUBIC * g ** 3 + self.ASYMMETRY * np.abs(g)
        gyro = self.GYRO_MATRIX @ rate * (1.0 + self.THERMAL_GYRO_SCALE * warm) \\
            + self.GYRO_BIAS + self.THERMAL_GYRO * warm + self.G_SENSITIVITY @ g
        accel, gyro = self._late(accel, gyro, dt)
        accel = accel + self.ACCEL_NOISE / np.sqrt(dt) * self.random.normal(size=3)
        gyro = gyro + self.GYRO_NOISE / np.sqrt(dt) * self.random.normal(size=3)
        return (self._read(accel, self.ACCEL_STEP, self.ACCEL_RANGE),
                self._read(gyro, self.GYRO_STEP, self.GYRO_RANGE))

    def _late(self, accel, gyro, dt):
        """Low-passes and delays. A pole that acts on samples scatters a moment over as much time
        as one of that time constant where (LAG / dt)**2 = keep / (1 - keep)**2, and is less late:
        the rest of LAG is delay."""
        now = np.concatenate([accel, gyro])
        if self.smooth is None:
            self.smooth = now
        wide = (np.array([self.ACCEL_LAG, self.GYRO_LAG]) / dt) ** 2
        keep = 2.0 * wide / (2.0 * wide + 1.0 + np.sqrt(4.0 * wide + 1.0))
        late = np.array([self.ACCEL_DELAY, self.GYRO_DELAY]) + np.array(
            [self.ACCEL_LAG, self.GYRO_LAG]) * (1.0 - np.sqrt(keep))
        keep = np.repeat(keep, 3)
        self.smooth = keep * self.smooth + (1.0 - keep) * now
        self.time += dt
        self.past.append((self.time, self.smooth))
        while len(self.past) > 2 and self.past[1][0] < self.time - late.max() - 2.0 * dt:
            self.past.pop(0)
        times = [t for t, _ in self.past]
        values = np.array([v for _, v in self.past])
        return tuple(np.array([np.interp(self.time - delay, times, values[:, i])
                               for i in range(first, first + 3)])
                     for delay, first in zip(late, (0, 3)))

    @staticmethod
    def _read(values, step, limit):
        """Range and steps."""
        values = np.clip(values, -limit, limit)
        coarse = step > 0
        values[coarse] = np.round(values[coarse] / step[coarse]) * step[coarse]
        return values
'''


def text(found):
    """The module of a PutBack."""
    values = {"lever": array(found.lever), "coupling": array(found.coupling),
              "reference_c": found.reference_c, "dt": 1.0 / found.rate_hz}
    for kind, triad in (("accel", found.accel), ("gyro", found.gyro)):
        for name in ("matrix", "bias", "noise", "step"):
            values["%s_%s" % (kind, name)] = array(getattr(triad, name))
        values[kind + "_limit"] = array(triad.limit)
        values[kind + "_delay"], values[kind + "_lag"] = triad.delay_s, triad.lag_s
        for name in put_back.EFFECTS:
            values["%s_%s" % (kind, name)] = array(triad.effects.get(name, np.zeros(3)))
    return put_back.header(found, "#", ()) + CLASS % values


def array(values):
    """A nested list as text, infinity as numpy's."""
    if np.ndim(values) == 2:
        return "[%s]" % ", ".join(array(row) for row in values)
    return "[%s]" % ", ".join("np.inf" if np.isinf(x) else "%.9g" % x for x in values)
