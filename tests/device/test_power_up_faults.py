"""The whole firmware on bad days: sessions that are refused, a bus that fails, records that do not
fit."""

import os

from test_power_up import STILL, Folder

from sixflip.capture.reader import read as read_blocks
from sixflip.record import correction_record
from sixflip_sim import worlds
from tests.worlds.simulated_board import (
    SHORT_WORLD,
    STOP_WHEN_READY,
    SimulatedBoard,
    TooLong,
    power_on,
)


class TestRefused(Folder):
    """A refused session replaces nothing."""

    def refused(self, board, *words):
        solved = board.named("solved")[-1]
        self.assertEqual(solved["verdict"], "refused")
        for word in words:
            self.assertIn(word, solved["reason"])
        self.assertFalse([e for e in board.named("saved") if e["written"]])

    def test_missing_pose_times_out(self):
        self.calibrated()
        before = self.read("record_a.bin"), self.read("capture.bin")
        self.write("calibrate.flag", b"")
        board = power_on(self.root, {"mishaps": [{"kind": "missing", "pose": "X-b"}]})
        self.refused(board, "timed out", "X-b")
        self.assertEqual((self.read("record_a.bin"), self.read("capture.bin")), before)
        kept = read_blocks(self.read("refused.bin"))
        self.assertFalse(kept.complete)
        self.assertEqual(len(kept.placements), 11)
        self.assertTrue(board.only("ready")["corrected"])

    def test_never_calibrated_streams_raw_and_says_so(self):
        board = power_on(self.root, STILL, timeout_s=10)
        self.refused(board, "timed out")
        self.assertFalse(board.only("ready")["corrected"])
        self.assertNotIn("record_a.bin", self.files())

    def test_stopped_by_the_host_keeps_what_was_captured(self):
        board = power_on(self.root, answers=[
            [lambda e: e["event"] == "pose" and e["pose"] == "X+a", {"cmd": "stop"}, 1],
            STOP_WHEN_READY])
        self.refused(board, "stopped")
        self.assertEqual(len(read_blocks(self.read("refused.bin")).placements), 5)

    def test_moved_box(self):
        board = power_on(self.root, {"mishaps": [
            {"kind": "moved", "pose": "Z-a", "at_s": 2.0, "deg": 5.0}]})
        self.assertTrue([e for e in board.named("refused") if e["reason"] == "moving"])

    def test_crooked_face(self):
        board = power_on(self.root, {"mishaps": [
            {"kind": "crooked", "pose": "Y+a", "deg": 8.0}]})
        solved = board.named("solved")
        told = [e["reason"] for e in board.named("refused") + solved if e["reason"]]
        self.assertTrue([t for t in told if "crooked" in t or "square" in t or "lean" in t
                         or "off" in t], told)
        self.assertNotEqual(solved[-1]["verdict"], "good")

    def test_redo_takes_a_face_again(self):
        board = power_on(self.root, {"order": ["Z+a", "Z+b", "Z-a", "Z-b", "X+a", "X+b", "X-a",
                                               "X-b", "Z+a", "Z+b", "Y+a", "Y+b", "Y-a", "Y-b"]},
                         answers=[[lambda e: e["event"] == "pose" and e["pose"] == "X-b",
                                   {"cmd": "redo", "face": "Z+"}, 1], STOP_WHEN_READY])
        self.assertEqual(sorted(board.only("redo")["missing"])[-2:], ["Z+a", "Z+b"])
        blocks = read_blocks(self.read("capture.bin"))
        self.assertEqual(len(blocks.placements), 12)
        self.assertEqual(len(board.named("pose")), 14)


