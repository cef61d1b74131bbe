"""Every event is one line of ASCII JSON, whatever is in it."""

import json
import math
import unittest
from array import array

from sixflip_device.events import Events


class TestEvents(unittest.TestCase):
    def setUp(self):
        self.lines = []
        self.events = Events(self.lines.append)

    def only(self):
        self.assertEqual(len(self.lines), 1)
        return json.loads(self.lines[0])

    def test_event_comes_first(self):
        self.events.emit("pose", n=400)
        self.assertTrue(self.lines[0].startswith('{"event": "pose"'))

    def test_text_survives(self):
        nasty = 'a "quote", a \\, a\nline, a\ttab, \x00, °C, 漢, \U0001F600'
        self.events.emit("error", what=nasty)
        self.assertEqual(self.only()["what"], nasty)
        self.assertTrue(all(32 <= ord(c) < 127 for c in self.lines[0]))

    def test_kinds(self):
        self.events.emit("x", a=None, b=True, c=-5, d=[1, (2, 3)], e={"k": 0.5},
                         f=array("h", [1, -2]), g=b"\x0f\xf0", h=1 << 40)
        got = self.only()
        del got["event"]
        self.assertEqual(got, {"a": None, "b": True, "c": -5, "d": [1, [2, 3]], "e": {"k": 0.5},
                               "f": [1, -2], "g": "0ff0", "h": 1 << 40})

    def test_floats(self):
        self.events.emit("x", a=9.806650123, b=math.nan, c=-math.inf, d=1e-12)
        got = self.only()
        self.assertAlmostEqual(got["a"], 9.80665, places=5)
        self.assertIsNone(got["b"])
        self.assertIsNone(got["c"])
        self.assertAlmostEqual(got["d"] * 1e12, 1.0)

    def test_error(self):
        self.events.error("no chip", "an MPU6050", address=0x68)
        self.assertEqual(self.only(), {"event": "error", "what": "no chip",
                                       "expected": "an MPU6050", "address": 0x68})
