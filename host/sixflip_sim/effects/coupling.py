"""What reaches the gyro although it is no turning of the box, and the supply."""
from sixflip_sim.effects.effect import AXES, WORLD, Effect, per_axis


class GSensitivity(Effect):
    """G f on the gyro; key "xy" is what 1 g along y adds to the rate about x.

    Datasheets: 0.1 deg/s/g static (MPU-6050 PS rev 3.4 table 6.1; ITG-3205 PS table 3.1).
    """

    name = "g_sensitivity"
    units = {"gyro": "deg/s/g"}
    largest = {"gyro": 10.0}
    keys = tuple(a + b for a in AXES for b in AXES)
    aliases = ("earth_rate",)

    def terms(self, m):
        for i in range(3):
            for j in range(3):
                yield AXES[i] + AXES[j], i, m.f[j]


class EarthRate(Effect):
    """The Earth turns at 0.0041781 deg/s: `up` = sin(latitude) of it about the vertical, the
    rest about north, which has two components x and y on the table."""

    name = "earth_rate"
    stage = WORLD
    units = {"gyro": "deg/s"}
    largest = {"gyro": 0.0042}
    keys = ("up", "table_x", "table_y")
    aliases = ("g_sensitivity",)

    def terms(self, m):
        for key in self.keys:
            direction = getattr(m, key)
            for i in range(3):
                yield key, i, direction[i]


class Supply(Effect):
    """beta (V - V0): the offset follows the supply. A capture holds no voltage: absorbed by the
    bias unless the supply changes within a session."""

    name = "supply"
    units = {"accel": "mg/V", "gyro": "deg/s/V"}
    largest = {"accel": 1000.0, "gyro": 100.0}
    shapes = {"reference_v": (3.3, 1.0, 6.0, "V"), "volts": (3.3, 1.0, 6.0, "V")}
    aliases = ("warm_up", "drift")

    def terms(self, m):
        change = m.volts - 3.3 + self.volts - self.reference_v
        return per_axis((change, change, change))
