"""Effects of the chip's temperature and of the time since it was switched on."""
from sixflip_sim.effects.effect import AXES, Effect, per_axis

_TEMPERATURE = (25.0, -60.0, 150.0, "degC")


class ThermalBias(Effect):
    """k (T - T0), with a square and a cube where asked; sizes x, x2, x3, ...

    lag_s: the thermometer sits beside the sensor (ADXL345: the ITG3205's), 10-60 s behind it;
    to first order the sensor's own temperature is T + lag dT/dt.
    """

    name = "thermal_bias"
    units = {"accel": "mg/degC", "gyro": "deg/s/degC"}
    keys = ("x", "y", "z", "x2", "y2", "z2", "x3", "y3", "z3")
    largest = {"accel": 100.0, "gyro": 30.0}
    shapes = {"reference_c": _TEMPERATURE, "lag_s": (0.0, 0.0, 600.0, "s"),
              "order": (1, 1, 3, "")}
    aliases = ("warm_up", "drift", "box_tilt")

    def terms(self, m):
        dt = m.temperature + self.lag_s * m.temperature_rate - self.reference_c
        for key in self.keys:
            power = int(key[1:] or 1)
            if power <= self.order or key in self.values:
                yield key, AXES.index(key[0]), dt if power == 1 else dt ** power


class ThermalScale(Effect):
    """c f (T - T0): the scale changes with temperature. One percent of 1 g is 10 mg."""

    name = "thermal_scale"
    units = {"accel": "%/degC", "gyro": "%/degC"}
    largest = {"accel": 2.0, "gyro": 2.0}
    shapes = {"reference_c": _TEMPERATURE}
    aliases = ("cubic", "quadratic", "asymmetry")

    def terms(self, m):
        dt = m.temperature - self.reference_c
        felt, unit = (m.f, 10.0) if self.sensor == "accel" else (m.w, 0.01)
        return per_axis([felt[i] * dt * unit for i in range(3)])


class WarmUp(Effect):
    """w exp(-t / tau) after power-up, tau 60-300 s."""

    name = "warm_up"
    units = {"accel": "mg", "gyro": "deg/s"}
    largest = {"accel": 1000.0, "gyro": 100.0}
    shapes = {"tau_s": (120.0, 1.0, 7200.0, "s")}
    aliases = ("thermal_bias", "drift")

    def terms(self, m):
        rest = m.exp(-m.t / self.tau_s)
        return per_axis((rest, rest, rest))


class ThermalRate(Effect):
    """h dT/dt: a gradient across the chip while its temperature changes."""

    name = "thermal_rate"
    units = {"accel": "mg/(degC/min)", "gyro": "deg/s/(degC/min)"}
    largest = {"accel": 500.0, "gyro": 50.0}
    aliases = ("warm_up", "thermal_bias")

    def terms(self, m):
        rate = m.temperature_rate * 60.0
        return per_axis((rate, rate, rate))
