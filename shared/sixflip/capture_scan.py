"""Goes through a capture's file block by block: what a board can hold of it, without samples."""

import binascii
import struct
from array import array

from sixflip import capture_blocks as cb
from sixflip.capture_reader import _header, _take, settle
from sixflip.capture_samples import each, start

MOST_META = 4096


def go_on(writer, samples, seconds, us):
    """For a BlockWriter: so many samples are in the file, and the time is that."""
    writer.samples = writer.written = samples
    writer._seconds = seconds
    writer._us = us


def samples_in(block):
    """Their number in a block of samples."""
    return block[12] | block[13] << 8


def first_of(block):
    """The first sample of a block of a pose."""
    return struct.unpack_from("<I", block, 6)[0]


class Scan:
    """blocks() of an open file; afterwards .blocks is a capture_reader.Blocks without samples.

    seconds, us  time of the last sample; stored: the samples that are in the file; ValueError
    when it has no readable header
    """

    def __init__(self, stream):
        self._stream = stream
        head = stream.read(struct.calcsize(cb.HEAD))
        length = struct.unpack(cb.HEAD, head)[3] if len(head) == struct.calcsize(cb.HEAD) else 0
        if length > MOST_META:
            raise ValueError("its metadata has %d bytes, %d is the most" % (length, MOST_META))
        self.blocks = _header(head + stream.read(length + 4))[0]
        self.seconds = self.us = self.stored = 0
        self._row = array("h", [0] * len(self.blocks.names))

    def each(self):
        """(kind, the whole block in bytes) of every good block up to the end or the damage."""
        yield from self._blocks()
        settle(self.blocks)

    def _blocks(self):
        blocks = self.blocks
        while not blocks.ended:
            head = self._stream.read(4)
            if len(head) < 4:
                return
            kind, _, length = struct.unpack(cb.BLOCK, head)
            block = head + self._stream.read(length + 4)
            end = 4 + length
            if len(block) != end + 4 or \
                    struct.unpack("<I", block[end:])[0] != binascii.crc32(block[:end]):
                return
            if kind == cb.SAMPLES or kind == cb.STEPS:
                try:
                    self._time(kind, block[4:end])
                except ValueError:
                    return
            elif kind == cb.END:
                blocks.ended = True
                blocks.samples, flags = struct.unpack(cb.FINISH, block[4:end])
                blocks.sums_only = bool(flags & cb.SUMS_ONLY)
            else:
                try:
                    _take(blocks, kind, block[4:end])
                except ValueError:
                    return
            yield kind, block

    def _time(self, kind, payload):
        """Count the samples of a block and add up their intervals."""
        seconds, us, count = start(payload)
        for dt in each(kind, payload, count, self._row):
            us += dt
        self.stored += count
        self.blocks.samples += count
        self.seconds = seconds + us // cb.US
        self.us = us % cb.US

    def samples(self):
        """Those that were taken: the poses tell it where the end is missing."""
        blocks = self.blocks
        return max([blocks.samples] + [p.first + p.n for p in blocks.placements])

    def sums_only(self):
        """Some of the samples were not kept."""
        return self.blocks.sums_only or self.samples() > self.stored