class TestBus(Folder):
    def with_faults(self, faults, **changes):
        return power_on(self.root, {"faults": faults}, **changes)

    def test_no_chip_is_said_once_and_the_host_is_obeyed(self):
        board = SimulatedBoard(worlds.make(SHORT_WORLD), self.root, limit_s=20, answers=[
            ["info", {"cmd": "stop"}, 1], ["error", {"cmd": "info"}, 1]])
        del board.world.i2c.chips[:]
        power_on(self.root, board=board)
        self.assertEqual(board.names(), ["hello", "error", "info", "stopped"])
        self.assertIsNone(board.only("hello")["sensor"])
        self.assertIn("MPU6050", board.only("error")["expected"])

    def test_chip_plugged_in_later(self):
        board = power_on(self.root, dict(STILL, faults=[
            {"kind": "unplugged", "at": 0, "for_ms": 7000}]), timeout_s=6)
        self.assertEqual(len(board.named("hello")), 2)
        self.assertEqual(board.named("hello")[1]["sensor"], "mpu6050")
        self.assertEqual(len(board.named("error")), 1)

    def test_wrong_chip(self):
        board = SimulatedBoard(worlds.make(dict(SHORT_WORLD, sensor="adxl345")), self.root,
                               [["error", {"cmd": "stop"}, 1]])
        power_on(self.root, board=board, sensor="mpu6050")
        self.assertIn("mpu6050", board.only("error")["expected"])

    def test_wrong_id_once_is_not_believed(self):
        board = self.with_faults([{"kind": "wrong_id", "at": 0, "value": 0x12}])
        self.assertEqual(board.only("hello")["who_am_i"], [0x68, 0x68])
        self.assertEqual(board.only("solved")["verdict"], "good")

    def test_chip_asleep_in_mid_capture(self):
        for kind in ("reset", "sleep"):
            root = self.path(kind)
            os.mkdir(root)
            board = power_on(root, {"faults": [{"kind": kind, "at_ms": 20200}]})
            self.assertTrue(board.named("bus_error"), kind)
            self.assertEqual(len(board.named("pose")), 12, kind)
            self.assertEqual(board.only("solved")["verdict"], "good", board.only("solved"))

    def test_chip_asleep_never_enters_a_pose(self):
        # whenever it happens in a capture of two and a half seconds
        for at_ms in range(8600, 11600, 370):
            root = self.path(str(at_ms))
            os.mkdir(root)
            power_on(root, {"dwell_s": 8.0, "order": ["Z+a", "Z+b"],
                            "faults": [{"kind": "sleep", "at_ms": at_ms}]}, timeout_s=10)
            for p in read_blocks(self.read(str(at_ms) + "/refused.bin")).placements:
                self.assertGreater(p.noise[0], 30.0, at_ms)

    def test_stuck_bus_is_freed_by_hand(self):
        for flavour in ("rp2", "esp32", "stm32", "soft", "linux"):
            root = self.path(flavour)
            os.mkdir(root)
            board = power_on(root, {"flavour": flavour, "faults": [
                {"kind": "stuck_sda", "at_ms": 20200}]})
            actions = [e["action"] for e in board.named("bus_error")]
            self.assertIn("recovered", actions, flavour)
            self.assertEqual(len(board.named("pose")), 12, flavour)
            self.assertEqual(board.only("solved")["verdict"], "good", flavour)

    def test_noisy_bus_loses_nothing(self):
        board = self.with_faults([{"kind": "nak", "rate": 0.01},
                                  {"kind": "timeout", "every": 997}])
        self.assertGreater(board.named("bus_error")[-1]["count"], 20)
        self.assertEqual(board.only("solved")["verdict"], "good")
        self.assertEqual(len(read_blocks(self.read("capture.bin")).placements), 12)

    def test_cable_off_for_good_in_mid_session(self):
        board = SimulatedBoard(
            worlds.make(dict(SHORT_WORLD, faults=[{"kind": "unplugged", "at_ms": 30000}])),
            self.root, [["solved", {"cmd": "stop"}, 1]])
        power_on(self.root, board=board)
        self.assertEqual(board.only("solved")["verdict"], "refused")
        self.assertIn("no longer answers", board.only("solved")["reason"])
        self.assertGreater(len(read_blocks(self.read("refused.bin")).placements), 3)

    def test_ctrl_c_comes_through_and_the_capture_is_readable(self):
        board = SimulatedBoard(worlds.make(SHORT_WORLD), self.root, limit_s=30.0)
        with self.assertRaises(TooLong):
            power_on(self.root, board=board)
        self.assertGreater(len(read_blocks(self.read("refused.bin")).placements), 2)


