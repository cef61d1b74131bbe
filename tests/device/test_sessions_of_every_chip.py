"""A whole session of every chip by the real firmware: calibrated, corrected after a power cycle,
through a reset of the chip, a bus that fails and a supply that is cut while it saves."""

import tempfile
import unittest

from sixflip.chips import catalogue
from sixflip.record import correction_record
from sixflip_sim import worlds
from tests.worlds.simulated_board import SHORT_WORLD, power_on

CHIPS = [name for name in catalogue.SENSORS if name not in worlds.SEEN]
# A few of everything, at random times: read again, freed, identified, set up anew.
STORM = [{"kind": "nak", "rate": 0.002, "seed": 4}, {"kind": "timeout", "at_ms": 14000},
         {"kind": "reset", "at_ms": 22000}, {"kind": "stuck_sda", "at_ms": 31000},
         {"kind": "sleep", "at_ms": 43000}, {"kind": "garbled", "at_ms": 47000},
         {"kind": "data_nak", "at_ms": 21990}]
RANGES = {"accel_range_g": 8, "gyro_range_dps": 2000, "rate_hz": 200}


def session(sensor, root, faults=(), **changes):
    return power_on(root, {"sensor": sensor, "faults": list(faults)}, **changes)


class EveryChip(unittest.TestCase):
    def test_a_session_at_the_chips_own_range(self):
        for sensor in CHIPS:
            with tempfile.TemporaryDirectory() as root:
                board = session(sensor, root)
                solved = board.only("solved")
                self.assertEqual((sensor, solved["verdict"]), (sensor, "good"), solved)
                self.assertTrue(abs(solved["tilt_deg"] - SHORT_WORLD["tilt_deg"]) < 0.1)
                with open(root + "/record_a.bin", "rb") as file:
                    record = correction_record.decode(file.read())
                truth = board.world.truth
                for i in range(3):
                    product = sum([record.accel["P"][k][i] * truth.accel_matrix[k][i]
                                   for k in range(3)])
                    self.assertTrue(abs(product - 1.0) < 2e-3, (sensor, i, product))
                again = power_on(root, {"sensor": sensor, "order": []})
                self.assertTrue(again.only("ready")["corrected"])

    def test_through_a_storm_at_a_wider_range_and_a_faster_rate(self):
        for sensor in CHIPS:
            with tempfile.TemporaryDirectory() as root:
                board = session(sensor, root, STORM, **RANGES)
                solved = board.only("solved")
                self.assertIn(solved["verdict"], ("good", "doubtful"), solved)
                self.assertTrue(len(board.named("bus_error")) > 3)
                self.assertEqual(len({e["pose"] for e in board.named("pose")}), 12)
                with open(root + "/record_a.bin", "rb") as file:
                    record = correction_record.decode(file.read())
                self.assertEqual(record.accel_range_g, 8)
                self.assertTrue(record.gyro_range_dps >= 2000)
                # a correction is for one range: at another it is refused, and says so
                other = power_on(root, {"sensor": sensor, "order": []}, timeout_s=6)
                reason = other.only("no_record")["reason"]
                self.assertIn("it is for the ranges 8 g and", reason)


if __name__ == "__main__":
    unittest.main()
