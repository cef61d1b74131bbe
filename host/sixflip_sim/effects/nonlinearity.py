"""Effects that bend the answer to specific force or rate."""
from sixflip_sim.effects.effect import AXES, Effect, per_axis


def _felt(effect, m):
    """What the sensor feels in units of its typical span: g, or 100 deg/s."""
    if effect.sensor == "accel":
        return m.f
    return (m.w[0] / 100.0, m.w[1] / 100.0, m.w[2] / 100.0)


class Quadratic(Effect):
    """k2 f^2 on each axis (gyro: k2 (w / 100 deg/s)^2)."""

    name = "quadratic"
    units = {"accel": "mg/g2", "gyro": "deg/s at 100 deg/s"}
    largest = {"accel": 500.0, "gyro": 50.0}
    aliases = ("asymmetry", "vibration_rectification", "cross_quadratic", "box_tilt")

    def terms(self, m):
        f = _felt(self, m)
        return per_axis([f[i] * f[i] for i in range(3)])


class Cubic(Effect):
    """k3 f^3 on each axis: odd, so six faces take it for scale."""

    name = "cubic"
    units = {"accel": "mg/g3", "gyro": "deg/s at 100 deg/s"}
    largest = {"accel": 500.0, "gyro": 50.0}
    aliases = ("saturation", "local_gravity", "thermal_scale")

    def terms(self, m):
        f = _felt(self, m)
        return per_axis([f[i] * f[i] * f[i] for i in range(3)])


class CrossQuadratic(Effect):
    """k f_j f_k into another axis; key "xyz" adds to x what y*z gives, "xyy" what y squared."""

    name = "cross_quadratic"
    units = {"accel": "mg/g2"}
    largest = {"accel": 500.0}
    keys = tuple(AXES[i] + AXES[j] + AXES[k] for i in range(3) for j in range(3)
                 for k in range(j, 3) if not i == j == k)
    aliases = ("box_tilt", "quadratic")

    def terms(self, m):
        for key in self.keys:
            i, j, k = [AXES.index(letter) for letter in key]
            yield key, i, m.f[j] * m.f[k]


class Asymmetry(Effect):
    """s |f|: the two directions of an axis have different scales (5.9 % seen on gyros)."""

    name = "asymmetry"
    units = {"accel": "mg/g", "gyro": "%"}
    largest = {"accel": 200.0, "gyro": 20.0}
    aliases = ("quadratic", "vibration_rectification", "cross_quadratic", "box_tilt")

    def terms(self, m):
        felt, unit = (m.f, 1.0) if self.sensor == "accel" else (m.w, 0.01)
        return per_axis([abs(felt[i]) * unit for i in range(3)])


class VibrationRectification(Effect):
    """K2 sigma^2 of the vibration: a steady offset while it lasts.

    The offset is constant in the sensor (silent: absorbed by the bias) unless the vibration is
    vertical, when only its share along each axis, f_i^2, is rectified. Sizes x y z, with
    vertical = 0 or 1 for which of the two. By the vibration that is in the samples: of one at 12
    times the corner of the chip's filter, of second order, they hold a part in 20 000 of the
    power, and by that much K2 is larger than the bend's (typical, 5 mg/g2).
    """

    name = "vibration_rectification"
    units = {"accel": "mg/g2 rms"}
    largest = {"accel": 1e5}
    shapes = {"vibration_mg": (0.0, 0.0, 16000.0, "mg rms"), "vertical": (1, 0, 1, "")}
    aliases = ("quadratic", "asymmetry", "cross_quadratic", "box_tilt")

    def terms(self, m):
        rms = (m.vibration_mg + self.vibration_mg) * 0.001
        offset = rms * rms
        if self.vertical:
            return per_axis([offset * m.up[i] * m.up[i] for i in range(3)])
        return per_axis((offset, offset, offset))
