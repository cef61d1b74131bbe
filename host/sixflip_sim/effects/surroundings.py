"""Effects of what is around the sensor: the box, the table, gravity, vibration, the lever arm."""
from sixflip import STANDARD_G
from sixflip.poses.faces import AXIS, FACES
from sixflip_sim.effects.effect import AXES, WORLD, Effect, per_axis

MG_PER_DEG = 17.453292519943295  # 1 g turned by one degree, small angles
_MG_PER_CM = 0.01 / STANDARD_G * 1000.0 * 0.0003046174197867086  # (deg/s)2 at 1 cm, in mg
_MG_PER_CM_RATE = 0.01 / STANDARD_G * 1000.0 * 0.017453292519943295  # deg/s2 at 1 cm, in mg
_TWO_PI = 6.283185307179586


class BoxTilt(Effect):
    """A face of the box that is not square: gravity leans by a fixed angle in the box.

    Keys: face and the axis gravity leans towards, "Z+x" for the Z+ face; 12 of them.
    Flips cannot see it (METHOD section 1); it spans every even nonlinearity (GAP finding 1).
    """

    name = "box_tilt"
    stage = WORLD
    units = {"accel": "deg"}
    largest = {"accel": 5.0}
    keys = tuple(FACES[k] + AXES[i] for k in range(6) for i in range(3) if i != AXIS[k])
    aliases = ("quadratic", "cross_quadratic", "asymmetry", "vibration_rectification",
               "thermal_bias")

    def terms(self, m):
        # Gravity turns, so that on a tilted table, too, its length stays what it is.
        for key in self.keys:
            there = (m.face == FACES.index(key[:2])) * MG_PER_DEG
            towards = AXES.index(key[2])
            yield key, towards, there - there * m.up[towards] * m.up[towards]
            for i in range(3):
                if i != towards:
                    yield key, i, there * -m.up[towards] * m.up[i]


class TableTilt(Effect):
    """A table off level, two small angles in the world; larger ones belong to the scene."""

    name = "table_tilt"
    stage = WORLD
    units = {"accel": "deg"}
    largest = {"accel": 10.0}
    keys = ("table_x", "table_y")

    def terms(self, m):
        for key in self.keys:
            direction = getattr(m, key)
            for i in range(3):
                yield key, i, direction[i] * MG_PER_DEG


class LocalGravity(Effect):
    """Gravity of the place, against the g the file states: scale takes it up completely."""

    name = "local_gravity"
    stage = WORLD
    units = {"accel": "mg"}
    largest = {"accel": 10.0}
    keys = ("g",)
    aliases = ("cubic", "saturation")

    def terms(self, m):
        for i in range(3):
            yield "g", i, m.f[i]


class Vibration(Effect):
    """A sine from outside, amplitude along each axis.

    A line above half the sample rate appears folded: a second capture at another rate tells
    the folded line from a true one. on_s, off_s: when it runs.
    """

    name = "vibration"
    stage = WORLD
    units = {"accel": "mg", "gyro": "deg/s"}
    largest = {"accel": 16000.0, "gyro": 2000.0}
    shapes = {"frequency_hz": (50.0, 0.01, 20000.0, "Hz"), "phase": (0.0, -7.0, 7.0, "rad"),
              "on_s": (0.0, 0.0, 1e6, "s"), "off_s": (1e6, 0.0, 1e6, "s")}
    aliases = ("vibration_rectification",)

    def terms(self, m):
        wave = m.sin(m.t * (_TWO_PI * self.frequency_hz) + self.phase)
        wave = wave * ((m.t >= self.on_s) & (m.t < self.off_s))
        return per_axis((wave, wave, wave))


class LeverArm(Effect):
    """w x (w x r) + dw/dt x r for a sensor r off the axis of turning; 3 cm at 90 deg/s: 7.5 mg."""

    name = "lever_arm"
    stage = WORLD
    units = {"accel": "cm"}
    largest = {"accel": 200.0}

    def terms(self, m):
        w, rate = m.w, m.w_rate
        square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
        for j in range(3):
            for i in range(3):
                value = w[i] * w[j] * _MG_PER_CM
                if i == j:
                    value = value - square * _MG_PER_CM
                else:
                    k = 3 - i - j
                    sign = 1.0 if (k - i) % 3 == 1 else -1.0
                    value = value + sign * rate[k] * _MG_PER_CM_RATE
                yield AXES[j], i, value
