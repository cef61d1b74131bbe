"""Effects in the counts. They work on ints and on integer arrays (n,) alike."""
from sixflip_sim.effects.effect import AXES, REGISTER, Effect, per_axis

_STEP = {"accel": "counts", "gyro": "counts"}


class RegisterEffect(Effect):
    """count(i, c, previous, uniform): the count that is read on axis i instead of c.

    previous: the count of the sample before; uniform: numbers in [0, 1), one a sample.
    """

    stage = REGISTER
    units = _STEP
    smallest = 0
    whole = True

    def count(self, i, c, previous, uniform):
        raise NotImplementedError


class Quantisation(RegisterEffect):
    """Counts come in steps: every count of several MPU6050 boards is a multiple of 4."""

    name = "quantisation"
    largest = {"accel": 4096, "gyro": 4096}

    def count(self, i, c, previous, uniform):
        step = self.values.get(AXES[i], 1) or 1
        return (c + step // 2) // step * step


class DeadBand(RegisterEffect):
    """Counts nearer to 0 than the band read 0."""

    name = "dead_band"
    largest = {"accel": 4096, "gyro": 4096}

    def count(self, i, c, previous, uniform):
        return c * (abs(c) >= self.values.get(AXES[i], 0))


class TornReads(RegisterEffect):
    """A high byte of one sample with the low byte of the next, with the chance given in %.

    Visible where the high byte changed in between: a jump of about 256 counts.
    """

    name = "torn_reads"
    units = {"accel": "%", "gyro": "%"}
    largest = {"accel": 100.0, "gyro": 100.0}
    keys = ("chance",)
    whole = False

    def count(self, i, c, previous, uniform):
        torn = (previous // 256) * 256 + c % 256
        return c + (uniform < 0.01 * self.values.get("chance", 0.0)) * (torn - c)


class AxisSwap(Effect):
    """Registers carry other axes: x = -2 means that x reads minus y. 0 leaves an axis alone."""

    name = "axis_swap"
    stage = REGISTER
    units = {"accel": "axis", "gyro": "axis"}
    largest = {"accel": 3, "gyro": 3}
    whole = True

    def swapped(self, counts):
        """The three counts (or arrays) as they arrive; counts is a sequence of three."""
        out = []
        for i in range(3):
            source = self.values.get(AXES[i], 0) or i + 1
            out.append(counts[source - 1] if source > 0 else -counts[-source - 1])
        return out


class Saturation(Effect):
    """The share of what exceeds `level` that is lost: 1 is a hard rail, less a soft one.

    level: g, or deg/s for the gyro. On faces it is odd, and so it looks like scale.
    """

    name = "saturation"
    units = {"accel": "1", "gyro": "1"}
    largest = {"accel": 1.0, "gyro": 1.0}
    smallest = 0.0
    shapes = {"level": (2.0, 0.01, 2000.0, "g or deg/s")}
    aliases = ("cubic", "local_gravity")

    def terms(self, m):
        felt, unit = (m.f, 1000.0) if self.sensor == "accel" else (m.w, 1.0)
        top = self.level
        return per_axis([((felt[i] > top) * (top - felt[i]) + (felt[i] < -top) * (-top - felt[i]))
                         * unit for i in range(3)])
