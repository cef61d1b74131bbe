import binascii
import struct
import unittest
from array import array
from io import BytesIO

from synthetic_operator import Noise

from sixflip.capture import blocks as cb
from sixflip.capture.reader import LOST, NAMES
from sixflip.capture.reader import read as read_blocks
from sixflip.capture.scan import Scan, go_on
from sixflip.capture.writer import BlockWriter
from sixflip.poses.placement import Placement

META = b'{"sensor": "mpu6050", "rate_hz": 100}'


def placement(pose=1, first=0, n=40):
    return Placement(pose, first, n, [-1, 2, 655360 * n, 4, -5, 6, -(1 << 40)],
                     [0.5, 1.5, 2.25, 3.0, 4.0, 5.0], 1 << 33)


class Capture:
    """A short session written block by block; keeps what went in."""

    def __init__(self, n=100, columns=7, block_samples=32, gaps=None, sums_only=False, meta=META):
        self.parts = []
        self.rows = array("h")
        self.t_us = []
        self.ends = []  # file length after each block, the header first
        writer = BlockWriter(self.write, meta, columns, block_samples, sums_only)
        self.ends = [len(self.data())]
        self.counts = [0]  # samples in the file by then
        self.writer = writer
        noise = Noise(4)
        t = 0
        width = 10
        for k in range(n):
            dt = (gaps or {}).get(k, 10000 + k % 7)
            t += dt
            sample = array("h", [noise.uniform(32767) for _ in range(width)])
            writer.add(dt, sample)
            self.t_us.append(t)
            self.rows.extend(array("h", [sample[i] for i in cb.places(columns)]))
            if k == 50:
                writer.pose(placement())

    def write(self, data):
        self.parts.append(bytes(data))
        if self.ends:
            self.ends.append(self.ends[-1] + len(data))
            more = struct.unpack("<H", bytes(data[12:14]))[0] if data[0] == cb.STEPS else 0
            self.counts.append(self.counts[-1] + more)

    def data(self):
        return b"".join(self.parts)

    def finish(self):
        self.writer.note("the box stands on the window sill, 21 \u00b0C")
        self.writer.end(True)
        return self.data()


class RoundTrip(unittest.TestCase):
    def test_nothing_is_lost(self):
        made = Capture()
        blocks = read_blocks(made.finish())
        self.assertEqual(blocks.meta_bytes, META)
        self.assertEqual(blocks.names, ["ax", "ay", "az", "gx", "gy", "gz", "temp"])
        self.assertEqual(list(blocks.t_us), made.t_us)
        self.assertEqual(list(blocks.rows), list(made.rows))
        self.assertEqual(blocks.notes, ["the box stands on the window sill, 21 \u00b0C"])
        self.assertEqual((blocks.samples, blocks.ended, blocks.complete), (100, True, True))
        self.assertEqual((blocks.truncated_at, blocks.damage), (None, ""))
        p = blocks.placements[0]
        q = placement()
        self.assertEqual((p.pose, p.first, p.n, p.sums, p.noise, p.duration_us),
                         (q.pose, q.first, q.n, q.sums, q.noise, q.duration_us))

    def test_every_choice_of_columns(self):
        for columns in range(1, 16):
            made = Capture(n=40, columns=columns)
            blocks = read_blocks(made.finish())
            self.assertEqual(blocks.columns, columns)
            self.assertEqual(list(blocks.rows), list(made.rows))
        self.assertEqual(blocks.names, list(NAMES))
        self.assertEqual(read_blocks(Capture(columns=cb.ACCEL | cb.MAG).finish()).names,
                         ["ax", "ay", "az", "mx", "my", "mz"])

    def test_times_are_exact_over_gaps_and_past_two_to_the_thirty(self):
        gaps = {0: 0, 3: 65535, 4: 65536, 10: 900000, 11: 1000000, 40: 500000000, 41: 536870911,
                42: 536870911, 70: 0}
        made = Capture(gaps=gaps)
        self.assertEqual(list(read_blocks(made.finish()).t_us), made.t_us)
        self.assertGreater(made.t_us[-1], 1 << 30)

    def test_withdrawn_poses_do_not_count_and_the_later_one_does(self):
        made = Capture(n=0)
        made.writer.pose(placement(1, 0))
        made.writer.pose(placement(2, 40))
        made.writer.withdraw(1)
        made.writer.pose(placement(1, 80))
        blocks = read_blocks(made.finish())
        self.assertEqual([(p.pose, p.first) for p in blocks.placements], [(2, 40), (1, 80)])
        self.assertEqual(blocks.withdrawn, [1])

    def test_sums_only(self):
        made = Capture(sums_only=True)
        blocks = read_blocks(made.finish())
        self.assertEqual((blocks.samples, len(blocks.t_us), blocks.sums_only), (100, 0, True))
        self.assertEqual(len(blocks.placements), 1)
        self.assertTrue(blocks.complete)

    def test_an_incomplete_session_says_so(self):
        made = Capture()
        made.writer.end(False)
        blocks = read_blocks(made.data())
        self.assertEqual((blocks.ended, blocks.complete, blocks.damage), (True, False, ""))

    def test_a_block_of_an_unknown_type_is_passed_over(self):
        made = Capture()
        block = struct.pack(cb.BLOCK, 99, 0, 3) + b"abc"
        made.writer.flush()
        made.write(block + struct.pack("<I", binascii.crc32(block)))
        blocks = read_blocks(made.finish())
        self.assertTrue(blocks.complete)
        self.assertEqual(len(blocks.t_us), 100)


