"""sixflip.json: every fault has its sentence, and the rest of the file still counts."""

import json
import os
import tempfile
import unittest

from sixflip_device import settings


class TestSettings(unittest.TestCase):
    def load(self, data):
        with tempfile.TemporaryDirectory() as folder:
            root = os.path.join(folder, "")
            if data is not None:
                with open(root + settings.FILE, "wb") as f:
                    f.write(data)
            return settings.load(root)

    def test_no_file(self):
        values, problems = self.load(None)
        self.assertEqual(problems, [])
        self.assertEqual(values["rate_hz"], 100)
        self.assertEqual(values["sensor"], "auto")

    def test_good_file(self):
        values, problems = self.load(b'{"board": "pico", "sda": 4, "led": "LED", "g": 9.81}')
        self.assertEqual(problems, [])
        self.assertEqual((values["board"], values["sda"], values["led"], values["g"]),
                         ("pico", 4, "LED", 9.81))

    def test_not_json(self):
        for data in (b"{", b"", b"\xff\xfe", b"[1, 2]", b"null", b'"pico"'):
            values, problems = self.load(data)
            self.assertEqual(len(problems), 1, data)
            self.assertIn("sixflip.json", problems[0])
            self.assertEqual(values, settings.defaults())

    def test_a_file_without_end_is_not_read_into_the_heap(self):
        for size in (5000, 1 << 24):
            values, problems = self.load(b'{"rate_hz": 50, "x": "' + b"x" * size)
            self.assertEqual(values, settings.defaults())
            self.assertIn("4096 characters", problems[0])
        padded = b'{"rate_hz": 50}' + b" " * 4000
        self.assertEqual(self.load(padded)[0]["rate_hz"], 50)

    def test_one_bad_value_leaves_the_others(self):
        bad = {"rate_hz": 0, "grace_ms": "2", "stream_hz": True, "pose_samples": 400.5,
               "sensor": "bmi323", "sda": -1, "g": 0, "board": "", "mounting": 3, "nonsense": 1}
        values, problems = self.load(json.dumps(dict(bad, scl=7)).encode())
        self.assertEqual(values["scl"], 7)
        self.assertEqual(len(problems), len(bad))
        for name in bad:
            self.assertEqual(len([p for p in problems if " %s " % name in p]), 1, name)
        wanted = settings.defaults()
        wanted["scl"] = 7
        self.assertEqual(values, wanted)

    def test_sentence_names_what_was_expected(self):
        _, problems = self.load(b'{"sensor": "bmi323"}')
        self.assertIn("mpu6050", problems[0])
        _, problems = self.load(b'{"rate_hz": 5000}')
        self.assertIn("10 to 500", problems[0])
