"""A session that was stopped, timed out or cut off goes on; what the live state says."""

import json

from test_power_up import STILL, Folder

from sixflip.capture.reader import read as read_blocks
from sixflip.poses.faces import pose_name
from tests.worlds.simulated_board import STOP_WHEN_READY, power_on

FIRST = ["Z+a", "Z+b", "X+a"]
REST = ["X+a", "X+b", "Y+a", "Y+b", "Z-a", "Z-b", "X-a", "X-b", "Y-a", "Y-b"]


def after(pose, command):
    return [lambda e: e["event"] == "pose" and e["pose"] == pose, command, 1]


class Continued(Folder):
    def stopped(self):
        """A session that the host ended after three poses."""
        board = power_on(self.root, {"order": FIRST}, answers=[
            after("X+a", {"cmd": "stop"}), STOP_WHEN_READY])
        self.assertEqual(board.only("solved")["reason"], "stopped by the host")
        return board

    def go_on(self, order, **world):
        self.write("calibrate.flag", json.dumps({"continue": True}).encode())
        return power_on(self.root, dict(world, order=order))

    def test_the_faces_captured_stay_and_a_half_one_is_taken_again(self):
        self.stopped()
        board = self.go_on(REST)
        self.assertEqual(len(board.only("calibrating")["missing"]), 10)
        self.assertNotIn("Z+a", board.only("calibrating")["missing"])
        self.assertIn(board.only("solved")["verdict"], ("good", "doubtful"))
        blocks = read_blocks(self.read("capture.bin"))
        self.assertEqual([pose_name(p.pose) for p in blocks.placements], ["Z+a", "Z+b"] + REST)
        self.assertIn("continued, after a pause", blocks.notes[-1])
        gyro = board.only("solved")["gyro"]
        self.assertEqual((gyro["verdict"], gyro["reason"][:7]), ("good", "6 flips"))
        self.assertEqual(self.files(), ["capture.bin", "record_a.bin"])

    def test_with_nothing_before_it_begins_afresh(self):
        board = self.go_on(FIRST, first_rest_s=6.0)
        self.assertIn("no session before", board.only("afresh")["reason"])
        self.assertEqual(len(board.only("calibrating")["missing"]), 12)

    def test_with_nothing_missing_it_begins_afresh(self):
        self.calibrated()
        board = self.go_on(FIRST)
        self.assertIn("nothing is missing", board.only("afresh")["reason"])
        self.assertEqual(len(board.only("calibrating")["missing"]), 12)

    def test_a_plan_does_not_go_on_as_six_faces(self):
        self.write("calibrate.flag", json.dumps({"poses": "Z+a L1", "samples": 100}).encode())
        power_on(self.root, {"order": ["Z+a", {"pose": "L1", "up": [0.6, 0.64, 0.48]}]})
        self.assertIn("plan", self.go_on([]).only("afresh")["reason"])

    def test_without_a_record_it_goes_on_at_the_next_power_up(self):
        """What was promised to stay on the board is what goes on."""
        self.stopped()
        board = power_on(self.root, {"order": REST[:4]}, answers=[
            after("Y+b", {"cmd": "stop"}), STOP_WHEN_READY])
        self.assertEqual(board.only("calibrating")["missing"][0], "Z-a")
        board = self.go_on(REST[4:])
        self.assertEqual(board.only("calibrating")["missing"], [
            "Z-a", "Z-b", "X-a", "X-b", "Y-a", "Y-b"])
        self.assertEqual(board.only("solved")["verdict"], "good")

    def test_a_session_of_its_own_that_is_cut_off_drops_no_face(self):
        self.stopped()
        power_on(self.root, dict(STILL, order=[]), answers=[
            ["calibrating", {"cmd": "stop"}, 1], STOP_WHEN_READY])
        self.assertEqual(len(self.go_on(REST).only("calibrating")["missing"]), 10)

    def test_it_goes_on_over_the_serial_line(self):
        self.stopped()
        board = power_on(self.root, dict(STILL, order=[]), answers=[
            ["grace", {"cmd": "calibrate", "continue": True}, 1],
            ["calibrating", {"cmd": "stop"}, 1], STOP_WHEN_READY])
        self.assertEqual(len(board.only("calibrating")["missing"]), 10)


class Live(Folder):
    def test_the_state_carries_the_vector_a_few_times_a_second(self):
        board = power_on(self.root)
        told = [e for e in board.named("state") if "live" in e]
        self.assertTrue(all(len(e["live"]) == 6 for e in told))
        taking = [e for e in told if e["state"] == "capturing" and e["pose"] == "X-a"]
        self.assertLess(taking[-1]["live"][0], -850)
        self.assertLess(abs(taking[-1]["live"][1]), 150)
        turning = max(abs(v) for e in told for v in e["live"][3:])
        self.assertGreater(turning, 60)    # half a turn in 1.5 s
        span = told[-1]["at_s"] - told[0]["at_s"]
        self.assertGreater(len(told) / span, 2)

    def test_what_is_missing_is_said_at_every_change_and_every_two_seconds(self):
        told = power_on(self.root).named("state")
        whole = [e["at_s"] for e in told if "missing" in e]
        self.assertLess(len(whole), len(told) / 2)
        self.assertLess(max(b - a for a, b in zip(whole, whole[1:])), 2.6)
