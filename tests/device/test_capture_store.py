"""The capture on flash when there is room, when there is little, and when it runs out."""

import builtins
import os
import tempfile
import unittest
from array import array

from sixflip.capture.blocks import ACCEL
from sixflip.capture.reader import read as read_blocks
from sixflip.poses.placement import Placement
from sixflip_device import flash_files
from sixflip_device.capture import files
from sixflip_device.capture import store as capture_store
from sixflip_device.capture.store import CaptureStore


class FullFile:
    """A file on a flash that takes no more than `room` bytes."""

    def __init__(self, name, room):
        self.file = builtins.open(name, "wb")  # noqa: SIM115 - closed by close()
        self.room = room

    def write(self, data):
        part = data[:self.room]
        self.room -= len(part)
        self.file.write(part)
        if len(part) < len(data):
            raise OSError(28, "no space")

    def flush(self):
        self.file.flush()

    def close(self):
        self.file.close()


class TestCaptureStore(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = os.path.join(self.folder.name, "")
        self.free = None
        capture_store.free_bytes = lambda root: self.free

    def tearDown(self):
        capture_store.free_bytes = flash_files.free_bytes
        capture_store.__dict__.pop("open", None)
        self.folder.cleanup()

    def store(self, expected=50000):
        return CaptureStore(self.root, b'{"session": 7}', ACCEL, expected)

    def session(self, store, poses=3, between=None):
        sample = array("h", [1, -2, 16384, 0, 0, 0, 0])
        self.placements = []
        for k in range(poses):
            for _ in range(100):
                store.add(10000, sample)
            self.placements.append(Placement(
                1 + k, 100 * k + 10, 90, [90, -180, 90 * 16384, 0, 0, 0, 0], [1.0] * 6, 900000))
            store.pose(self.placements[-1])
            if between and k == 0:
                between()

    def content(self, name="capture.new"):
        with open(self.root + name, "rb") as f:
            return read_blocks(f.read())

    def test_a_capture_that_lacks_poses_is_unfinished_and_a_complete_one_is_not(self):
        self.assertFalse(files.unfinished(self.root))       # there is none
        for complete in (True, False):
            store = self.store()
            self.session(store)
            store.finish(complete, self.placements)
            files.refuse(self.root)
            self.assertEqual(files.unfinished(self.root), not complete)

    def test_all_of_it(self):
        store = self.store()
        self.session(store)
        self.assertTrue(store.finish(True, self.placements))
        got = self.content()
        self.assertEqual((len(got.placements), got.samples, len(got.t_us)), (3, 300, 300))
        self.assertTrue(got.complete)
        self.assertFalse(got.sums_only or store.sums_only)
        self.assertEqual(store.bytes, os.path.getsize(self.root + "capture.new"))

    def test_too_little_room_from_the_start(self):
        self.free = 30000
        store = self.store()
        self.assertTrue(store.sums_only)
        self.assertEqual(store.reason, "30000 bytes free, 24576 of them for the records; a "
                                       "session may take 50000")
        self.assertIn("30000", store.reason)
        self.session(store)
        self.assertTrue(store.finish(True, self.placements))
        got = self.content()
        self.assertTrue(got.sums_only)
        self.assertEqual((len(got.placements), got.samples, len(got.t_us)), (3, 300, 0))
        self.assertEqual(got.placements[2].sums[2], 90 * 16384)

    def test_refused_capture_makes_room(self):
        with open(self.root + "refused.bin", "wb") as f:
            f.write(b"x")
        capture_store.free_bytes = lambda root: (
            30000 if os.path.exists(self.root + "refused.bin") else 300000)
        store = self.store()
        self.assertFalse(store.sums_only)
        self.assertFalse(os.path.exists(self.root + "refused.bin"))
        store.finish(False)

    def test_room_runs_out_in_mid_session(self):
        self.free = capture_store.RESERVE + capture_store.SUMS_BYTES + 3000
        store = self.store(expected=3000)
        self.session(store, 6)
        self.assertTrue(store.finish(True, self.placements))
        got = self.content()
        self.assertTrue(got.sums_only)
        self.assertIn("nearly full", store.reason)
        self.assertEqual((len(got.placements), got.samples), (6, 600))
        self.assertEqual(len(got.t_us), store.kept)
        self.assertGreater(store.kept, 99)
        self.assertLess(store.kept, 600)

    def test_a_file_that_littlefs_counts_three_times_does_not_fill_the_flash(self):
        name = self.root + "capture.new"
        capture_store.free_bytes = lambda root: 45000 - 3 * flash_files.size(name)
        store = self.store(expected=20000)
        self.session(store, 12)
        self.assertTrue(store.finish(True, self.placements))
        self.assertGreater(3 * store.bytes, 45000 - capture_store.RESERVE)
        self.assertFalse(store.sums_only, store.reason)

    def test_free_space_is_not_asked_for_in_a_session(self):
        asked = []
        capture_store.free_bytes = lambda root: asked.append(1) or 1200000
        store = self.store()
        del asked[:]  # before the first sample
        self.session(store, 12)
        self.assertEqual(asked, [])
        store.finish(True)

    def test_flash_full_in_mid_write(self):
        for room in (0, 3, 100, 700, 1500, 2500):
            rooms = [room, 100000]
            capture_store.open = lambda name, mode, rooms=rooms: FullFile(name, rooms.pop(0))
            store = self.store()
            self.session(store, 6)
            self.assertTrue(store.finish(True, self.placements), room)
            self.assertIn("full", store.reason)
            got = self.content()
            self.assertTrue(got.sums_only and got.complete)
            self.assertEqual((len(got.placements), got.samples), (6, 600))

    def test_no_room_even_for_the_sums(self):
        capture_store.open = lambda name, mode: FullFile(name, 40)
        store = self.store()
        self.session(store)
        self.assertFalse(store.finish(True, self.placements))
        self.assertEqual(os.listdir(self.root), [])

    def test_withdrawn_poses_are_withdrawn_in_the_sums_too(self):
        rooms = [600, 100000]
        capture_store.open = lambda name, mode: FullFile(name, rooms.pop(0))
        store = self.store()
        self.session(store, 4)
        store.withdraw(2)
        left = [p for p in self.placements if p.pose != 2]
        self.assertTrue(store.finish(False, left))
        self.assertEqual([p.pose for p in self.content().placements], [1, 3, 4])

    def test_power_cut_between_record_and_capture(self):
        store = self.store()
        self.session(store)
        store.finish(True, self.placements)
        files.finish_interrupted(self.root, 8)
        self.assertEqual(os.listdir(self.root), ["capture.new"])
        files.finish_interrupted(self.root, 7)
        self.assertEqual(os.listdir(self.root), ["capture.bin"])

    def test_a_session_whose_name_begins_like_the_records_is_another_one(self):
        store = self.store()
        store.finish(True)
        os.rename(self.root + "capture.new", self.root + "x")
        with open(self.root + "x", "rb") as f, open(self.root + "capture.new", "wb") as g:
            g.write(f.read().replace(b'"session": 7', b'"session": 71'))
        files.finish_interrupted(self.root, 7)
        self.assertIn("capture.new", os.listdir(self.root))

    def test_power_cut_in_mid_session(self):
        store = self.store()
        self.session(store)
        store._file.close()  # and no end block
        files.file_cut_short(self.root)
        self.assertEqual(os.listdir(self.root), ["refused.bin"])
        self.assertEqual(len(self.content("refused.bin").placements), 3)

    def test_power_cut_before_the_first_pose(self):
        for poses, left in ((2, 2), (0, 2)):
            store = self.store()
            self.session(store, poses)
            store._file.close()
            files.file_cut_short(self.root)
            self.assertEqual(len(self.content("refused.bin").placements), left)

    def test_power_cut_before_the_first_sample_leaves_nothing(self):
        self.store()._file.close()
        files.file_cut_short(self.root)
        self.assertEqual(os.listdir(self.root), [])

    def test_power_cut_before_the_header_is_whole(self):
        with open(self.root + "capture.new", "wb") as f:
            f.write(b"6CAP")
        files.file_cut_short(self.root)
        self.assertEqual(os.listdir(self.root), [])

    def test_power_cut_in_a_session_nobody_asked_for_leaves_one_with_more_poses(self):
        for poses, idle in ((6, 0), (2, 5000)):
            store = CaptureStore(self.root, b'{"session": 7, "unasked": true}', ACCEL, 50000)
            for _ in range(idle):
                store.add(10000, array("h", [1, -2, 16384, 0, 0, 0, 0]))
            self.session(store, poses)
            store._file.close()
            files.file_cut_short(self.root)
            self.assertEqual(os.listdir(self.root), ["refused.bin"])
            self.assertEqual(len(self.content("refused.bin").placements), 6)
        store = self.store()
        self.session(store, 2)
        store._file.close()
        files.file_cut_short(self.root)
        self.assertEqual(len(self.content("refused.bin").placements), 2)
