"""What a real sensor makes of the truth: counts = clamp(round((A·f + b + noise)·lsb/step)·step)

Units: m/s², rad/s, °C, s. A (3x3, nested lists) and b map the true vector to the measured
one; the calibration is its inverse. Counts of sample k of a chip are a pure function of k,
the sample's time and the seed.

EFFECTS. Everything beyond that nominal model is an effect: an object in the list `effects`
with any of these methods, called in the order of the list, stage by stage.

    time(t) -> t        s: the instant at which a sample that the device believes to take
                        place at t really looks at the world (clock error, filter delay)
    world(m)            before the sensor: may replace m.f, m.w, m.temp, m.supply
                        (vibration, lever arm, Earth rate, local gravity, heat)
    analog(m)           the sensor's answer A·f + b, before noise and rounding: may replace
                        m.a (accelerometer, m/s²) and m.r (gyro, rad/s) (thermal bias,
                        quadratic, asymmetry, g-sensitivity, hysteresis, creep, drift, supply)
    counts(m, first)    after rounding and clamping: may replace m.counts[first:first + 3];
                        first is 0 (accelerometer), 3 (gyro), or 6 (one column: temperature)
                        (dead band, stuck bits, torn reads, swapped axes)

m is a Moment; every stage sees what the earlier ones left. Its fields are scalars and lists
of three scalars here; a host simulator puts arrays of shape (n,) in their place, so a method
says `m.a[2] = m.a[2] + self.k * (m.temp - self.t0)`, assigns whole components (never in
place), and uses + - * / and comparisons, or functions the module was handed (exp). A method
keeps no state between samples: history comes from the Moment.

    m.k           index of the chip's sample (int)      m.t      device time, s
    m.f, m.w      true specific force and rate          m.alpha  angular acceleration, rad/s²
    m.temp, m.temp_rate    °C, °C/s                     m.supply V (3.3)
    m.since_move  s since the box came to rest (0 while it moves)
    m.previous_f  specific force of the rest before     m.resting  True at rest
    m.attitude    nine numbers: body to world, row by row
    m.a, m.r      measured, from the stage analog on    m.counts  seven ints, stage counts
"""

import math

from sixflip import RAIL, STANDARD_G
from sixflip_sim import noise

_DEGREE = math.pi / 180.0


class Moment:
    """The state of things when a sample is taken; fields as in the module's docstring."""

    def __init__(self):
        self.k = 0
        self.t = 0.0
        self.f = [0.0, 0.0, 0.0]
        self.w = [0.0, 0.0, 0.0]
        self.alpha = (0.0, 0.0, 0.0)
        self.attitude = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
        self.temp = 25.0
        self.temp_rate = 0.0
        self.supply = 3.3
        self.since_move = 0.0
        self.previous_f = (0.0, 0.0, 0.0)
        self.resting = True
        self.a = [0.0, 0.0, 0.0]
        self.r = [0.0, 0.0, 0.0]
        self.counts = [0] * 7


class Triad:
    """Three axes: A (3x3), b, standard deviation sigma of the noise (m/s² or rad/s; one
    number or three), step in counts, and the noise's stream keys."""

    def __init__(self, matrix, bias, sigma, step, seed, channel):
        self.matrix = matrix
        self.bias = bias
        self.sigma = list(sigma) if isinstance(sigma, (list, tuple)) else [sigma] * 3
        self.step = step
        self.keys = [noise.key(seed, channel + i) for i in range(3)]

    def answer(self, v):
        """A·v + b, a list, in this order of operations."""
        return [row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + self.bias[i]
                for i, row in enumerate(self.matrix)]

    def round(self, measured, k, per_unit, rail, louder, counts, first):
        """Counts of all three axes into counts[first:first + 3]."""
        step, keys, sigma = self.step, self.keys, self.sigma
        gain = per_unit / step
        sample, deviate = noise.hashed(k), noise.deviate
        for i in range(3):
            x = measured[i] + sigma[i] * louder * (deviate(sample ^ keys[i]) * noise.UNIT)
            count = math.floor(x * gain + 0.5) * step
            if count > rail:
                count = rail
            elif count < -rail - 1:
                count = -rail - 1
            counts[first + i] = count


