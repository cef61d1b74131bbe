"""A register that shifts the readings is changed by somebody else: no calibration from them."""

import tempfile
import unittest

from sixflip_device import power_up, settings
from sixflip_sim import worlds
from tests.worlds.simulated_board import QUICK, SHORT_WORLD, STOP_WHEN_READY, SimulatedBoard

# sensor, who_am_i, register, and what it reads as configured
SHIFTING = (("adxl345", None, 0x1E, 0x00), ("gy85", None, 0x20, 0x00),
            ("lsm6dsv", None, 0x74, 0x00),
            ("mpu6050", 0x68, 0x08, 0x02), ("mpu6050", 0x68, 0x13, 0x00),
            ("mpu6050", 0x70, 0x7D, 0x05), ("mpu6050", 0x70, 0x17, 0x00))


class Meddler(SimulatedBoard):
    """When when(event) says so, once, a register of the first chip gets another value."""

    def meddle(self, when, register, value):
        self.when, self.register, self.value = when, register, value
        return self

    def write_line(self, text):
        SimulatedBoard.write_line(self, text)
        if self.when and self.when(self.events[-1]):
            self.when = None
            self.world.i2c.writeto_mem(self.world.chips[0].address, self.register,
                                       bytes([self.value]))


def meddled(when, sensor, who_am_i, register, value):
    """The board after a calibration, and a power-up that streams."""
    world = worlds.make(dict(SHORT_WORLD, sensor=sensor, who_am_i=who_am_i, tremor_mg=20.0))
    with tempfile.TemporaryDirectory() as root:
        board = Meddler(world, root, (STOP_WHEN_READY,)).meddle(when, register, value)
        power_up.run(board, *settings.merge(QUICK))
    return board


def before(event):
    return event["event"] == "hello"


def in_session(event):
    return event["event"] == "pose" and event["pose"] == "Z+a"


def after_the_last(event):
    return event["event"] == "pose" and not event["missing"]


class ChangedRegisters(unittest.TestCase):
    def test_changed_in_a_session_it_is_refused_by_name(self):
        for sensor, who_am_i, register, was in SHIFTING:
            board = meddled(in_session, sensor, who_am_i, register, was ^ 0x01)
            solved = board.only("solved")
            self.assertEqual(solved["verdict"], "refused")
            for words in ("register 0x%02x" % register, "was 0x%02x" % was,
                          "reads 0x%02x" % (was ^ 0x01)):
                self.assertIn(words, solved["reason"])

    def test_changed_before_the_session_it_is_set_up_anew(self):
        for sensor, who_am_i, register, was in SHIFTING:
            board = meddled(before, sensor, who_am_i, register, was ^ 0x01)
            self.assertEqual(board.only("solved")["verdict"], "good")
            self.assertIn("register 0x%02x" % register, board.named("bus_error")[0]["action"])

    def test_changed_with_the_last_sample_it_is_refused(self):
        for sensor, who_am_i, register, was in SHIFTING[:3]:
            board = meddled(after_the_last, sensor, who_am_i, register, was ^ 0x01)
            self.assertEqual(board.only("solved")["verdict"], "refused")

    def test_a_changed_filter_is_set_up_anew_and_costs_no_session(self):
        board = meddled(in_session, "mpu6050", 0x68, 0x1A, 0x06)
        self.assertEqual(board.only("solved")["verdict"], "good")
        self.assertIn("configuring it again", board.named("bus_error")[0]["action"])


if __name__ == "__main__":
    unittest.main()
