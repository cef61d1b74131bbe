"""The raw capture on the board: a header, then blocks with a CRC each; little-endian.

header  magic b"6CAP", version u8, column mask u8, length u16, JSON metadata, CRC32 of it all
block   type u8, 0 u8, length u16, payload, CRC32 of all of it
  SAMPLES    first sample's time (s u32, us u32), count u16,
             then a sample each: us since the one before u16, int16 columns
  STEPS      begins likewise; the first sample is whole, of the others each number is the step
             from the one before in a byte (-127 to 127), or WIDE and the number in two bytes
  POSE       pose u16, first u32, n u32, duration_us u64, seven sums i64, six noises f32
  WITHDRAWN  pose u16: its placements so far do not count; followed by first u32: only that one
  NOTE       UTF-8 text
  LOST       first u32, n u32: samples that never came to whoever wrote the file down
  END        samples u32, flags u8 (COMPLETE, SUMS_ONLY)
A cut-off file is readable up to its last whole block. Version 1 had neither STEPS nor LOST.
With STEPS a session takes 9 to 10 bytes a sample of seven columns instead of 16.6
(tests/bench/capture_size.py), for a fifth more instructions a sample.
"""

import binascii
import struct
from array import array

MAGIC = b"6CAP"
VERSION = 2
ACCEL = 1
GYRO = 2
TEMP = 4
MAG = 8
GROUPS = ((ACCEL, 0, 3), (GYRO, 3, 3), (TEMP, 6, 1), (MAG, 7, 3))  # mask, place in sample, n

SAMPLES = 1
POSE = 2
WITHDRAWN = 3
NOTE = 4
END = 5
STEPS = 6
LOST = 7
COMPLETE = 1
SUMS_ONLY = 2

HEAD = "<4sBBH"
BLOCK = "<BBH"
TIME = "<IIH"
PLACEMENT = "<HIIQ7q6f"
FINISH = "<IB"
MOST_SAMPLES = 2048  # in a block: its length is 16 bits
GAP_US = 65535
US = 1000000
WIDE = 128  # instead of a step: the number itself follows


def places(columns):
    """Indices into the sample of the columns in a mask, in the order of the file."""
    found = []
    for mask, first, n in GROUPS:
        if columns & mask:
            found.extend(range(first, first + n))
    return found


class BlockWriter:
    """Streams a capture through write(bytes); buffers made once, nothing allocated per sample.

    sums_only: flash is short, samples are counted and not kept. What write() raises passes
    through; the blocks written so far stay readable. meta_bytes None: a file is continued,
    see capture_scan.
    """

    def __init__(self, write, meta_bytes, columns=ACCEL | GYRO | TEMP, block_samples=32,
                 sums_only=False):
        if meta_bytes is not None and len(meta_bytes) > 65535:
            raise ValueError("metadata of a capture has at most 65535 bytes")
        self._places = places(columns)
        if columns & ~15 or not self._places:
            raise ValueError("column mask %d: expected a sum of 1, 2, 4 and 8" % columns)
        width = 2 + 2 * len(self._places)
        if not 0 < block_samples <= MOST_SAMPLES:
            raise ValueError("a block has 1 to %d samples" % MOST_SAMPLES)
        self._write = write
        self.sums_only = sums_only
        self.samples = 0
        self._most = block_samples
        self._count = 0
        self._seconds = 0
        self._us = 0
        self._start_s = 0
        self._start_us = 0
        self._last = array("h", [0] * 10)
        self._last_dt = 0
        self._buffer = bytearray(0 if sums_only else 4 + 10 + block_samples * width + 4)
        self._full = len(self._buffer) - 4 - 3 * (width // 2)  # no room for a wide sample
        self._at = 14
        if meta_bytes is not None:
            head = struct.pack(HEAD, MAGIC, VERSION, columns, len(meta_bytes))
            crc = binascii.crc32(meta_bytes, binascii.crc32(head))
            write(head)
            write(meta_bytes)
            write(struct.pack("<I", crc))

    def add(self, dt_us, sample):
        """One sample (ax ay az gx gy gz temp, mx my mz if any), dt_us after the one before."""
        self.samples += 1
        us = self._us + dt_us
        if us >= US:
            self._seconds += us // US
            us %= US
        self._us = us
        if self.sums_only:
            return
        if self._count and (dt_us > GAP_US or self._count == self._most
                            or self._at > self._full):
            self.flush()
        if self._count == 0:
            self._first(sample)
            return
        self._count += 1
        buffer = self._buffer
        last = self._last
        at = self._at
        step = dt_us - self._last_dt
        if -128 < step < 128:
            buffer[at] = step & 255
            at += 1
        else:
            buffer[at] = WIDE
            struct.pack_into("<H", buffer, at + 1, dt_us)
            at += 3
        self._last_dt = dt_us
        for i in self._places:
            value = sample[i]
            step = value - last[i]
            if -128 < step < 128:
                buffer[at] = step & 255
                at += 1
            else:
                buffer[at] = WIDE
                struct.pack_into("<h", buffer, at + 1, value)
                at += 3
            last[i] = value
        self._at = at

    def _first(self, sample):
        """The first sample of a block, whole."""
        self._count = 1
        self._start_s = self._seconds
        self._start_us = self._us
        self._last_dt = 0
        at = 14
        struct.pack_into("<H", self._buffer, at, 0)
        for i in self._places:
            at += 2
            struct.pack_into("<h", self._buffer, at, sample[i])
            self._last[i] = sample[i]
        self._at = at + 2

    def flush(self):
        """Write the samples that are waiting as a block."""
        if self._count == 0:
            return
        buffer = self._buffer
        struct.pack_into(BLOCK, buffer, 0, STEPS, 0, self._at - 4)
        struct.pack_into(TIME, buffer, 4, self._start_s, self._start_us, self._count)
        view = memoryview(buffer)
        struct.pack_into("<I", buffer, self._at, binascii.crc32(view[: self._at]))
        end = self._at + 4
        self._count = 0
        self._at = 14
        self._write(view[:end])

    def _block(self, kind, payload):
        self.flush()
        block = struct.pack(BLOCK, kind, 0, len(payload)) + payload
        self._write(block + struct.pack("<I", binascii.crc32(block)))

    def pose(self, placement):
        p = placement
        values = list(p.sums) + list(p.noise)
        self._block(
            POSE, struct.pack(PLACEMENT, p.pose, p.first, p.n, int(p.duration_us), *values)
        )

    def withdraw(self, code, first=None):
        """All placements of a pose, or only the one whose first sample that is."""
        payload = struct.pack("<H", code)
        self._block(WITHDRAWN, payload if first is None else payload + struct.pack("<I", first))

    def note(self, text):
        self._block(NOTE, text.encode()[:1024])

    def end(self, complete):
        """Last block; complete: every pose that was asked for is there."""
        flags = (COMPLETE if complete else 0) | (SUMS_ONLY if self.sums_only else 0)
        self._block(END, struct.pack(FINISH, self.samples, flags))
