"""Flips that were no half turns, on the board: by an earlier session's gyro, or 180 assumed."""

import math
import os
import unittest

from test_power_up import Folder

from sixflip.record import correction_record
from tests.worlds.simulated_board import power_on

SQUARE = {"tilt_deg": 2.0, "seed": 5}


def error_mg(record, truth):
    """RMS over all directions of what the record leaves of the world's errors."""
    P, A, b = record.accel["P"], truth.accel_matrix, truth.accel_bias
    g = 9.80665
    E = [[sum([P[k][i] * A[k][j] for k in range(3)]) - (i == j) for j in range(3)]
         for i in range(3)]
    o = [sum([P[k][i] * b[k] for k in range(3)]) / g + P[3][i] / g for i in range(3)]
    return 1e3 * math.sqrt(sum([x * x for row in E for x in row]) / 3 + sum([x * x for x in o]))


class TestFlipAngles(Folder):
    def session(self, name, **world):
        """(solved event, record) of a calibration asked for by the flag."""
        self.write("calibrate.flag", b"")
        board = power_on(self.root, dict(SQUARE, **world))
        record = correction_record.decode(self.read(name))
        return board.only("solved"), record, error_mg(record, board.world.truth)

    def test_180_degrees_until_a_gyro_was_calibrated(self):
        solved, record, _ = self.session("record_a.bin", flip_error_deg=0.0)
        self.assertEqual(solved["flips"]["taken_as"], "180 degrees")
        self.assertIn("no gyro was calibrated in an earlier session", solved["flips"]["reason"])
        self.assertIsNone(record.flips)
        self.assertEqual(solved["gyro"]["verdict"], "good")
        solved, record, mg = self.session("record_b.bin", flip_error_deg=10.0)
        self.assertEqual(solved["flips"]["taken_as"], "measured", solved["flips"])
        self.assertEqual(record.flips["sequence"], 1)
        for face in solved["flips"]["angles_deg"]:
            off = abs(solved["flips"]["angles_deg"][face] - 180.0)
            self.assertAlmostEqual(off, 180.0 / math.pi * abs(
                record.flips["excess"]["Z+ Z- X+ X- Y+ Y-".split().index(face)]), places=3)
        self.assertLess(mg, 0.6)
        from sixflip_host.cli import main
        self.assertEqual(main(["verify", self.root]), 0)
        record.flips["excess"][3] += 1e-6
        self.write("record_b.bin", correction_record.encode(record))
        self.assertEqual(main(["verify", self.root]), 1)

    def test_a_stored_gyro_that_is_doubtful_is_not_asked(self):
        self.session("record_a.bin", flip_error_deg=0.0)
        record = correction_record.decode(self.read("record_a.bin"))
        record.gyro["verdict"] = "doubtful"
        self.write("record_a.bin", correction_record.encode(record))
        solved, record, _ = self.session("record_b.bin", flip_error_deg=10.0)
        self.assertEqual(solved["flips"]["reason"], "the stored gyro is doubtful")
        self.assertIsNone(record.flips)


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.abspath(__file__)))
    unittest.main()
