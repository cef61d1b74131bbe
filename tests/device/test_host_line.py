"""Lines from the host: commands come through, anything else is answered."""

import json
import unittest

from sixflip_device.boards.board import Board, LineReader
from sixflip_device.events import Events, HostLine


class Typed(Board):
    def __init__(self, *lines):
        self.lines = list(lines)

    def read_line(self):
        return self.lines.pop(0) if self.lines else None


class TestHostLine(unittest.TestCase):
    def poll(self, line):
        said = []
        command = HostLine(Typed(line), Events(said.append)).poll()
        return command, [json.loads(s) for s in said]

    def test_command(self):
        command, said = self.poll('{"cmd": "redo", "face": "Z+"}')
        self.assertEqual(command, {"cmd": "redo", "face": "Z+"})
        self.assertEqual(said, [])

    def test_silence_and_blank_lines(self):
        self.assertEqual(self.poll(None), (None, []))
        self.assertEqual(self.poll("  "), (None, []))

    def test_no_command(self):
        for line in ("hello", "{", "[]", "3", '{"cmd": 3}', '{"face": "Z+"}', "\x00\x01"):
            command, said = self.poll(line)
            self.assertIsNone(command)
            self.assertEqual(said[0]["event"], "error")
            self.assertIn("expected", said[0])


class TestLineReader(unittest.TestCase):
    def lines(self, text, limit=16):
        reader = LineReader(limit)
        return [line for line in [reader.feed(c) for c in text] if line is not None]

    def test_lines(self):
        self.assertEqual(self.lines("ab\r\ncd\n\nef"), ["ab", "cd"])

    def test_a_ctrl_c_that_came_while_the_board_started_is_one(self):
        with self.assertRaises(KeyboardInterrupt):
            self.lines("\r\x03")

    def test_overlong_line_is_dropped_whole(self):
        self.assertEqual(self.lines("x" * 40 + "\nok\n"), ["ok"])
