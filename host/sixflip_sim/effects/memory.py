"""Effects of what the sensor went through before."""
from sixflip_sim.effects.effect import Effect, per_axis


class Hysteresis(Effect):
    """h f_previous: part of the pose before stays."""

    name = "hysteresis"
    units = {"accel": "mg/g", "gyro": "deg/s/g"}
    largest = {"accel": 100.0, "gyro": 5.0}
    aliases = ("creep",)

    def terms(self, m):
        return per_axis(m.before)


class Creep(Effect):
    """c (f_previous - f) exp(-t / tau) since the move: 5 mg, tau 60-70 s were seen on Z."""

    name = "creep"
    units = {"accel": "mg/g"}
    largest = {"accel": 200.0}
    shapes = {"tau_s": (30.0, 0.5, 3600.0, "s")}
    aliases = ("hysteresis",)

    def terms(self, m):
        rest = m.exp(-m.since_move / self.tau_s)
        return per_axis([(m.before[i] - m.f[i]) * rest for i in range(3)])
