"""The lamp: sixteen steps of an eighth of a second."""

import unittest

from sixflip_device import led
from sixflip_device.boards.board import Board


class Bulb(Board):
    def __init__(self):
        self.seen = []

    def led(self, on):
        self.seen.append(1 if on else 0)


class TestLamp(unittest.TestCase):
    def shown(self, lamp, bulb, steps):
        del bulb.seen[:]
        for _ in range(steps):
            lamp.step()
        return "".join([str(b) for b in bulb.seen])

    def test_pattern_repeats(self):
        bulb = Bulb()
        lamp = led.Lamp(bulb, 8)
        lamp.show(led.ACCEPTED)
        self.assertEqual(self.shown(lamp, bulb, 32), "1010100000000000" * 2)

    def test_one_step_lasts_an_eighth_of_a_second(self):
        bulb = Bulb()
        lamp = led.Lamp(bulb, 100)
        lamp.show(led.CAPTURING)
        self.assertEqual(self.shown(lamp, bulb, 12 * 16), "1" * 16)

    def test_flash_is_shown_once_and_then_the_state(self):
        bulb = Bulb()
        lamp = led.Lamp(bulb, 8)
        lamp.show(led.CAPTURING)
        lamp.step()
        lamp.flash(led.REFUSED)
        lamp.show(led.WAITING)
        self.assertEqual(self.shown(lamp, bulb, 32), "1010101010000000" + "1000000000000000")

    def test_patterns_differ(self):
        patterns = [led.MEASURING, led.WAITING, led.SETTLING, led.CAPTURING, led.ACCEPTED,
                    led.REFUSED, led.CALIBRATED, led.RAW, led.NO_CHIP]
        self.assertEqual(len(set(patterns)), len(patterns))
        for pattern in patterns:
            self.assertTrue(0 < pattern < 1 << 16)
