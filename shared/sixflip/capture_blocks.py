"""The raw capture on the board: a header, then blocks with a CRC each; little-endian.

header  magic b"6CAP", version u8, column mask u8, length u16, JSON metadata, CRC32 of it all
block   type u8, 0 u8, length u16, payload, CRC32 of all of it
  SAMPLES    first sample's time (s u32, us u32), count u16,
             then a sample each: us since the one before u16, int16 columns
  POSE       pose u16, first u32, n u32, duration_us u64, seven sums i64, six noises f32
  WITHDRAWN  pose u16: its placements so far do not count; followed by first u32: only that one
  NOTE       UTF-8 text
  END        samples u32, flags u8 (COMPLETE, SUMS_ONLY)
A cut-off file is readable up to its last whole block.
"""

import binascii
import struct

MAGIC = b"6CAP"
VERSION = 1
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
        self._buffer = bytearray(0 if sums_only else 4 + 10 + block_samples * width + 4)
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
        if self._count and (dt_us > GAP_US or self._count == self._most):
            self.flush()
        if self._count == 0:
            self._start_s = self._seconds
            self._start_us = us
            dt_us = 0
        buffer = self._buffer
        at = self._at
        struct.pack_into("<H", buffer, at, dt_us)
        for i in self._places:
            at += 2
            struct.pack_into("<h", buffer, at, sample[i])
        self._at = at + 2
        self._count += 1

    def flush(self):
        """Write the samples that are waiting as a block."""
        if self._count == 0:
            return
        buffer = self._buffer
        struct.pack_into(BLOCK, buffer, 0, SAMPLES, 0, self._at - 4)
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
