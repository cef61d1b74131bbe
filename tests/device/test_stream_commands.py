"""What the host may ask of the stream, and how often a sample is sent."""

import unittest

from sixflip.capture.stream_frame import HEADING, RAW
from sixflip_device import commands
from sixflip_device.boards.board import LineReader
from sixflip_device.stream import stream
from sixflip_host.board.stream_reader import decode


class Collected:
    """Events and frames of a unit without a board."""

    def __init__(self, gyro=True):
        self.said = []
        self.frames = []
        self.raw = self.heading = self.binary = self.recording = False
        self.output = "old"
        self.stream_hz = 10
        self.settings = {"heading": None, "g": 9.80665}
        self.events = self.board = self.correction = self
        self.sensor = self
        self.imu = self
        self.has_gyro = gyro

    def emit(self, event, **fields):
        self.said.append((event, fields))

    def error(self, what, expected="", **fields):
        self.said.append(("error", what))

    def write_bytes(self, data):
        self.frames.append(decode(bytes(data[:-1])))

    def apply(self, sample, out):
        for k in range(6):
            out[k] = (0.0, 0.0, 9.80665, 0.0, 0.0, 0.5)[k]
        return out

    def ask(self, **command):
        commands.obey(self, dict(command, cmd="stream"), False)
        return self.said[-1]


class Asked(unittest.TestCase):
    def test_every_choice_replaces_the_one_before(self):
        unit = Collected()
        for command, raw, heading in (({"raw": True}, True, False), ({"hz": 5}, True, False),
                                      ({"heading": True}, False, True),
                                      ({"binary": True}, False, True),
                                      ({"raw": True}, True, False),
                                      ({"raw": False}, False, False)):
            unit.output = "old"
            self.assertEqual(unit.ask(**command)[0], "stream")
            self.assertEqual((unit.raw, unit.heading, unit.output), (raw, heading, None))
        self.assertEqual((unit.binary, unit.stream_hz), (True, 5))

    def test_nonsense_changes_nothing(self):
        for command in ({"hz": -1}, {"hz": True}, {"raw": 1}, {"heading": "yes"}, {"binary": None},
                        {"record": 1}, {"raw": True, "heading": True}):
            unit = Collected()
            self.assertEqual(unit.ask(**command)[0], "error", command)
            self.assertEqual((unit.raw, unit.heading, unit.binary, unit.output, unit.stream_hz),
                             (False, False, False, "old", 10))

    def test_control_characters_are_not_the_firmwares(self):
        reader = LineReader()
        lines = [reader.feed(ch) for ch in '\x02\x01{"cmd": 1}\r\n']
        self.assertIn('{"cmd": 1}', lines)


class Sent(unittest.TestCase):
    def test_heading_integrates_what_is_not_sent(self):
        unit = Collected()
        unit.heading = unit.binary = True
        output = stream._output(unit)
        for _ in range(101):
            output.step([0] * 7, 10000)
        output.send(1010000, [0] * 7)
        kind, _, t_us, (roll, pitch, yaw) = unit.frames[0]
        self.assertEqual((kind, t_us), (HEADING, 1010000))
        self.assertAlmostEqual(yaw, 28.6479, delta=0.001)  # 0.5 rad, the first sample begins
        self.assertAlmostEqual(roll, 0.0, delta=1e-6)
        unit.binary = False
        stream._output(unit).send(0, [0] * 7)
        self.assertEqual(unit.said[-1][0], "heading")

    def test_a_wrong_gain_is_named(self):
        for given in ({"gain": 0.5}, {"gain": "much"}):
            unit = Collected()
            unit.heading = True
            unit.settings["heading"] = given
            stream._output(unit)
            self.assertEqual(unit.said[-1][0], "error")

    def test_frames(self):
        unit = Collected(gyro=False)
        unit.binary = True
        stream._output(unit).send(5, [0] * 7)
        values = unit.frames[0][3]
        self.assertAlmostEqual(values[2], 9.80665, delta=1e-5)
        self.assertTrue(all(x != x for x in values[3:]))
        unit.raw = True
        stream._output(unit).send(6, [1, -2, 3, 4, 5, 6, 7])
        self.assertEqual(unit.frames[1], (RAW, 0, 6, (1, -2, 3, 4, 5, 6, 7)))


if __name__ == "__main__":
    unittest.main()
