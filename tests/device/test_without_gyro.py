"""An ADXL345 alone on a level table: a half turn changes no reading, only the hand shows."""

import shutil
import tempfile
import unittest

from tests.worlds.simulated_board import power_on

SLOWLY = {"sensor": "adxl345", "tilt_deg": 0.0, "dwell_s": 8.0, "move_s": 4.0}


class AccelerometerAlone(unittest.TestCase):
    def solved(self, **world):
        root = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, root)
        board = power_on(root, dict(SLOWLY, **world), timeout_s=20)
        self.assertIn("lift the box", " ".join(board.only("hello")["report"]))
        return board.only("solved")

    def test_a_hand_is_seen_by_its_tremor(self):
        for tremor_mg in (10.0, 40.0):
            solved = self.solved(tremor_mg=tremor_mg)
            self.assertEqual(solved["verdict"], "good", solved["reason"])
            self.assertLess(abs(solved["tilt_deg"]), 0.05)
            self.assertNotIn("gyro", solved)

    def test_what_turns_without_a_tremor_is_not_seen_and_it_says_what_to_do(self):
        solved = self.solved()
        self.assertEqual(solved["verdict"], "refused")
        self.assertIn("when the box is lifted", solved["reason"])

    def test_put_back_as_it_was_is_no_good_correction(self):
        """Lifted and put down as it lay: taken as a flip, and found out by the other faces."""
        order = ["Z+a", "Z+a"] + [face + letter for face in ("Z-", "X+", "X-", "Y+", "Y-")
                                  for letter in "ab"]
        solved = self.solved(tremor_mg=20.0, tilt_deg=2.0, move_s=2.0, order=order)
        self.assertEqual(solved["verdict"], "refused")
        self.assertIn("Z+", solved["reason"])


if __name__ == "__main__":
    unittest.main()