class TestRecordsThatDoNotFit(Folder):
    def test_both_slots_damaged(self):
        self.calibrated()
        data = self.read("record_a.bin")
        self.write("record_a.bin", data[:-1])
        self.write("record_b.bin", b"\0" * len(data))
        board = power_on(self.root, STILL, timeout_s=6)
        reason = board.only("no_record")["reason"]
        self.assertIn("slot a", reason)
        self.assertIn("slot b", reason)
        self.assertEqual(len(board.named("calibrating")), 1)

    def test_one_damaged_slot_leaves_the_other(self):
        self.calibrated()
        self.write("record_b.bin", b"rubbish")
        board = power_on(self.root, STILL)
        self.assertEqual(board.only("record")["slot"], "a")
        self.assertIn("b", board.only("record")["refused"])

    def test_one_no_sensor_has_and_its_board_calibrates_anew(self):
        self.calibrated()
        whole = correction_record.decode(self.read("record_a.bin"))
        changes = ({"g": 0.0}, {"sequence": 0xFFFFFFFF},
                   {"mounting": {"roll_deg": 0.0, "pitch_deg": 0.0, "order": "xyz",
                                 "axes": "x y y", "frame": "ned"}},
                   {"accel": dict(whole.accel, P=[[0.0] * 3] * 3 + [[0.0, 0.0, 0.0, 1.0]])})
        for seed, change in enumerate(changes):
            record = correction_record.decode(self.read("record_a.bin"))
            for name in change:
                setattr(record, name, change[name])
            self.write("record_b.bin", correction_record.encode(record))
            os.remove(self.path("record_a.bin"))
            board = power_on(self.root, {"seed": 9 + seed}, [["hello", {"cmd": "calibrate"}, 1],
                                                             STOP_WHEN_READY])
            self.assertTrue(board.only("saved")["written"], change)
            self.assertTrue(board.only("ready")["corrected"])

    def test_other_chip_and_other_range(self):
        self.calibrated()
        board = power_on(self.root, dict(STILL, sensor="gy85"), timeout_s=6)
        self.assertIn("mpu6050", board.only("no_record")["reason"])
        board = power_on(self.root, dict(STILL, who_am_i=0x70), timeout_s=6)
        self.assertIn("0x70", board.only("no_record")["reason"])
        record = correction_record.decode(self.read("record_a.bin"))
        record.accel_range_g, record.accel_lsb_per_g = 8, 4096
        self.write("record_a.bin", correction_record.encode(record))
        board = power_on(self.root, STILL, timeout_s=6)
        self.assertIn("8 g", board.only("no_record")["reason"])
        record.accel_range_g = 2
        self.write("record_a.bin", correction_record.encode(record))
        board = power_on(self.root, STILL, timeout_s=6)
        self.assertIn("4096.0 counts per g", board.only("no_record")["reason"])

    def test_bias_is_not_poisoned_by_a_robot_that_moves(self):
        self.calibrated()
        board = power_on(self.root, dict(SHORT_WORLD, first_rest_s=0.7, dwell_s=0.3), rest_s=2)
        rest = board.only("rest")
        self.assertFalse(rest["still"])
        self.assertEqual(rest["bias"], "stored")
        record = correction_record.decode(self.read("record_a.bin"))
        for k in range(3):
            self.assertAlmostEqual(rest["bias_dps"][k], record.gyro_bias["bias_dps"][k], places=5)
