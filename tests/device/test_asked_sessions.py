"""A plan asked for, and a face of the session before taken again: firmware on simulated chips."""

import json
import unittest

import numpy as np
from test_power_up import STILL, Folder

from sixflip.capture.reader import read as read_blocks
from sixflip.poses.faces import pose_name
from sixflip_device.session import redo_session, session_request
from sixflip_host.capture import capture_binary
from tests.worlds.simulated_board import QUICK, STOP_WHEN_READY, power_on

FACES = "Z+a Z+b X+a X+b Y-a Y-b Z-a Z-b X-a X-b Y+a Y+b"
BACK = "Y+b X-a Z+a"
PLAN = FACES + " L1 L2 " + BACK


def order(names):
    up = {"L1": [0.6, 0.64, 0.48], "L2": [-0.5, 0.5, -0.7]}
    return [{"pose": n, "up": up[n]} if n in up else n for n in names.split()]


class Plan(Folder):
    def flag(self, **request):
        self.write("calibrate.flag", json.dumps(request).encode())

    def placements(self, name="capture.bin"):
        return read_blocks(self.read(name)).placements

    def test_leaning_poses_and_repeats_in_the_order_planned(self):
        self.flag(poses=PLAN, samples=[100 + 25 * (k % 3) for k in range(17)], rest_s=8)
        board = power_on(self.root, {"order": order(PLAN), "first_rest_s": 12.0})
        self.assertIn(board.only("solved")["verdict"], ("good", "doubtful"))
        placements = self.placements()
        self.assertEqual(" ".join([pose_name(p.pose) for p in placements]), PLAN)
        self.assertEqual([p.n for p in placements], [100 + 25 * (k % 3) for k in range(17)])
        capture = capture_binary.decode(self.read("capture.bin"))
        end = placements[-1].first + placements[-1].n
        self.assertGreaterEqual(capture.t_us[-1] - capture.t_us[end], 7900000)
        self.assertGreaterEqual(capture.t_us[placements[0].first], 8000000)
        self.assertTrue(capture.temp.any())
        resting = [e for e in board.named("state") if e["state"] == "resting"]
        self.assertEqual({e.get("of", 17) for e in resting}, {17})
        self.assertNotIn("calibrate.flag", self.files())

    def test_the_next_pose_is_told_by_its_place_in_the_plan(self):
        self.flag(poses="Z+a X+a Z+a", samples=100)
        board = power_on(self.root, {"order": ["Z+a", "X+a", "Z+a"]})
        self.assertEqual([(e["next"], e["at"]) for e in board.named("pose")],
                         [(["X+a"], 1), (["Z+a"], 2), ([], 3)])
        self.assertEqual(board.only("solved")["verdict"], "refused")  # three faces are no solve

    def test_the_wrong_face_is_named_and_the_right_one_goes_on(self):
        self.flag(poses="Z+a X+a", samples=100)
        board = power_on(self.root, {"order": ["Z+a", "Y-a", "X+a"]})
        refused = board.only("refused")
        self.assertEqual((refused["reason"], refused["value"], refused["limit"],
                          refused["unit"]), ("wrong face", 5, 2, "face"))
        self.assertEqual(len(self.placements("refused.bin")), 2)

    def test_undo_takes_back_the_last_placement_alone(self):
        self.flag(poses="Z+a X+a Z+a Y+a", samples=100)
        board = power_on(
            self.root, {"order": ["Z+a", "X+a", "Z+a", "X+b", "Z+a", "Y+a"]}, answers=[
                STOP_WHEN_READY, [lambda e: e["event"] == "pose" and e["at"] == 3,
                                  {"cmd": "undo"}, 1]])
        self.assertEqual(board.only("redo")["face"], "Z+a")
        self.assertEqual([pose_name(p.pose) for p in self.placements("refused.bin")],
                         ["Z+a", "X+a", "Z+a", "Y+a"])
        blocks = read_blocks(self.read("refused.bin"))
        self.assertEqual((blocks.complete, blocks.withdrawn), (True, [1]))

    def test_a_plan_over_the_serial_line(self):
        self.calibrated()
        board = power_on(self.root, dict(STILL, order=["Z+a", "Z+b"], first_rest_s=12.0), answers=[
            ["ready", {"cmd": "calibrate", "poses": "Z+a", "samples": 100}, 1],
            ["capture", {"cmd": "stop"}, 2], STOP_WHEN_READY])
        self.assertEqual(board.only("calibrating")["missing"], ["Z+a"])

    def test_plans_that_make_no_sense_start_nothing(self):
        self.calibrated()
        for text, why in (('{"poses": "Z+c"}', "no pose is called"), ("[1]", "JSON object"),
                          ("{", "cannot be understood"), ('{"poses": ["Z+a"]}', "poses"),
                          ('{"poses": "Z+a", "samples": 3}', "samples is 3"),
                          ('{"poses": "Z+a", "samples": [90, 90]}', "1 poses and 2"),
                          ('{"poses": "Z+a", "rest_s": -1}', "rest_s is -1"),
                          ('{"redo": "Q"}', "without a face"),
                          ('{"poses": "%s"}' % ("Z+a " * 201), "1 to 200 names"),
                          (" " * 5000, "more than 4096")):
            self.write("calibrate.flag", text.encode())
            board = power_on(self.root, STILL)
            self.assertIn(why, board.only("error")["what"])
            self.assertEqual(board.named("calibrating"), [])
            self.assertEqual(self.read("capture.bin")[:4], b"6CAP")

    def test_an_empty_request_is_the_ordinary_session(self):
        for request in ({}, {"cmd": "calibrate"}):
            asked = session_request.parse(request, 400)
            self.assertEqual((asked.plan, asked.goes_on, asked.record), (None, False, False))


