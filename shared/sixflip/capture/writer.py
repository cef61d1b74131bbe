"""Writes the raw capture of blocks.py while its samples are taken."""

import binascii
import struct
from array import array

from sixflip.capture import blocks as cb


class BlockWriter:
    """Streams a capture through write(bytes); buffers made once, nothing allocated per sample.

    sums_only: flash is short, samples are counted and not kept. What write() raises passes
    through; the blocks written so far stay readable. meta_bytes None: a file is continued,
    see capture_scan. written: how many of the samples are in whole blocks.
    """

    def __init__(self, write, meta_bytes, columns=cb.ACCEL | cb.GYRO | cb.TEMP,
                 block_samples=32, sums_only=False):
        self._places = cb.places(columns)
        if columns & ~15 or not self._places:
            raise ValueError("column mask %d: expected a sum of 1, 2, 4 and 8" % columns)
        n = 1 + len(self._places)  # the interval and the counts
        if not 0 < block_samples <= cb.MOST_SAMPLES:
            raise ValueError("a block has 1 to %d samples" % cb.MOST_SAMPLES)
        self._write = write
        self.sums_only = sums_only
        self.samples = 0
        self.written = 0
        self._most = block_samples
        self._count = 0
        self._seconds = 0
        self._us = 0
        self._start_s = 0
        self._start_us = 0
        self._last = array("h", [0] * 10)
        self._last_dt = 0
        self._buffer = bytearray(0 if sums_only else 18 + (2 * block_samples + 1) * n)
        self._full = len(self._buffer) - 4 - 3 * n  # beyond: no room for a wide sample
        self._at = 14
        if meta_bytes is not None:
            write(cb.header(meta_bytes, columns))

    def add(self, dt_us, sample):
        """One sample (ax ay az gx gy gz temp, mx my mz if any), dt_us after the one before."""
        self.samples += 1
        us = self._us + dt_us
        if us >= cb.US:
            self._seconds += us // cb.US
            us %= cb.US
        self._us = us
        if self.sums_only:
            return
        if self._count and (dt_us > cb.GAP_US or self._count == self._most
                            or self._at > self._full):
            self.flush()
        last = self._last
        if self._count == 0:
            self._start_s = self._seconds
            self._start_us = us
            for i in self._places:
                last[i] = 0
            self._last_dt = dt_us = 0
        self._count += 1
        buffer = self._buffer
        at = self._at
        step = dt_us - self._last_dt
        self._last_dt = dt_us
        if -128 < step < 128:
            buffer[at] = step & 255
            at += 1
        else:
            at = self._wide(at, "<H", dt_us)
        for i in self._places:
            value = sample[i]
            step = value - last[i]
            last[i] = value
            if -128 < step < 128:
                buffer[at] = step & 255
                at += 1
            else:
                at = self._wide(at, "<h", value)
        self._at = at

    def _wide(self, at, form, value):
        """A number whose step does not fit a byte; where it ends."""
        self._buffer[at] = cb.WIDE
        struct.pack_into(form, self._buffer, at + 1, value)
        return at + 3

    def flush(self):
        """Write the samples that are waiting as a block."""
        if self._count == 0:
            return
        buffer = self._buffer
        struct.pack_into(cb.BLOCK, buffer, 0, cb.STEPS, 0, self._at - 4)
        struct.pack_into(cb.TIME, buffer, 4, self._start_s, self._start_us, self._count)
        view = memoryview(buffer)
        struct.pack_into("<I", buffer, self._at, binascii.crc32(view[: self._at]))
        end = self._at + 4
        count, self._count = self._count, 0
        self._at = 14
        self._write(view[:end])
        self.written += count

    def _block(self, kind, payload):
        self.flush()
        block = struct.pack(cb.BLOCK, kind, 0, len(payload)) + payload
        self._write(block + struct.pack("<I", binascii.crc32(block)))

    def pose(self, placement):
        """A Placement."""
        p = placement
        values = list(p.sums) + list(p.noise)
        self._block(
            cb.POSE, struct.pack(cb.PLACEMENT, p.pose, p.first, p.n, int(p.duration_us), *values)
        )

    def withdraw(self, code, first=None):
        """All placements of a pose, or only the one whose first sample that is."""
        payload = struct.pack("<H", code)
        self._block(cb.WITHDRAWN, payload if first is None else payload + struct.pack("<I", first))

    def note(self, text):
        """A sentence about what happened, 1024 bytes at most."""
        self._block(cb.NOTE, text.encode()[:1024])

    def end(self, complete):
        """Last block; complete: every pose that was asked for is there."""
        flags = (cb.COMPLETE if complete else 0) | (cb.SUMS_ONLY if self.sums_only else 0)
        self._block(cb.END, struct.pack(cb.FINISH, self.samples, flags))
