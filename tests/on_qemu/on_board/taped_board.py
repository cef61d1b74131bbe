"""A board of boards/board.py on a tape or on a simulated world; on both interpreters.

The host stops it once corrected samples have come.
"""

from sixflip_device.boards.board import Board


class Count:
    """A clock of plain small integers: a look at it costs 2 us."""

    def __init__(self):
        self.now = 0

    def ticks_us(self):
        self.now += 2
        return self.now & 0x3FFFFFFF

    def ticks_diff(self, a, b):
        return ((a - b + 0x20000000) & 0x3FFFFFFF) - 0x20000000

    def sleep_us(self, us):
        self.now += us


class TapedBoard(Board):
    """told(text) is called with every event but those of the state."""

    name = "taped"
    unique_id = "00"

    def __init__(self, i2c, root, told, clock=None):
        self.i2c = i2c
        self.root = root
        self.told = told
        clock = clock or Count()
        self.ticks_us = clock.ticks_us
        self.ticks_diff = clock.ticks_diff
        self.sleep_us = clock.sleep_us
        self.samples = 0

    def read_line(self):
        return '{"cmd": "stop"}' if self.samples > 1 else None

    def write_line(self, text):
        if text.startswith('{"event": "sample"'):
            self.samples += 1
        elif not text.startswith('{"event": "state"'):
            self.told(text)
