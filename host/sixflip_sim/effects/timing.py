"""Effects of when a sample is taken, and of what lies between feeling and reading."""
from sixflip_sim.effects.effect import TIMING, Effect

_RADIAN = 0.017453292519943295  # of a degree; g and ms make mg and s of it


class SampleRate(Effect):
    """The clock of the chip runs (1 + kappa) times as fast; 99.3 and 100.3 Hz were seen for 100.

    stamped 1: the timestamps are true and show it. 0: the timestamps are made with that same
    clock, and it is an isotropic gyro scale.
    """

    name = "sample_rate"
    stage = TIMING
    units = {"device": "%"}
    keys = ("rate",)
    largest = {"device": 20.0}
    shapes = {"stamped": (1, 0, 1, "")}
    aliases = ("isotropic gyro scale (without device timestamps)",)

    def period_us(self, nominal_us):
        """Time between two samples in us (float)."""
        return nominal_us / (1.0 + 0.01 * self.values.get("rate", 0.0))


class DroppedSamples(Effect):
    """Samples that never reach the file, each with the chance given."""

    name = "dropped_samples"
    stage = TIMING
    units = {"device": "%"}
    keys = ("chance",)
    largest = {"device": 90.0}
    smallest = 0.0

    def lost(self, uniform):
        """True where sample(s) are lost; uniform: number(s) in [0, 1)."""
        return uniform < 0.01 * self.values.get("chance", 0.0)


class FilterLag(Effect):
    """The low-pass filter is behind: -tau dw/dt, to first order; delays of 1-19 ms.

    sensor "device": accelerometer and gyro are late together, an exact delay of tau; "gyro":
    the gyro alone; "accel": the accelerometer alone, what turning does to f: df/dt = f x w.
    MPU-6050 register map rev 4.2, register 26: 0.98 to 18.6 ms for DLPF_CFG 0 to 6.
    """

    name = "filter_lag"
    units = {"device": "ms", "gyro": "ms", "accel": "ms"}
    largest = {"device": 100.0, "gyro": 100.0, "accel": 100.0}
    keys = ("tau",)
    smallest = 0.0

    def _sensor(self, sensor):
        return Effect._sensor(self, sensor or "device")

    def terms(self, m):
        f, w = m.f, m.w
        for i in range(3):
            if self.sensor == "gyro":
                yield "tau", i, m.w_rate[i] * -0.001
            elif self.sensor == "accel":
                j, k = (i + 1) % 3, (i + 2) % 3
                yield "tau", i, (f[j] * w[k] - f[k] * w[j]) * -_RADIAN
