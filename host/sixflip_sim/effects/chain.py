"""The effects of one sensor model, as the object that sensor_model's docstring asks for.

Takes sensor_model.Moment, in m/s2 and rad/s, scalars or arrays; effects think in g, mg and
deg/s. Only the stages that some effect needs exist as methods, so the rest costs nothing.
"""
import math

from sixflip import STANDARD_G
from sixflip.poses.faces import AXIS, SIGN
from sixflip_sim import noise
from sixflip_sim.effects.effect import REGISTER, WORLD
from sixflip_sim.effects.moment import Moment

DEGREE = math.pi / 180.0
FLAT = 0.966  # cosine of 15 deg: as far off a face is leaning
_CHANNEL = 0x300  # of the noise: chances of register effects


class Chain:
    """effects: Effect objects, applied in the order given; seed: of their chances.
    session: number of the session, so that drift goes on differently in each.
    only: "accel" or "gyro" when nobody will look at the other one's answer."""

    def __init__(self, effects, seed=1, session=0, functions=None):
        self.effects = effects
        self.seed = seed
        self.session = session
        self.only = None
        self.view = functions or Moment()
        world = [e for e in effects if e.stage == WORLD]
        sensor = [e for e in effects if e.stage == "sensor"]
        registers = [e for e in effects if e.stage == REGISTER]
        self._delay = 0.0
        self._pace = 1.0
        for e in effects:
            if e.name == "filter_lag" and e.sensor == "device":
                self._delay = 0.001 * e.values.get("tau", 0.0)
            elif e.name == "sample_rate" and not e.stamped:
                self._pace = 1.0 + 0.01 * e.values.get("rate", 0.0)
        if self._delay or self._pace != 1.0:
            self.time = self._time
        if world:
            self._world_effects = world
            self.world = self._world
        if sensor:
            self._sensor_effects = sensor
            self.analog = self._analog
        if registers:
            self._registers = registers
            self._before = [[0] * 7 for _ in registers]
            self.counts = self._counts

    def _time(self, t):
        return t / self._pace - self._delay

    def _world(self, m):
        m.f, m.w = self._added(m, self._world_effects, m.f, m.w)

    def _analog(self, m):
        wanted = self._sensor_effects
        if self.only:
            wanted = [e for e in wanted if e.sensor == self.only]
        m.a, m.r = self._added(m, wanted, m.a, m.r)

    def _added(self, m, effects, accel, gyro):
        """(accel, gyro) with what the effects add; lists of three."""
        v = look(m, self.view)
        v.session = self.session
        mg, dps = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        for effect in effects:
            effect.add(v, mg if effect.sensor == "accel" else dps)
        return ([accel[i] + mg[i] * (STANDARD_G * 1e-3) for i in range(3)],
                [gyro[i] + dps[i] * DEGREE for i in range(3)])

    def _counts(self, m, first):
        if first == 6:
            return
        sensor = "accel" if first == 0 else "gyro"
        for number, effect in enumerate(self._registers):
            if effect.sensor != sensor:
                continue
            if effect.name == "axis_swap":
                m.counts[first:first + 3] = effect.swapped(m.counts[first:first + 3])
                continue
            chance = self._chance(number, m.k)
            for i in range(first, first + 3):
                count = m.counts[i]
                m.counts[i] = effect.count(i - first, count, self._previous(number, i, count),
                                           chance)
                if isinstance(count, int):
                    self._before[number][i] = count

    def _chance(self, number, k):
        """Number(s) in [0, 1) of sample(s) k."""
        stream = noise.key(self.seed, _CHANNEL + number + 8 * self.session)
        return noise.uniform(stream, k) * 0.5 + 0.5

    def _previous(self, number, i, count):
        """The count of the sample read before; of an array, itself moved by one."""
        if isinstance(count, int):
            return self._before[number][i]
        previous = count.copy()
        previous[1:] = count[:-1]
        return previous


def look(m, v):
    """Fill v, a moment.Moment, from sensor_model's m; returns v."""
    v.t, v.temperature, v.temperature_rate = m.t, m.temp, m.temp_rate
    v.f = tuple([c / STANDARD_G for c in m.f])
    v.w = tuple([c / DEGREE for c in m.w])
    v.w_rate = tuple([c / DEGREE for c in m.alpha])
    v.before = tuple([c / STANDARD_G for c in m.previous_f])
    v.since_move, v.volts = m.since_move, m.supply
    r = m.attitude
    v.table_x, v.table_y, v.up = r[0:3], r[3:6], r[6:9]
    face = -1
    for k in range(6):
        face = face + (SIGN[k] * r[6 + AXIS[k]] > FLAT) * (k + 1)
    v.face = face
    return v
