"""How the sensor sits in the robot, measured on the board; and records that a host offers."""

import math
import os
import shutil
import tempfile
import unittest

from sixflip.record import correction_record
from tests.worlds.simulated_board import power_on

STILL = {"order": [], "first_rest_s": 60.0, "tilt_deg": 8.0, "tilt_dir_deg": 20.0}


class Calibrated(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.mkdtemp()
        power_on(self.root)

    def tearDown(self):
        shutil.rmtree(self.root)

    def path(self, name):
        return os.path.join(self.root, name)

    def record(self, slot="a"):
        with open(self.path("record_%s.bin" % slot), "rb") as f:
            return correction_record.decode(f.read())

    def ask(self, line, event, settings=None, **world):
        board = power_on(self.root, dict(STILL, **world), answers=[
            ["ready", line, 1], [event, {"cmd": "stop"}, 1]], **(settings or {}))
        return board.named(event)[-1]


class TestCommand(Calibrated):
    def test_measured_stored_and_applied(self):
        board = power_on(self.root, STILL, answers=[
            ["ready", {"cmd": "mount"}, 1],
            [lambda e: e["event"] == "sample" and e["t_us"] > 7e6, {"cmd": "stop"}, 1]])
        told = board.only("mounted")
        R = board.world.scene.end_attitude()
        self.assertEqual(told["order"], self.record("b").mounting["order"])
        lean = math.degrees(math.acos(R[8]))
        both = math.degrees(math.acos(math.cos(math.radians(told["roll_deg"]))
                                      * math.cos(math.radians(told["pitch_deg"]))))
        self.assertAlmostEqual(both, lean, delta=0.1)
        last = [e for e in board.named("sample") if e["at_s"] > told["at_s"]]
        self.assertGreater(len(last), 5)
        for axis, true in enumerate((0.0, 0.0, 9.80665)):
            mean = sum(e["a"][axis] for e in last) / len(last)
            self.assertAlmostEqual(mean, true, delta=0.03)
            # the bias of the rest is still in force
            self.assertAlmostEqual(sum(e["w"][axis] for e in last) / len(last), 0.0, delta=0.001)
        self.assertGreater(math.hypot(*board.named("sample")[0]["a"][:2]), 1.0)
        self.assertEqual(self.record("a").mounting, None)    # the record before

    def test_axes_frame_and_order_of_the_command(self):
        told = self.ask({"cmd": "mount", "axes": "-y x z", "frame": "ned", "order": "yxz"},
                        "mounted")
        self.assertEqual((told["axes"], told["frame"], told["order"]), ("-y x z", "ned", "yxz"))

    def test_taken_out_again(self):
        self.ask({"cmd": "mount"}, "mounted")
        self.assertTrue(self.ask({"cmd": "mount", "off": True}, "mounted")["off"])
        self.assertEqual(self.record("a").mounting, None)

    def test_refused_with_the_reason(self):
        for line, word in (({"cmd": "mount", "axes": "y x z"}, "left-handed"),
                           ({"cmd": "mount", "axes": 3}, "expected a text"),
                           ({"cmd": "mount", "frame": "enu"}, "rep103 or ned"),
                           ({"cmd": "mount", "order": "zyx"}, "xyz or yxz")):
            self.assertIn(word, self.ask(line, "not_mounted")["reason"])
        told = self.ask({"cmd": "mount"}, "not_mounted", accel_noise_mg=14.0)
        self.assertIn("engine", told["reason"])
        moving = self.ask({"cmd": "mount"}, "not_mounted", first_rest_s=6.0, order=[
            "Z+a", "Z+b"] * 9, dwell_s=0.3, move_s=1.5, tilt_deg=0.0)
        self.assertIn("not at rest", moving["reason"])
        self.assertFalse(os.path.exists(self.path("record_b.bin")))

    def test_of_a_sensor_that_no_longer_reads_gravity(self):
        told = self.ask({"cmd": "mount"}, "not_mounted", accel_bias_mg=[60.0, 50.0, 120.0])
        self.assertIn("gravity reads", told["reason"])


class TestAtPowerUp(Calibrated):
    SETTING = {"mounting": {"axes": "x y z", "frame": "rep103"}}

    def test_measured_and_written_when_it_changed(self):
        self.assertTrue(power_on(self.root, STILL, **self.SETTING).only("mounted")["written"])
        told = power_on(self.root, STILL, **self.SETTING).only("mounted")
        self.assertFalse(told["written"])
        self.assertEqual(told["sequence"], 2)
        told = power_on(self.root, dict(STILL, tilt_deg=5.0), **self.SETTING).only("mounted")
        self.assertTrue(told["written"])

    def test_a_robot_that_moves_keeps_what_is_stored(self):
        power_on(self.root, STILL, **self.SETTING)
        board = power_on(self.root, {"first_rest_s": 0.7, "dwell_s": 0.3}, rest_s=2,
                         **self.SETTING)
        self.assertEqual(board.only("not_mounted")["mounting"], "stored")

    def test_only_when_configured(self):
        board = power_on(self.root, STILL)
        self.assertEqual(board.named("mounted") + board.named("not_mounted"), [])
        board = power_on(self.root, STILL, mounting={"at_power_up": False})
        self.assertEqual(board.named("mounted") + board.named("not_mounted"), [])

    def test_a_wrong_setting_is_named(self):
        board = power_on(self.root, STILL, mounting={"axes": "x x z"})
        self.assertIn("x, y and z once each", board.only("not_mounted")["reason"])
        self.assertEqual(len(board.named("ready")), 1)


class TestOffered(Calibrated):
    def offer(self, data):
        with open(self.path("offered.bin"), "wb") as f:
            f.write(data)
        board = power_on(self.root, STILL)
        self.assertFalse(os.path.exists(self.path("offered.bin")))
        return board

    def test_becomes_the_newest(self):
        record = self.record()
        record.mounting = {"roll_deg": 10.0, "pitch_deg": 0.0, "order": "xyz", "axes": "x y z",
                           "frame": "rep103"}
        record.sequence = 0
        board = self.offer(correction_record.encode(record))
        self.assertEqual(board.only("restored")["sequence"], 2)
        self.assertEqual(board.only("record")["sequence"], 2)
        self.assertIn("mounting", board.only("record")["measured"])
        self.assertEqual(self.record("b").mounting["roll_deg"], 10.0)

    def test_refused(self):
        before = self.record()
        whole = correction_record.encode(before)
        before.chip = "gy85"
        chip = correction_record.encode(before)
        before.chip, before.accel_range_g = "mpu6050", 8
        wide = correction_record.encode(before)
        before.accel_range_g, before.who_am_i = 2, (0x70, 0x70)
        clone = correction_record.encode(before)
        for data, word in ((whole[:-1], "CRC"), (chip, "it is for gy85"), (wide, "ranges 8"),
                           (clone, "0x70"), (b"rubbish", "no correction record")):
            board = self.offer(data)
            self.assertIn(word, board.only("not_restored")["reason"])
            self.assertEqual(board.only("record")["sequence"], 1)
        self.assertFalse(os.path.exists(self.path("record_b.bin")))

    def test_on_a_board_that_has_none(self):
        with open(self.path("record_a.bin"), "rb") as f:
            data = f.read()
        os.remove(self.path("record_a.bin"))
        board = self.offer(data)
        self.assertEqual(board.only("record")["sequence"], 1)
        self.assertEqual(board.named("calibrating"), [])


if __name__ == "__main__":
    unittest.main()