class SensorModel:
    """Accelerometer, gyro and thermometer of one box in one scene."""

    def __init__(self, scene, accel, gyro, temp_sigma=0.01, seed=1, effects=()):
        self.scene = scene
        self.accel = accel
        self.gyro = gyro
        self.temp_sigma = temp_sigma
        self.effects = list(effects)
        self.moment = Moment()
        self._temp_key = noise.key(seed, 6)
        self._time = [e.time for e in self.effects if hasattr(e, "time")]
        self._world = [e.world for e in self.effects if hasattr(e, "world")]
        self._analog = [e.analog for e in self.effects if hasattr(e, "analog")]
        self._counts = [e.counts for e in self.effects if hasattr(e, "counts")]
        self._plain = not (self._time or self._world or self._analog)
        self._rest = -1             # segment whose answers m.a and m.r hold
        self._t_us = -1

    def accel_counts(self, k, t_us, lsb_per_g, rail, louder, counts):
        """Accelerometer's sample k at t_us into counts[0:3]. louder: noise's multiplier."""
        m = self._look(k, t_us)
        self.accel.round(m.a, k, lsb_per_g / STANDARD_G, rail, louder, counts, 0)
        self._finish(m, counts, 0)

    def gyro_counts(self, k, t_us, lsb_per_dps, rail, louder, counts):
        """Gyro's sample k at t_us into counts[3:6]."""
        m = self._look(k, t_us)
        self.gyro.round(m.r, k, lsb_per_dps / _DEGREE, rail, louder, counts, 3)
        self._finish(m, counts, 3)

    def temp_counts(self, k, t_us, lsb_per_c, offset_c, counts):
        """Thermometer's reading into counts[6]."""
        m = self._look(k, t_us)
        x = m.temp + self.temp_sigma * noise.gauss(self._temp_key, k)
        count = math.floor((x - offset_c) * lsb_per_c + 0.5)
        counts[6] = max(-RAIL - 1, min(RAIL, count))
        self._finish(m, counts, 6)

    def _finish(self, m, counts, first):
        if self._counts:
            m.counts = counts
            for effect in self._counts:
                effect(m, first)

    def _look(self, k, t_us):
        """The Moment of sample k with m.a, m.r filled in; kept while nothing changes."""
        m = self.moment
        if t_us == self._t_us and k == m.k:
            return m
        m.k = k
        self._t_us = t_us
        scene = self.scene
        if self._plain:
            i = scene.index_at(t_us)
            if i == self._rest:
                if scene.warm_c:
                    m.temp = scene.temperature(t_us)
                return m
            self._rest = i if scene.resting(i) else -1
        m.t = t = t_us * 1e-6
        for effect in self._time:
            t = effect(t)
        self._fill(m, t * 1e6 if self._time else t_us)
        for effect in self._world:
            effect(m)
        m.a = self.accel.answer(m.f)
        m.r = self.gyro.answer(m.w)
        for effect in self._analog:
            effect(m)
        return m

    def _fill(self, m, t_us):
        scene = self.scene
        i = scene.index_at(t_us)
        m.attitude, f, w, alpha = scene.motion(t_us)
        m.f = list(f)
        m.w = list(w)
        m.alpha = alpha
        m.temp = scene.temperature(t_us)
        m.temp_rate = scene.temperature_rate(t_us)
        m.supply = 3.3
        m.resting = scene.resting(i)
        m.since_move = (t_us - scene.segments[i].t0) * 1e-6 if m.resting else 0.0
        if not self._plain:
            m.previous_f = scene.previous_force(i)


def typical_truth(seed, accel_bias_mg=65.0, scale=0.025, misalignment_deg=1.5,
                  gyro_scale=0.03, gyro_bias_dps=2.0):
    """(A, b, gyro A, gyro b) of a part drawn from a seed, uniform within ± the sizes given:
    what MPU6050 and ADXL345 parts show before calibration."""
    stream = noise.key(seed, 0x200)
    drawn = [0]

    def draw(size):
        drawn[0] += 1
        return size * noise.uniform(stream, drawn[0])

    def matrix(scale):
        size = misalignment_deg * _DEGREE
        return [[1.0 + draw(scale) if i == j else draw(size) for j in range(3)]
                for i in range(3)]

    return (matrix(scale), [draw(accel_bias_mg * 1e-3 * STANDARD_G) for _ in range(3)],
            matrix(gyro_scale), [draw(gyro_bias_dps * _DEGREE) for _ in range(3)])