def old_block(seconds, us, intervals, rows):
    """A block as version 1 wrote it: every sample whole."""
    payload = struct.pack(cb.TIME, seconds, us, len(rows))
    for dt, row in zip(intervals, rows):
        payload += struct.pack("<H%dh" % len(row), dt, *row)
    block = struct.pack(cb.BLOCK, cb.SAMPLES, 0, len(payload)) + payload
    return block + struct.pack("<I", binascii.crc32(block))


class Steps(unittest.TestCase):
    """What a block holds when its samples are written as steps from one to the next."""

    def written(self, write, rows, intervals, block_samples=32):
        """rows: one array, seven counts a sample; a small board has no room for lists of them."""
        writer = BlockWriter(write, META, 7, block_samples)
        for k in range(len(intervals)):
            writer.add(intervals[k], rows[7 * k:7 * k + 7])
        writer.end(True)

    def bytes_of(self, rows, intervals):
        sizes = []
        self.written(lambda data: sizes.append(len(data)), rows, intervals)
        return sum(sizes)

    def test_any_counts_come_back_as_they_were(self):
        noise = Noise(7)
        edges = (0, 1, -1, 127, -127, 128, -128, 129, 255, 32767, -32768)
        steps = [(10000, 10127, 10255, 0, 65535, 65536, 3)[k % 7] for k in range(150)]
        times = [sum(steps[:k + 1]) for k in range(150)]
        for size in (0, 3, 90, 200, 32767):
            rows = array("h")
            for k in range(150):
                rows.extend(array("h", [noise.uniform(size) if k % 3 else edges[(k + i) % 11]
                                        for i in range(7)]))
            for block_samples in (1, 2, 32, 200):
                data = bytearray()
                self.written(data.extend, rows, steps, block_samples)
                blocks = read_blocks(data)
                self.assertEqual(blocks.damage, "")
                self.assertEqual(blocks.rows, rows)
                self.assertEqual(list(blocks.t_us), times)

    def test_a_resting_sensor_takes_half_the_bytes_and_a_shaken_one_half_more_at_most(self):
        noise = Noise(5)
        for size, least, most in ((20, 8, 10), (32767, 20, 25)):
            rows = array("h")
            for _ in range(500):
                rows.extend(array("h", [noise.uniform(size) for _ in range(7)]))
            taken = self.bytes_of(rows, [10000] * 500)
            self.assertTrue(least < taken / 500 < most, taken)

    def test_a_capture_of_version_1_is_still_read(self):
        head = struct.pack(cb.HEAD, cb.MAGIC, 1, 7, len(META)) + META
        rows = [[k, -k, 16384, 300 * k, 5, 6, -3700] for k in range(3)]
        data = head + struct.pack("<I", binascii.crc32(head)) + old_block(
            2, 5, [0, 10000, 9999], rows) + old_block(3, 0, [0], rows[:1])
        blocks = read_blocks(data)
        self.assertEqual(list(blocks.t_us), [2000005, 2010005, 2020004, 3000000])
        self.assertEqual(list(blocks.rows), [x for row in rows + rows[:1] for x in row])
        scan = Scan(BytesIO(data))
        self.assertEqual([kind for kind, _ in scan.each()], [cb.SAMPLES] * 2)
        self.assertEqual((scan.blocks.samples, scan.seconds, scan.us), (4, 3, 0))

    def test_samples_that_never_came_are_counted_and_the_rest_is_whole(self):
        made = Capture(n=64)
        made.writer.end(True)
        first, second = made.ends[:2]
        n = made.counts[1]
        block = struct.pack(cb.BLOCK, LOST, 0, 8) + struct.pack("<II", 0, n)
        data = made.data()[:first] + block + struct.pack("<I", binascii.crc32(block)) + \
            made.data()[second:]
        blocks = read_blocks(data)
        self.assertEqual((blocks.lost, blocks.missing, blocks.samples), ([(0, n)], n, 64))
        self.assertEqual((blocks.damage, blocks.complete), ("", True))
        self.assertEqual(list(blocks.t_us), made.t_us[n:])
        self.assertIn("are here", read_blocks(made.data()[:first] + made.data()[second:]).damage)


