"""The effect put back as one numpy class that needs nothing else.

An effect stands in the class only where it was found: a constant, and what it adds in a step.
"""
import numpy as np

from . import put_back

# (unit of the constant, what is added to the sensor's reading): {0} is the constant, {lag_s},
# {tau_s} and {hz} the effect's own. A step has warm (degC above REFERENCE_C), warming (degC/min),
# g (3,) the specific force in g and turns (3,) the rate in 100 deg/s, the units that the library's
# effects are defined in (sixflip_sim.effects); self.time counts from when it is switched on.
OF_BOTH = {
    "thermal_bias": ("{unit} per degC", "{0} * (warm + {lag_s!r} * warming / 60.0)"),
    "warm_up": ("{unit}", "{0} * np.exp(-self.time / {tau_s!r})"),
    "thermal_rate": ("{unit} per degC/min", "{0} * warming"),
    "vibration": ("{unit}, of any phase",
                  "{0} * np.sin(2.0 * np.pi * np.array({hz}) * self.time)"),
}
EXPRESSIONS = {
    "accel": {**OF_BOTH,
              "thermal_scale": ("1 per degC", "{0} * force * warm"),
              "quadratic": ("{unit} per g2", "{0} * g ** 2"),
              "cubic": ("{unit} per g3", "{0} * g ** 3"),
              "asymmetry": ("{unit} per g", "{0} * np.abs(g)"),
              "cross_quadratic": ("{unit} per g2 of xx, yy, zz, xy, xz, yz",
                                  "{0} @ (g[[0, 1, 2, 0, 0, 1]] * g[[0, 1, 2, 1, 2, 2]])")},
    "gyro": {**OF_BOTH,
             "thermal_scale": ("1 per degC", "{0} * rate * warm"),
             "quadratic": ("{unit} at 100 deg/s", "{0} * turns ** 2"),
             "cubic": ("{unit} at 100 deg/s", "{0} * turns ** 3"),
             "asymmetry": ("1", "{0} * np.abs(rate)"),
             "g_sensitivity": ("{unit} per g", "{0} @ g")},
}
UNITS = {"accel": "m/s2", "gyro": "rad/s"}
# Columns of the effects whose constant is a matrix; the row is the first letter of a key.
COLUMNS = {"cross_quadratic": ("xx", "yy", "zz", "xy", "xz", "yz"), "g_sensitivity": "xyz"}

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
%(constants)s    REFERENCE_C = %(reference_c)r
    SETTLES_S = 10.0  # a thermometer's steps are no warming

    def __init__(self, seed=0):
        self.random = np.random.default_rng(seed)
        self.time = 0.0
        self.past = []
        self.rate = None
        self.smooth = None
        self.celsius, self.warming = None, 0.0

    def step(self, force, rate, temperature=REFERENCE_C, dt=%(dt)r):
        """(force, rate), two arrays (3,), as the real sensor reads them."""
        force, rate = np.asarray(force, float), np.asarray(rate, float)
        before = rate if self.rate is None else self.rate
        self.rate = rate
        turning = (rate - before) / dt
        force = force + np.cross(turning, self.LEVER_ARM) + np.cross(
            rate, np.cross(rate, self.LEVER_ARM))
        warm, warming = temperature - self.REFERENCE_C, self._warming(temperature, dt)
        g, turns = force / 9.80665, np.degrees(rate) / 100.0
        accel = self.ACCEL_MATRIX @ force + self.ACCEL_BIAS
        gyro = self.GYRO_MATRIX @ rate + self.GYRO_BIAS
%(additions)s        accel, gyro = self._late(accel, gyro, dt)
        accel = accel + self.ACCEL_NOISE / np.sqrt(dt) * self.random.normal(size=3)
        gyro = gyro + self.GYRO_NOISE / np.sqrt(dt) * self.random.normal(size=3)
        return (self._read(accel, self.ACCEL_STEP, self.ACCEL_RANGE),
                self._read(gyro, self.GYRO_STEP, self.GYRO_RANGE))

    def _warming(self, temperature, dt):
        """degC/min, of the last ten seconds or so."""
        before = temperature if self.celsius is None else self.celsius
        self.celsius = temperature
        keep = np.exp(-dt / self.SETTLES_S)
        self.warming = keep * self.warming + (1.0 - keep) * 60.0 * (temperature - before) / dt
        return self.warming

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


def text(sensor):
    """The module of a PutBack."""
    values = {"lever": array(sensor.lever), "constants": "", "additions": "",
              "reference_c": sensor.reference_c, "dt": 1.0 / sensor.rate_hz}
    for kind, triad in (("accel", sensor.accel), ("gyro", sensor.gyro)):
        for name in ("matrix", "bias", "noise", "step"):
            values["%s_%s" % (kind, name)] = array(getattr(triad, name))
        values[kind + "_limit"] = array(triad.limit)
        values[kind + "_delay"], values[kind + "_lag"] = triad.delay_s, triad.lag_s
        for name, effect in triad.effects.items():
            unit, added = EXPRESSIONS[kind][name]
            constant = ("%s_%s" % (kind, name)).upper()
            values["constants"] += "    %s = np.array(%s)  # %s\n" % (
                constant, array(sizes(name, effect)), unit.format(unit=UNITS[kind]))
            values["additions"] += "        %s = %s + %s\n" % (kind, kind, added.format(
                "self." + constant, **{"lag_s": 0.0, **effect.shape}, hz=list(effect.hz)))
    return put_back.header(sensor, "#", ()) + CLASS % values


def sizes(name, added):
    """(3,) or (3, k) of a put_back.Added."""
    columns = COLUMNS.get(name)
    if columns is None:
        return added.vector()
    return np.array([[added.values.get(axis + column, 0.0) for column in columns]
                     for axis in put_back.AXES])


def array(values):
    """A nested list as text, infinity as numpy's."""
    if np.ndim(values) == 2:
        return "[%s]" % ", ".join(array(row) for row in values)
    return "[%s]" % ", ".join("np.inf" if np.isinf(x) else "%.9g" % x for x in values)
