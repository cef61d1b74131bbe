"""Samples through a chip's FIFO: each once, in order, with its time, and a loss is said."""

import unittest

from sixflip_device import find_sensor, settings
from sixflip_device.sensor import BusLost
from sixflip_sim import worlds
from tests.worlds.numbered_chip import WITH, Running
from tests.worlds.simulated_board import SimulatedBoard

WITHOUT = ("gy85", "adxl345", "qmi8658")


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
