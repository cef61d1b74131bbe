"""The whole firmware around a simulated world: first power-up, second, what is asked of it."""

import json
import os
import shutil
import tempfile
import unittest

from sixflip.capture.reader import read as read_blocks
from sixflip.record import correction_record
from sixflip_device import power_up
from sixflip_sim import worlds
from tests.worlds.simulated_board import (
    SHORT_WORLD,
    STOP_WHEN_READY,
    SimulatedBoard,
    power_on,
)

STILL = {"order": [], "first_rest_s": 30.0, "tilt_deg": 2.0}


class Folder(unittest.TestCase):
    first = {}      # {world: (board, {name: bytes}) after its first power-up}

    def setUp(self):
        self.root = tempfile.mkdtemp()

    def tearDown(self):
        shutil.rmtree(self.root)

    def path(self, name):
        return os.path.join(self.root, name)

    def files(self):
        return sorted(os.listdir(self.root))

    def read(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def write(self, name, data):
        with open(self.path(name), "wb") as f:
            f.write(data)

    def calibrated(self, **world):
        """A first power-up that ends with a record on the flash; in each world it is run once."""
        self.assertEqual(self.files(), [])
        asked = json.dumps(world, sort_keys=True)
        if asked not in self.first:
            board = power_on(self.root, world)
            self.assertIn(board.only("solved")["verdict"], ("good", "doubtful"))
            self.first[asked] = board, {name: self.read(name) for name in self.files()}
        board, files = self.first[asked]
        for name, data in files.items():
            self.write(name, data)
        return board


class TestFirstPowerUp(Folder):
    def test_from_the_chip_to_the_record(self):
        board = self.calibrated()
        self.assertEqual(board.names()[:5],
                         ["hello", "selftest", "grace", "no_record", "calibrating"])
        self.assertEqual(self.files(), ["capture.bin", "record_a.bin"])
        solved = board.only("solved")
        self.assertEqual(solved["level"], "tilt solved")
        self.assertAlmostEqual(solved["tilt_deg"], 2.0, delta=0.05)
        record = correction_record.decode(self.read("record_a.bin"))
        self.assertEqual(record.sequence, 1)
        self.assertEqual(record.chip, "mpu6050")
        # P undoes what the world did to the samples: m = A t + b
        truth = board.world.truth
        for i in range(3):
            up = [9.80665 if k == i else 0.0 for k in range(3)]
            m = [sum(truth.accel_matrix[r][k] * up[k] for k in range(3)) + truth.accel_bias[r]
                 for r in range(3)]
            got = [sum(m[k] * record.accel["P"][k][j] for k in range(3))
                   + record.accel["P"][3][j] for j in range(3)]
            for j in range(3):
                self.assertAlmostEqual(got[j], up[j], delta=0.008)

    def test_capture_belongs_to_the_record(self):
        board = self.calibrated()
        blocks = read_blocks(self.read("capture.bin"))
        meta = json.loads(blocks.meta_bytes)
        record = correction_record.decode(self.read("record_a.bin"))
        self.assertEqual(meta["session"], record.session)
        self.assertEqual(meta["device_id"], board.unique_id)
        self.assertTrue(blocks.complete)
        self.assertIsNone(blocks.truncated_at)
        self.assertEqual(len(blocks.placements), 12)
        columns = len(blocks.names)
        for p in blocks.placements:
            for k in range(columns):
                column = blocks.rows[k:][::columns]
                self.assertEqual(sum(column[p.first:p.first + p.n]), p.sums[k])

    def test_second_power_up_streams_corrected(self):
        self.calibrated()
        board = power_on(self.root, STILL, answers=[
            [lambda e: e["event"] == "sample" and e["t_us"] > 2e6, {"cmd": "stop"}, 1]])
        self.assertEqual(board.named("calibrating"), [])
        self.assertEqual(board.only("record")["slot"], "a")
        rest = board.only("rest")
        self.assertTrue(rest["still"])
        self.assertEqual(rest["verdict"], "good")
        self.assertTrue(board.only("ready")["corrected"])
        samples = board.named("sample")
        self.assertGreater(len(samples), 15)
        length = sum(sum(x * x for x in s["a"]) ** 0.5 for s in samples) / len(samples)
        self.assertAlmostEqual(length, 9.80665, delta=0.01)
        for axis in range(3):
            self.assertAlmostEqual(sum(s["w"][axis] for s in samples) / len(samples), 0.0,
                                   delta=0.0005)

    def test_gy85_and_adxl345(self):
        for sensor in ("gy85", "adxl345"):
            root = self.path(sensor)
            os.mkdir(root)
            board = power_on(root, {"sensor": sensor, "tilt_deg": 1.0})
            self.assertEqual(board.only("hello")["sensor"], sensor)
            self.assertEqual(len(board.named("pose")), 12, board.named("refused"))
            self.assertIn(board.only("solved")["verdict"], ("good", "doubtful"))
            self.assertIn("record_a.bin", os.listdir(root))

    def test_clone_is_named_and_used(self):
        board = self.calibrated(who_am_i=0x98)
        self.assertEqual(board.only("hello")["who_am_i"], [0x98, 0x98])
        self.assertIn("clone", board.only("hello")["chip"])
        self.assertEqual(correction_record.decode(self.read("record_a.bin")).who_am_i[0], 0x98)


class TestAskedFor(Folder):
    def test_flag_file_asks_once(self):
        self.calibrated()
        self.write("calibrate.flag", b"")
        board = power_on(self.root, {"seed": 5})
        self.assertEqual(len(board.named("calibrating")), 1)
        self.assertNotIn("calibrate.flag", self.files())
        self.assertEqual(board.only("saved")["slot"], "b")
        self.assertEqual(board.only("saved")["sequence"], 2)

    def test_button_held_at_power_up(self):
        self.calibrated()
        board = SimulatedBoard(worlds.make(dict(SHORT_WORLD, seed=5)), self.root,
                               [STOP_WHEN_READY])
        board.pressed = True
        power_on(self.root, board=board)
        self.assertEqual(len(board.named("calibrating")), 1)

    def test_host_asks_in_the_grace_window_and_while_streaming(self):
        self.calibrated()
        for when in ("grace", "ready"):
            board = power_on(self.root, {"seed": 7}, answers=[
                [when, {"cmd": "calibrate"}, 1], ["calibrating", {"cmd": "stop"}, 1],
                ["solved", {"cmd": "stop"}, 1]])
            self.assertEqual(len(board.named("calibrating")), 1, when)

    def test_stop_in_the_grace_window(self):
        board = power_on(self.root, answers=[["grace", {"cmd": "stop"}, 1]])
        self.assertEqual(board.names()[-2:], ["grace", "stopped"])
        self.assertEqual(self.files(), [])

    def test_same_result_is_not_written_again(self):
        self.calibrated()
        before = self.read("record_a.bin"), self.read("capture.bin")
        self.write("calibrate.flag", b"")
        board = power_on(self.root)
        saved = board.only("saved")
        self.assertFalse(saved["written"])
        self.assertIn("uncertainty", saved["reason"])
        self.assertEqual((self.read("record_a.bin"), self.read("capture.bin")), before)
        self.assertEqual(self.files(), ["capture.bin", "record_a.bin", saved["capture"]])
        self.assertTrue(read_blocks(self.read("unsaved.bin")).complete)

    def test_sessions_have_numbers_of_their_own_where_chance_is_constant(self):
        numbers = set()
        real, os.urandom = os.urandom, lambda n: bytes(n)
        try:
            for _ in range(3):
                numbers.add(power_on(self.root).only("calibrating")["session"])
                self.write("calibrate.flag", b"")
        finally:
            os.urandom = real
        self.assertEqual(len(numbers), 3)

    def test_restore_goes_back_and_forth(self):
        self.calibrated()
        first = correction_record.decode(self.read("record_a.bin")).session
        self.write("calibrate.flag", b"")
        power_on(self.root, {"seed": 5})
        second = correction_record.decode(self.read("record_b.bin")).session
        restore = [["ready", {"cmd": "restore"}, 1], ["restored", {"cmd": "stop"}, 1]]
        for expected in (first, second):
            board = power_on(self.root, STILL, answers=restore)
            self.assertEqual(board.only("restored")["session"], expected)
            board = power_on(self.root, STILL)
            self.assertEqual(board.only("record")["session"], expected)

    def test_restore_without_an_older_record(self):
        self.calibrated()
        board = power_on(self.root, STILL, answers=[
            ["ready", {"cmd": "restore"}, 1], ["error", {"cmd": "stop"}, 1]])
        self.assertIn("no record before", board.only("error")["what"])


class TestCommands(Folder):
    def answer_to(self, line, event):
        if not self.files():
            self.calibrated()
        board = power_on(self.root, STILL, answers=[["ready", line, 1],
                                                    [event, {"cmd": "stop"}, 1]])
        return board.named(event)[-1], board

    def test_unknown_and_nonsense(self):
        for line in ({"cmd": "fly"}, "rubbish", {"cmd": "undo"}, {"cmd": "redo", "face": "W"},
                     {"cmd": "stream", "hz": -1}, {"cmd": "stream", "raw": 1}):
            self.assertTrue(self.answer_to(line, "error")[0]["expected"])

    def test_check(self):
        answer, _ = self.answer_to({"cmd": "check"}, "check")
        self.assertEqual(answer["verdict"], "good")
        self.assertLess(abs(answer["a_error_mg"]), 1.0)

    def test_raw_stream(self):
        self.calibrated()
        board = power_on(self.root, STILL, answers=[
            ["ready", {"cmd": "stream", "raw": True, "hz": 50}, 1],
            [lambda e: e["event"] == "sample" and e["t_us"] > 1.5e6, {"cmd": "stop"}, 1]])
        raw = [e for e in board.named("sample") if "raw" in e]
        self.assertGreater(len(raw), 40)
        self.assertEqual(len(raw[0]["raw"]), 7)
        self.assertTrue(all(isinstance(x, int) for x in raw[0]["raw"]))


class TestMain(unittest.TestCase):
    def test_settings_name_an_unknown_board(self):
        folder = tempfile.mkdtemp()
        with open(os.path.join(folder, "sixflip.json"), "w") as f:
            f.write('{"board": "stm32f103"}')
        os.environ["SIXFLIP_BOARD_DIR"] = folder
        try:
            with self.assertRaises(ValueError) as caught:
                power_up.main()
        finally:
            del os.environ["SIXFLIP_BOARD_DIR"]
            shutil.rmtree(folder)
        self.assertIn("expected pico", str(caught.exception))
