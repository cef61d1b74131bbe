"""A chip that answers with one reading over and over, while its numbers are streamed."""

import json
import shutil
import tempfile
import unittest

from sixflip.poses.still_window import SAME
from sixflip_device.imu import CorrectedImu
from sixflip_sim import worlds
from tests.worlds.simulated_board import SHORT_WORLD, SimulatedBoard, power_on

RATE_HZ = 50


class Counting(SimulatedBoard):
    """Stops after as many samples, or at a time."""

    def __init__(self, world, root, samples, until_s):
        SimulatedBoard.__init__(self, world, root)
        self.samples = samples
        self.until_s = until_s

    def read_line(self):
        if len(self.named("sample")) >= self.samples or \
                self.world.clock.now_us() > self.until_s * 1e6:
            return json.dumps({"cmd": "stop"})
        return None


class Hanging(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.mkdtemp()
        power_on(self.root, {"sensor": "gy85"})

    def tearDown(self):
        shutil.rmtree(self.root)

    def board(self, *faults, samples=600, until_s=40):
        world = worlds.make(dict(SHORT_WORLD, order=[], first_rest_s=100.0, sensor="gy85",
                                 faults=list(faults)))
        return Counting(world, self.root, samples, until_s)

    def streamed(self, *faults):
        return power_on(self.root, board=self.board(*faults), stream_hz=RATE_HZ, rate_hz=RATE_HZ)

    def test_what_repeats_itself_is_not_sent(self):
        for address in (0x53, 0x68):
            board = self.streamed({"kind": "frozen", "at_ms": 15000, "for_ms": 5000,
                                   "address": address})
            at = [e["at_s"] for e in board.named("sample")]
            before = [t for t in at if t < 15.0 + (SAME + 2) / RATE_HZ]
            self.assertGreater(len(before), 50)
            self.assertEqual([t for t in at if before[-1] < t < 19.9], [], hex(address))
            self.assertGreater(at[-1], 20.5)
            self.assertIn("hangs", board.named("error")[0]["what"])

    def test_the_chip_is_set_up_anew(self):
        board = self.streamed({"kind": "frozen", "at_ms": 15000, "for_ms": 5000,
                               "address": 0x53})
        self.assertIn("recovered", [e["action"] for e in board.named("bus_error")])

    def test_for_ever(self):
        """The host is heard, and it is not said over and over."""
        board = self.streamed({"kind": "frozen", "at_ms": 15000, "address": 0x53})
        board.only("error")
        self.assertLess(board.named("sample")[-1]["at_s"], 15.0 + (SAME + 2) / RATE_HZ)
        self.assertLess(len(board.named("bus_error")), 20)
        self.assertEqual(board.names()[-1], "stopped")

    def test_your_own_program_is_told(self):
        board = self.board({"kind": "frozen", "at_ms": 15000, "for_ms": 5000, "address": 0x53})
        imu = CorrectedImu(board, rest_s=0)

        def read():
            board.world.clock.sleep_us(1000000 // RATE_HZ)
            return imu.read()

        while board.world.clock.now_us() < 15000000:
            read()
        with self.assertRaises(OSError) as told:
            for _ in range(SAME + 1):
                read()
        self.assertIn("hangs", str(told.exception))
        board.world.clock.sleep_us(6000000)
        self.assertAlmostEqual(sum([x * x for x in read()[:3]]) ** 0.5, 9.81, delta=0.3)


if __name__ == "__main__":
    unittest.main()
