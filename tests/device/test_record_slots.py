"""Two slots: the newest valid record wins, and a power cut at any file operation costs nothing."""

import builtins
import contextlib
import os
import tempfile
import unittest

from sixflip.record.correction_record import Record, encode
from sixflip_device import flash_files
from sixflip_device.record import record_slots
from sixflip_device.record.record_slots import RecordSlots


class PowerCut(BaseException):
    """The power goes. Not an Exception: nothing of ours may catch it and carry on."""


class Flash:
    """Files in memory behind open() and os, with FAT's habits: rename over an existing file
    is unlink and rename, two steps; what is written is there in parts; power goes before
    step `cut` (None: never). full: bytes that fit altogether (None: any)."""

    def __init__(self):
        self.files = {}
        self.cut = None
        self.steps = 0
        self.full = None

    def step(self):
        if self.cut is not None and self.steps >= self.cut:
            raise PowerCut()
        self.steps += 1

    def open(self, name, mode="r"):
        if "w" in mode:
            self.step()
            self.files[name] = b""
        elif name not in self.files:
            raise OSError(2, name)
        return OpenFile(self, name)

    def remove(self, name):
        self.step()
        if name not in self.files:
            raise OSError(2, name)
        del self.files[name]

    def rename(self, old, new):
        if old not in self.files:
            raise OSError(2, old)
        if new in self.files:
            self.remove(new)
        self.step()
        self.files[new] = self.files.pop(old)