class Damage(unittest.TestCase):
    def test_cut_at_every_byte_it_is_readable_to_the_last_whole_block(self):
        made = Capture(n=60, block_samples=16)
        data = made.finish()
        whole = read_blocks(data)
        header = made.ends[0]
        for cut in range(len(data)):
            if cut < header:
                self.assertRaises(ValueError, read_blocks, data[:cut])
                continue
            blocks = read_blocks(data[:cut])
            last = max(end for end in made.ends if end <= cut)
            self.assertEqual(blocks.truncated_at, last)
            self.assertFalse(blocks.complete)
            self.assertTrue(blocks.damage)
            n = len(blocks.t_us)
            self.assertEqual(n, max(c for c, end in zip(made.counts, made.ends) if end <= cut))
            self.assertEqual(list(blocks.t_us), list(whole.t_us[:n]))
            self.assertEqual(list(blocks.rows), list(whole.rows[: 7 * n]))

    def test_one_wrong_byte_anywhere_is_noticed(self):
        made = Capture(n=40, block_samples=16)
        data = made.finish()
        header = made.ends[0]
        for at in range(len(data)):
            bad = bytearray(data)
            bad[at] ^= 1 << at % 8
            if at < header:
                self.assertRaises(ValueError, read_blocks, bad)
                continue
            blocks = read_blocks(bad)
            self.assertEqual(blocks.truncated_at, max(end for end in made.ends if end <= at))
            self.assertFalse(blocks.complete)

    def test_what_is_no_capture(self):
        for data in (b"", b"6", b"6CAP", b"6FLP" + bytes(40), b"# sixflip-capture 1\n", bytes(99)):
            with self.assertRaises(ValueError) as caught:
                read_blocks(data)
            self.assertTrue(len(str(caught.exception)) > 20)

    def header(self, version=1, columns=7, length=0):
        head = struct.pack(cb.HEAD, cb.MAGIC, version, columns, length)
        return head + struct.pack("<I", binascii.crc32(head))

    def test_headers_that_are_wrong_though_their_crc_is_right(self):
        for data, word in ((self.header(version=3), "version 3"), (self.header(columns=0), "mask"),
                           (self.header(columns=16), "mask"), (self.header(length=9), "cut off")):
            with self.assertRaises(ValueError) as caught:
                read_blocks(data)
            self.assertIn(word, str(caught.exception))

    def test_hostile_blocks_with_a_right_crc(self):
        blocks = (
            (cb.SAMPLES, struct.pack(cb.TIME, 0, 0, 65535) + bytes(16)),
            (cb.SAMPLES, struct.pack(cb.TIME, 0, 0, 0)),
            (cb.SAMPLES, struct.pack(cb.TIME, 0, 1000000, 1) + bytes(16)),
            (cb.SAMPLES, b"\0"),
            (cb.STEPS, struct.pack(cb.TIME, 0, 0, 2) + bytes(15)),
            (cb.STEPS, struct.pack(cb.TIME, 0, 0, 2) + bytes(17)),
            (cb.STEPS, struct.pack(cb.TIME, 0, 0, 2) + bytes(15) + b"\x80"),
            (cb.STEPS, struct.pack(cb.TIME, 0, 0, 2) + bytes(8) + b"\xff" + bytes(7)),
            (cb.STEPS, struct.pack(cb.TIME, 0, 0, 2) + b"\0\x80\xff\x7f" + bytes(6) +
             b"\0\1" + bytes(6)),
            (LOST, struct.pack("<II", 1, 5)),
            (LOST, struct.pack("<II", 0, 0)),
            (cb.POSE, b"\1\0"),
            (cb.POSE, bytes(200)),
            (cb.POSE, struct.pack(cb.PLACEMENT, 0, 0, 400, 1, *range(13))),
            (cb.POSE, struct.pack(cb.PLACEMENT, 2013, 0, 400, 1, *range(13))),
            (cb.POSE, struct.pack(cb.PLACEMENT, 1, 0, 0, 1, *range(13))),
            (cb.WITHDRAWN, b""),
            (cb.END, b"\0\0"),
            (cb.END, struct.pack(cb.FINISH, 7, cb.COMPLETE)),
        )
        for kind, payload in blocks:
            block = struct.pack(cb.BLOCK, kind, 0, len(payload)) + payload
            block += struct.pack("<I", binascii.crc32(block))
            found = read_blocks(self.header() + block)
            self.assertEqual(found.truncated_at, 12)
            self.assertIn("wrong", found.damage)
            self.assertEqual((len(found.t_us), found.complete), (0, False))

    def test_time_does_not_run_backwards(self):
        made = Capture(n=0)
        for seconds in (5, 4):
            payload = struct.pack(cb.TIME, seconds, 0, 1) + bytes(16)
            block = struct.pack(cb.BLOCK, cb.SAMPLES, 0, len(payload)) + payload
            made.write(block + struct.pack("<I", binascii.crc32(block)))
        found = read_blocks(made.data())
        self.assertEqual(list(found.t_us), [5000000])
        self.assertIn("backwards", found.damage)

    def test_bytes_after_the_end(self):
        found = read_blocks(Capture().finish() + b"\0")
        self.assertIn("after its end", found.damage)
        self.assertEqual(len(found.t_us), 100)


