"""Samples through a chip's FIFO: each once, in order, with its time, and a loss is said."""

import sys
import unittest
from array import array

_HERE = __file__.rsplit("/", 1)[0] if "/" in __file__ else "."
sys.path[:0] = [_HERE, _HERE + "/../../host", _HERE + "/../../shared", _HERE + "/../../device"]

from simulated_board import SimulatedBoard  # noqa: E402

from sixflip.chips import catalogue  # noqa: E402
from sixflip_device import find_sensor, settings  # noqa: E402
from sixflip_device.events import Events  # noqa: E402
from sixflip_device.sensor import BusLost, Sensor, pacer  # noqa: E402
from sixflip_sim import worlds  # noqa: E402

WITH = [name for name in catalogue.SENSORS if getattr(catalogue.driver(name), "FIFO", "")]
WITHOUT = ("gy85", "adxl345", "qmi8658")


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


class EveryFifo(unittest.TestCase):
    def test_each_sample_once_and_in_order_whatever_the_board_does_in_between(self):
        """45 ms is how long a Pico's flash takes to erase a block."""
        for sensor in WITH:
            for rate_hz in (200, 500):
                board = Running(sensor, rate_hz)
                found = board.numbers(200, 45000, 50)
                self.assertEqual(found, list(range(found[0], found[0] + 200)))

    def test_the_interval_is_the_chips_by_the_boards_clock(self):
        """The chip's clock is 3 % fast; a gyro's integral would be as much too large."""
        for sensor in WITH:
            board = Running(sensor, 200, chip_clock_off=3.0)
            period = 1e6 / 1.03 / board.imu.output_rate_hz
            board.numbers(400)
            board.times = []
            board.numbers(500, 12000, 50)
            self.assertTrue(min(board.times) > 0)
            self.assertAlmostEqual(sum(board.times) / 500 / period, 1.0, delta=0.003)
            last = sorted(board.times)
            self.assertTrue(0.8 * period < last[20] and last[-20] < 1.2 * period)

    def test_an_overflow_is_said_and_what_follows_is_whole(self):
        for sensor in WITH:
            board = Running(sensor)
            board.numbers(36)
            board.board.sleep_us(4000000)
            board.times = []
            found = board.numbers(40)
            self.assertTrue(0 < found.index(None) <= 8)
            after = found[found.index(None) + 1:]
            self.assertEqual(after, list(range(after[0], after[0] + len(after))))
            self.assertTrue(after[0] > found[0] + 300)
            said = board.board.named("bus_error")
            self.assertEqual(said[-1]["action"], "samples are lost: its FIFO was full")
            # the interval behind a loss covers it
            gap = board.times[found.index(None) + 1]
            missed = after[0] - found[found.index(None) - 1]
            self.assertAlmostEqual(gap * board.imu.output_rate_hz / 1e6 / missed, 1.0, delta=0.05)

    def test_a_transfer_that_fails_gives_no_sample_twice(self):
        """One that nobody acknowledged is made again; after a time-out the memory is emptied."""
        lost = 0
        for sensor in WITH:
            board = Running(sensor)
            faults = board.world.i2c.faults
            faults.add({"kind": "nak", "rate": 0.005, "seed": 3})
            found = board.numbers(200)
            self.assertEqual(found, list(range(found[0], found[0] + 200)))
            for k in range(4):
                faults.add({"kind": "timeout", "at": board.world.i2c.transactions + 20 + 131 * k})
            found = board.numbers(400)
            numbers = [k for k in found if k is not None]
            self.assertEqual(numbers, sorted(set(numbers)))
            self.assertTrue(len(numbers) > 300)
            lost += len(found) - len(numbers)
        self.assertTrue(lost > len(WITH))

    def test_a_reset_of_the_chip_is_noticed(self):
        for sensor in WITH:
            board = Running(sensor)
            board.numbers(40)
            board.world.chips[0].power_on()
            found = board.numbers(40)
            self.assertIn(None, found)
            after = found[len(found) - found[::-1].index(None):]
            self.assertTrue(len(after) > 20)
            self.assertEqual(after, list(range(after[0], after[0] + len(after))))

    def test_a_chip_that_measures_no_more_is_lost_in_the_end(self):
        for sensor in WITH:
            board = Running(sensor)
            board.numbers(40)
            board.world.chips[0].frozen = True
            with self.assertRaises(BusLost) as caught:
                board.numbers(100)
            self.assertIn("nothing comes out of its FIFO", str(caught.exception))

    def test_the_rate_is_the_nearest_of_the_chips_and_is_said(self):
        for sensor in WITH:
            board = Running(sensor, 200)
            got = board.imu.rate_hz
            self.assertTrue(abs(got - 200) <= 40 and got == board.values["rate_hz"])
            self.assertEqual(got != 200, "%d are taken" % got in " ".join(board.report))
            self.assertTrue(board.imu.filter_hz <= 0.51 * board.imu.output_rate_hz)

    def test_below_the_rate_that_needs_it_and_without_one_a_chip_is_polled(self):
        for sensor, rate_hz in [(name, 100) for name in WITH] + [(n, 400) for n in WITHOUT]:
            board = Running(sensor, rate_hz)
            self.assertEqual((board.imu.fifo, board.imu.rate_hz), (None, rate_hz))
        values, _ = settings.merge({"fifo": False, "rate_hz": 200})
        imu, _ = find_sensor.find(SimulatedBoard(worlds.make({"order": []}), "."), values)
        self.assertEqual((imu.fifo, imu.rate_hz), (None, 200))
        values, _ = settings.merge({"fifo": True, "sensor": "qmi8658"})
        _, report = find_sensor.find(
            SimulatedBoard(worlds.make({"order": [], "sensor": "qmi8658"}), "."), values)
        self.assertIn("has no FIFO that is used", " ".join(report))


if __name__ == "__main__":
    unittest.main()