class OpenFile:
    def __init__(self, flash, name):
        self.flash = flash
        self.name = name

    def __enter__(self):
        return self

    def __exit__(self, *exc):
        return False

    def read(self, n=-1):
        return self.flash.files[self.name]

    def write(self, data):
        for part in (data[:len(data) // 2], data[len(data) // 2:]):
            self.flash.step()
            used = sum(len(f) for f in self.flash.files.values())
            if self.flash.full is not None and used + len(part) > self.flash.full:
                raise OSError(28, "no space")
            self.flash.files[self.name] += part


def record(session, chip="mpu6050"):
    r = Record()
    r.session = session
    r.chip = chip
    return r


def fits(r):
    return "" if r.chip == "mpu6050" else "it is for " + r.chip


class SlotsTest(unittest.TestCase):
    def setUp(self):
        self.flash = Flash()
        for module in (record_slots, flash_files):
            module.open = self.flash.open
            module.os = self.flash
        self.slots = RecordSlots("/")

    def tearDown(self):
        for module in (record_slots, flash_files):
            module.open = builtins.open
            module.os = os

    def session(self):
        """Session of the record a power-up would load, None without one."""
        r = RecordSlots("/").load(fits)[1]
        return None if r is None else r.session


class TestSlots(SlotsTest):
    def test_empty(self):
        self.assertEqual(self.slots.load(fits), (None, None, []))

    def test_slots_take_turns_and_the_newest_wins(self):
        self.assertEqual([self.slots.save(record(n)) for n in (1, 2, 3)], ["a", "b", "a"])
        slot, newest, refusals = self.slots.load(fits)
        self.assertEqual((slot, newest.session, newest.sequence, refusals), ("a", 3, 3, []))
        self.assertEqual(sorted(self.flash.files), ["/record_a.bin", "/record_b.bin"])

    def test_damaged_newest_falls_back_with_the_reason(self):
        for n in (1, 2):
            self.slots.save(record(n))
        data = self.flash.files["/record_b.bin"]
        for damaged in (data[:10], b"", data[:40] + bytes([data[40] ^ 1]) + data[41:]):
            self.flash.files["/record_b.bin"] = damaged
            slot, found, refusals = self.slots.load(fits)
            self.assertEqual((slot, found.session), ("a", 1))
            self.assertEqual(refusals[0][0], "b")
            self.assertTrue(refusals[0][1])

    def test_a_record_no_sensor_has_is_passed_over_with_the_reason(self):
        self.slots.save(record(1))
        spoilt = record(2)
        spoilt.g = 98.0
        self.slots.save(spoilt)
        slot, found, refusals = self.slots.load(fits)
        self.assertEqual((slot, found.session, refusals[0][0]), ("a", 1, "b"))
        self.assertIn("g in m/s2 is 98", refusals[0][1])
        self.assertEqual(self.slots.save(record(3)), "b")  # the good one stays
        self.assertEqual(self.session(), 3)

    def test_sequence_numbers_begin_again(self):
        last = record(1)
        last.sequence = 0xFFFFFFFF
        self.flash.files["/record_a.bin"] = encode(last)
        self.assertEqual([self.slots.save(record(n)) for n in (2, 3)], ["b", "a"])
        slot, newest, _ = self.slots.load(fits)
        self.assertEqual((slot, newest.session, newest.sequence), ("a", 3, 1))

    def test_record_of_another_chip_is_refused_but_not_destroyed_at_once(self):
        self.slots.save(record(1))
        self.slots.save(record(2, "gy85"))
        slot, found, refusals = self.slots.load(fits)
        self.assertEqual((slot, found.session), ("a", 1))
        self.assertEqual(refusals, [("b", "it is for gy85")])

    def test_restore(self):
        for n in (1, 2):
            self.slots.save(record(n))
        for expected in (1, 2, 1):
            self.slots.restore(fits)
            self.assertEqual(self.session(), expected)

    def test_restore_refuses(self):
        with self.assertRaises(ValueError):
            self.slots.restore(fits)
        self.slots.save(record(1, "gy85"))
        with self.assertRaises(ValueError):
            self.slots.restore(fits)
        self.slots.save(record(2))
        with self.assertRaises(ValueError) as caught:
            self.slots.restore(fits)
        self.assertIn("gy85", str(caught.exception))

    def test_no_space_leaves_the_old_record(self):
        self.slots.save(record(1))
        self.flash.full = sum(len(f) for f in self.flash.files.values()) + 20
        with self.assertRaises(OSError):
            self.slots.save(record(2))
        self.assertEqual(self.session(), 1)
        self.assertEqual(sorted(self.flash.files), ["/record_a.bin"])
        self.flash.full = None
        self.slots.save(record(3))
        self.assertEqual(self.session(), 3)


class TestPowerCuts(SlotsTest):
    def cut_everywhere(self, saved, act, old, new):
        """Power goes before every step of act(slots); then the old or the new one is loaded,
        and the next save works. How many cuts there were."""
        cuts = 0
        while True:
            self.flash.__init__()
            for n in range(1, saved + 1):
                self.slots.save(record(n))
            self.flash.cut, self.flash.steps = cuts, 0
            try:
                act(RecordSlots("/"))
                done = True
            except PowerCut:
                done = False
            self.flash.cut = None
            self.assertIn(self.session(), (new,) if done else (old, new), cuts)
            RecordSlots("/").save(record(99))
            self.assertEqual(self.session(), 99, cuts)
            if done:
                return cuts
            cuts += 1

    def test_save(self):
        for saved, old in ((0, None), (1, 1), (2, 2), (3, 3)):
            cuts = self.cut_everywhere(saved, lambda s: s.save(record(50)), old, 50)
            self.assertGreater(cuts, 3)

    def test_restore(self):
        self.assertGreater(self.cut_everywhere(2, lambda s: s.restore(fits), 2, 1), 3)

    def test_cut_again_while_the_first_cut_is_mended(self):
        for first in range(12):
            for second in range(6):
                self.flash.__init__()
                for n in (1, 2):
                    self.slots.save(record(n))
                for cut, act in ((first, lambda: RecordSlots("/").save(record(50))),
                                 (second, lambda: RecordSlots("/").load(fits))):
                    self.flash.cut, self.flash.steps = cut, 0
                    with contextlib.suppress(PowerCut):
                        act()
                self.flash.cut = None
                self.assertIn(self.session(), (2, 50), (first, second))


class TestRealFiles(unittest.TestCase):
    def test_on_the_computers_own_file_system(self):
        with tempfile.TemporaryDirectory() as folder:
            slots = RecordSlots(os.path.join(folder, ""))
            for n in (1, 2, 3):
                slots.save(record(n))
            self.assertEqual(slots.load(fits)[1].session, 3)
            self.assertEqual(sorted(os.listdir(folder)), ["record_a.bin", "record_b.bin"])