class Writer(unittest.TestCase):
    def test_what_cannot_be_written_is_refused(self):
        sink = [].append
        self.assertRaises(ValueError, BlockWriter, sink, b"", 0)
        self.assertRaises(ValueError, BlockWriter, sink, b"", 16)
        self.assertRaises(ValueError, BlockWriter, sink, b"", 7, 0)
        self.assertRaises(ValueError, BlockWriter, sink, b"", 7, 2049)
        self.assertRaises(ValueError, BlockWriter, sink, bytes(65536))

    def test_samples_before_a_pose_are_written_before_it(self):
        made = Capture(n=51)
        self.assertEqual(len(read_blocks(made.data()).t_us), 51)

    def test_a_full_flash_leaves_what_was_written_readable(self):
        made = Capture()

        def full(data):
            raise OSError(28)

        made.writer.flush()
        made.writer._write = full
        self.assertRaises(OSError, made.writer.end, True)
        self.assertEqual(len(read_blocks(made.data()).t_us), 100)


class Going(unittest.TestCase):
    """Through the file block by block, and on with it."""

    def scanned(self, data):
        scan = Scan(BytesIO(data))
        return scan, [(kind, bytes(block)) for kind, block in scan.each()]

    def test_a_scan_finds_what_the_reader_finds(self):
        made = Capture(100, gaps={70: 3000000})
        made.writer.pose(placement(3, 50, 40))
        made.writer.withdraw(1)
        made.writer.note("x")
        made.writer.end(True)
        scan, blocks = self.scanned(made.data())
        whole = read_blocks(made.data())
        self.assertEqual(b"".join([block for _, block in blocks]), made.data()[made.ends[0]:])
        self.assertEqual(scan.seconds * 1000000 + scan.us, whole.t_us[-1])
        self.assertEqual((scan.blocks.samples, scan.blocks.ended), (100, True))
        self.assertEqual([p.pose for p in scan.blocks.placements], [3])

    def test_a_scan_of_a_file_cut_off_or_damaged_ends_at_the_last_whole_block(self):
        made = Capture(100)
        data = made.data()
        for size in (made.ends[1] + 3, made.ends[2] - 1, len(data) - 9):
            scan, blocks = self.scanned(data[:size])
            end = max([e for e in made.ends if e <= size])
            self.assertEqual(sum([len(block) for _, block in blocks]), end - made.ends[0])
            self.assertFalse(scan.blocks.ended)
        broken = bytearray(data)
        broken[made.ends[1] + 20] ^= 4
        self.assertEqual(len(self.scanned(bytes(broken))[1]), 1)
        self.assertRaises(ValueError, Scan, BytesIO(b""))
        self.assertRaises(ValueError, Scan, BytesIO(data[:20]))

    def test_a_file_is_continued(self):
        made = Capture(40)
        made.writer.flush()
        parts = [made.data()]
        on = BlockWriter(lambda data: parts.append(bytes(data)), None, 7)
        t = made.t_us[-1]
        go_on(on, 40, t // 1000000, t % 1000000)
        on.withdraw(1)
        on.add(60000000, array("h", [1, 2, 3, 4, 5, 6, 7]))
        on.end(True)
        blocks = read_blocks(b"".join(parts))
        self.assertEqual((blocks.samples, blocks.complete, blocks.damage), (41, True, ""))
        self.assertEqual(blocks.t_us[-1], t + 60000000)

    def test_one_placement_of_a_pose_that_came_twice_is_withdrawn(self):
        made = Capture(100)
        made.writer.pose(placement(1, 55, 40))
        made.writer.withdraw(1, 55)
        made.writer.end(True)
        self.assertEqual([p.first for p in read_blocks(made.data()).placements], [0])


if __name__ == "__main__":
    unittest.main()
