"""A board with a chip whose samples are numbered: what was read twice, lost or torn shows."""

from array import array

from sixflip.chips import catalogue
from sixflip_device import find_sensor, settings
from sixflip_device.events import Events
from sixflip_device.sensor import Sensor, pacer
from sixflip_sim import worlds
from tests.worlds.simulated_board import SimulatedBoard

WITH = [name for name in catalogue.SENSORS if getattr(catalogue.driver(name), "FIFO", "")]


class Numbered:
    """A model whose sample k reads k, k + 1, ... and whose thermometer says 30 °C."""

    def accel_counts(self, k, t_us, lsb, rail, louder, counts):
        counts[:3] = [k % 9000 + 1, k % 9000 + 2, -(k % 9000) - 3]

    def gyro_counts(self, k, t_us, lsb, rail, louder, counts):
        counts[3:6] = [k % 9000 + 4, -(k % 9000) - 5, k % 9000 + 6]

    def temp_counts(self, k, t_us, lsb, offset, counts):
        counts[6] = round((30.0 - offset) * lsb)


class Running:
    """A board with a numbered chip that is set up, and what next() gives."""

    def __init__(self, sensor, rate_hz=200, fifo=None, **more):
        spec = {"sensor": sensor, "order": [], "first_rest_s": 1000.0}
        spec.update(more)
        self.world = worlds.make(spec)
        for chip in self.world.chips:
            chip.model = Numbered()
        self.board = SimulatedBoard(self.world, ".")
        self.values, problems = settings.merge({"rate_hz": rate_hz, "sensor": sensor,
                                                "fifo": fifo})
        assert not problems
        imu, self.report = find_sensor.find(self.board, self.values)
        self.sensor = Sensor(self.board, imu, self.values, Events(self.board.write_line))
        self.imu = imu
        self.paced = pacer(self.board, self.sensor, self.values["rate_hz"])
        self.times = []

    def numbers(self, n, busy_us=0, every=1):
        """k of the next n samples; None for each time that some were lost."""
        sample = array("h", [0] * 7)
        found = []
        for i in range(n):
            dt = self.paced.next(sample)
            self.times.append(dt)
            if dt < 0:
                found.append(None)
                continue
            k = sample[0] - 1
            assert list(sample[:6]) == [k + 1, k + 2, -k - 3, k + 4, -k - 5, k + 6], sample
            celsius = sample[6] / self.imu.temp_lsb_per_c + self.imu.temp_offset_c
            assert abs(celsius - 30.0) < 0.3, celsius
            found.append(k)
            if i % every == 0:
                self.board.sleep_us(busy_us)
        return found