class Redo(Folder):
    """One face of the session before."""

    def redo(self, face="X+", **world):
        self.write("calibrate.flag", json.dumps({"redo": face}).encode())
        spec = dict({"order": [face + "a", face + "b"], "first_rest_s": 6.0}, **world)
        return power_on(self.root, spec)

    def test_a_face_that_is_missing_after_a_time_out(self):
        board = power_on(self.root, {"mishaps": [{"kind": "missing", "pose": "Y-"}]})
        self.assertEqual(board.only("solved")["verdict"], "refused")
        old = read_blocks(self.read("refused.bin"))
        self.assertEqual(len(old.placements), 10)
        board = self.redo("Y-")
        self.assertEqual(board.only("calibrating")["missing"], ["Y-a", "Y-b"])
        self.assertIn(board.only("solved")["verdict"], ("good", "doubtful"))
        self.assertEqual(self.files(), ["capture.bin", "record_a.bin"])
        new = read_blocks(self.read("capture.bin"))
        self.assertTrue(new.complete)
        n = old.placements[-1].first + old.placements[-1].n
        self.assertEqual((list(new.t_us[:n]), new.rows[:7 * n]),
                         (list(old.t_us[:n]), old.rows[:7 * n]))
        self.assertGreater(new.t_us[n], old.t_us[-1] + 60000000)
        self.assertIn("Y- again", new.notes[-1])
        self.sums_agree()

    def sums_agree(self, name="capture.bin"):
        capture = capture_binary.decode(self.read(name))
        self.assertEqual(len(capture.board_placements), 12)
        for p in capture.board_placements:
            rows = np.column_stack([capture.accel, capture.gyro, capture.temp])
            self.assertEqual(p.sums, rows[p.first:p.first + p.n].sum(axis=0, dtype=int).tolist())

    def test_a_face_that_was_crooked(self):
        """The session before was accepted all the same, or refused: its last one counts."""
        power_on(self.root, {"mishaps": [{"kind": "crooked", "pose": "X+", "deg": 9.0}]})
        board = self.redo("X+")
        self.assertEqual(board.only("calibrating")["missing"], ["X+a", "X+b"])
        self.assertEqual(board.only("solved")["verdict"], "good")
        self.assertAlmostEqual(board.only("solved")["tilt_deg"], 2.0, delta=0.1)
        self.sums_agree()

    def test_any_number_of_times(self):
        """The samples and flips of all else stay, the capture does not grow."""
        self.calibrated()
        first = read_blocks(self.read("capture.bin"))
        for face in ("X+", "X+", "Y-", "X+"):
            board = self.redo(face)
            solved, capture = board.only("solved"), board.only("capture")
            self.assertEqual((solved["verdict"], solved["gyro"]["verdict"]), ("good", "good"))
            self.assertEqual(solved["gyro"]["reason"][:7], "6 flips")
            self.assertEqual(capture["kept"], capture["samples"])
            newest = [name for name in ("unsaved.bin", "capture.bin") if name in self.files()][0]
            self.sums_agree(newest)
            self.assertLess(len(self.read(newest)), 20 * (len(first.t_us) + 2500))

    def test_there_is_no_room_for_a_copy(self):
        self.calibrated()
        before = self.files(), self.read("capture.bin")
        real, redo_session.free_bytes = redo_session.free_bytes, lambda root: 100000
        try:
            board = self.redo("X+", **STILL)
        finally:
            redo_session.free_bytes = real
        self.assertIn("100000 bytes are free, a copy", board.only("error")["what"])
        self.assertEqual((self.files(), self.read("capture.bin")), before)

    def test_over_the_serial_line_when_ready(self):
        self.calibrated()
        answers = [["ready", {"cmd": "redo", "face": "X+"}, 1], STOP_WHEN_READY]
        answers[1] = ["solved", {"cmd": "stop"}, 1]
        board = power_on(self.root, {"order": [], "first_rest_s": 9.0}, answers=answers + [
            [lambda e: e["event"] == "state" and e.get("missing") == ["X+a", "X+b"],
             {"cmd": "stop"}, 1]])
        self.assertEqual(board.only("calibrating")["missing"], ["X+a", "X+b"])
        self.assertEqual(self.files(), ["capture.bin", "record_a.bin", "refused.bin"])

    def test_a_power_cut_in_the_session_before(self):
        power_on(self.root, {"mishaps": [{"kind": "missing", "pose": "Y-"}]})
        self.write("refused.bin", self.read("refused.bin")[:-40])
        self.assertEqual(self.redo("Y-").only("solved")["verdict"], "good")
        self.sums_agree()

    def test_what_cannot_be_repaired(self):
        board = self.redo("X+", **STILL)
        self.assertIn("there is no session before", board.named("error")[0]["what"])
        self.calibrated()
        self.assertIn("warmer than in the session before, 3 is the limit",
                      self.redo("X+", temperature_c=35.0, **STILL).only("error")["what"])
        self.assertIn("colder", self.redo("X+", temperature_c=15.0, **STILL).only("error")["what"])
        self.assertIn("sensor was mpu6050",
                      self.redo("X+", sensor="adxl345", **STILL).named("error")[0]["what"])
        self.write("capture.bin", b"6CAP")
        self.assertIn("cut off", self.redo("X+", **STILL).only("error")["what"])
        self.assertNotIn("capture.new", self.files())

    def test_of_a_session_that_kept_only_the_sums(self):
        from sixflip_device.capture import store
        real, store.free_bytes = store.free_bytes, lambda root: 30000
        try:
            power_on(self.root)
        finally:
            store.free_bytes = real
        board = self.redo("X+")
        self.assertEqual(board.only("solved")["verdict"], "good")
        self.assertTrue(board.only("capture")["sums_only"])
        self.assertEqual(len(read_blocks(self.read("capture.bin")).placements), 12)


if __name__ == "__main__":
    assert QUICK
    unittest.main()
