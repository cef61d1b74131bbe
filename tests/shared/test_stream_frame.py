"""Frames of the binary stream: there and back, and through noise."""

import unittest

from sixflip.capture.stream_frame import CORRECTED, HEADING, RAW, SIZES, FrameWriter
from sixflip_host.board.stream_reader import FrameReader, decode

COUNTS = (10, -10, 2570, 266, 32767, -32768, 0)     # many bytes that are newlines


def noise(seed, n):
    """n bytes of a 31-bit linear congruential generator."""
    out = bytearray(n)
    for i in range(n):
        seed = (seed * 1103515245 + 12345) & 0x3FFFFFFF
        out[i] = seed >> 16 & 255
    return bytes(out)


def lines_of(data):
    return data.split(b"\n")[:-1]


class Frames(unittest.TestCase):
    def test_every_kind_comes_back(self):
        for kind, values in ((RAW, COUNTS), (CORRECTED, (9.5, -0.25, 0.0, 1e-3, -10.0, 3e5)),
                             (HEADING, (-1.5, 89.75, 180.0))):
            writer = FrameWriter(kind)
            for t_us in (0, 10, 0x0A0A0A0A, 0xFFFFFFFF):
                data = bytes(writer.frame(t_us, values))
                self.assertEqual(data.count(b"\n"), 1)
                self.assertEqual(len(data), SIZES[kind] + 4)
                found = decode(data[:-1])
                self.assertEqual(found[0], kind)
                self.assertEqual(found[2], t_us)
                for x, y in zip(found[3], values):
                    self.assertAlmostEqual(x, y, 3 if kind != RAW else 9)

    def test_time_and_sequence_wrap(self):
        writer = FrameWriter(HEADING)
        writer.sequence = 65535
        first = decode(bytes(writer.frame(0x100000005, (0, 0, 0)))[:-1])
        self.assertEqual(first[1:3], (65535, 5))
        self.assertEqual(decode(bytes(writer.frame(0, (0, 0, 0)))[:-1])[1], 0)

    def test_every_changed_bit_is_noticed(self):
        data = bytes(FrameWriter(RAW).frame(123456, COUNTS))[:-1]
        for i in range(len(data)):
            for bit in range(8):
                bad = bytearray(data)
                bad[i] ^= 1 << bit
                self.assertIsNone(decode(bytes(bad)))

    def test_noise_is_no_frame(self):
        for seed in range(20):
            for line in lines_of(noise(seed, 3000)):
                self.assertIsNone(decode(line))


class Reader(unittest.TestCase):
    def read(self, data):
        """(reader, frames, texts) of a stream of bytes."""
        reader, frames, texts = FrameReader(), [], []
        for line in lines_of(data):
            found = reader.line(line)
            if isinstance(found, str):
                texts.append(found)
            elif found:
                frames.append(found)
        return reader, frames, texts

    def stream(self, n):
        writer = FrameWriter(RAW)
        return [bytes(writer.frame(10000 * i, COUNTS)) for i in range(n)]

    def test_clean(self):
        reader, frames, texts = self.read(b"".join(self.stream(100)))
        self.assertEqual([f[1] for f in frames], list(range(100)))
        self.assertEqual((reader.lost, reader.damaged, texts), (0, 0, []))

    def test_text_between_frames(self):
        frames = self.stream(3)
        data = frames[0] + b'{"event": "x"}\r\n' + frames[1][:-1] + b"\r\n" + frames[2]
        reader, found, texts = self.read(data)
        self.assertEqual(len(found), 3)
        self.assertEqual(texts, ['{"event": "x"}'])
        self.assertEqual((reader.lost, reader.damaged), (0, 0))

    def test_noise_before_a_frame_costs_nothing(self):
        frames = self.stream(2)
        reader, found, _ = self.read(frames[0] + b"\xa5\x00\xff5" + frames[1])
        self.assertEqual((len(found), reader.lost), (2, 0))

    def test_every_cut_loses_what_it_hit_and_no_more(self):
        frames = self.stream(4)
        for cut in range(1, len(frames[1])):
            # bytes of the second frame are missing, from `cut` on
            reader, found, _ = self.read(frames[0] + frames[1][:cut] + b"".join(frames[2:]))
            self.assertEqual([f[1] for f in found], [0, 2, 3])
            self.assertEqual(reader.lost, 1)

    def test_noise_inside(self):
        frames = self.stream(40)
        for seed in range(10):
            data = frames[:]
            data[20] = data[20][:9] + noise(seed, 50) + data[20][9:]
            reader, found, _ = self.read(b"".join(data))
            self.assertEqual(reader.lost, 1)
            self.assertEqual(len(found), 39)
            self.assertGreater(reader.damaged, 0)

    def test_lost_frames_are_counted_across_the_wrap(self):
        writer = FrameWriter(RAW)
        writer.sequence = 65530
        frames = [bytes(writer.frame(i, COUNTS)) for i in range(20)]
        reader, found, _ = self.read(b"".join(frames[:3] + frames[10:]))
        self.assertEqual((len(found), reader.lost), (13, 7))


if __name__ == "__main__":
    unittest.main()
