"""A corrected |a| at rest that is no longer g is said while samples are streamed, once."""

import tempfile
import unittest

from sixflip_sim import worlds
from tests.worlds.simulated_board import SHORT_WORLD, SimulatedBoard, power_on


class Streaming(SimulatedBoard):
    """Rests; steps [(seconds since it streams, accelerometer's scale)], at None it stops."""

    steps = ()

    def read_line(self):
        ready = self.named("ready")
        if ready and self.steps:
            at, scale = self.steps[0]
            if self.world.clock.now_us() / 1e6 > ready[0]["at_s"] + at:
                self.steps = self.steps[1:]
                if scale is None:
                    return '{"cmd": "stop"}'
                matrix = [[scale * x for x in row] for row in self.world.truth.accel_matrix]
                self.world.chips[0].model = worlds.make(
                    dict(self.world.spec, accel_matrix=matrix)).model
        return SimulatedBoard.read_line(self)


def streamed(steps, answers=(), then=None, **world):
    """The board after a calibration and a power-up with these steps; then: what of its world
    is other by then, by itself it lies still."""
    world = dict(SHORT_WORLD, **world)
    still = {"order": [], "first_rest_s": 60.0}
    with tempfile.TemporaryDirectory() as root:
        power_on(root, world)
        board = Streaming(worlds.make(dict(world, **(then or still))), root, answers)
        board.steps = steps
        return power_on(root, board=board)


class GravityWatch(unittest.TestCase):
    def test_a_scale_that_is_6_percent_off_in_the_stream_is_said_once(self):
        for sensor in ("mpu6050", "gy85", "adxl345"):
            board = streamed([(1, 1.06), (20, None)], sensor=sensor)
            self.assertEqual(board.only("rest")["verdict"], "good")
            self.assertAlmostEqual(board.only("gravity")["a_error_mg"], 60.0, delta=3.0)

    def test_it_is_said_again_after_it_was_right_in_between(self):
        board = streamed([(1, 1.06), (13, 1.0), (25, 0.94), (37, None)])
        found = [round(e["a_error_mg"], -1) for e in board.named("gravity")]
        self.assertEqual(found, [60, -60])

    def test_a_host_that_asks_for_the_stream_later_is_told_as_well(self):
        board = streamed([(1, 1.06), (20, None)], (("gravity", {"cmd": "stream", "hz": 5}, 1),))
        self.assertEqual(len(board.named("gravity")), 2)

    def test_a_calibration_that_holds_is_not_spoken_of(self):
        for sensor in ("mpu6050", "gy85", "adxl345"):
            board = streamed([(30, None)], sensor=sensor)
            self.assertTrue(board.only("ready")["corrected"])
            self.assertEqual(board.named("gravity"), [])

    def test_the_check_that_follows_says_so_too(self):
        board = streamed([(1, 1.06), (25, None)], (("gravity", {"cmd": "check"}, 1),))
        self.assertEqual(board.only("check")["verdict"], "doubtful")
        self.assertIn("mg off, 5 is the limit", board.only("check")["words"][0])

    def test_a_box_that_is_turned_over_by_hand_is_not_spoken_of(self):
        turned = {"order": ["Z+a", "X+a", "Y-b", "Z-a"], "dwell_s": 12.0, "tremor_mg": 30.0}
        board = streamed([(60, None)], then=turned)
        self.assertTrue(board.only("ready")["corrected"])
        self.assertEqual(board.named("gravity"), [])


if __name__ == "__main__":
    unittest.main()
