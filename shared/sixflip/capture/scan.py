"""A capture's file gone through block by block, as a board can: its placements, notes and times
without its samples, and the moves between the placements, summed up from the samples as while
they came.
"""

import binascii
import struct
from array import array

from sixflip.capture import blocks as cb
from sixflip.capture.blocks import US, each, places, start
from sixflip.capture.reader import _header, _take, settle
from sixflip.poses.placement_log import PlacementLog, empty_move
from sixflip.poses.still_window import StillWindow

LENGTH = 32  # samples summed up in one go; any number will do


class CaptureMoves:
    """block() of every block of samples in the file's order; then moves() has them.

    placements  accepted in that file; columns: its mask; gyro_rail: |count| at or beyond is
                saturated, 0 without a gyro; lsb_per_dps: its counts
    """

    def __init__(self, placements, columns, period_us, gyro_rail, lsb_per_dps):
        self._to_come = list(placements)
        self._log = PlacementLog(period_us, lsb_per_dps if gyro_rail else 0)
        self._window = StillWindow(LENGTH, US, gyro_rail, period_us)
        self._places = places(columns)
        self._row = array("h", [0] * 10)
        self._counts = array("h", [0] * len(self._places))
        self._last_us = 0
        self._last_s = 0
        self._at = 0

    def block(self, block):
        """One whole block of samples, head and CRC included."""
        payload = block[4:-4]
        seconds, us, count = start(payload)
        # in it the first sample has no interval
        before = (seconds - self._last_s) * US + us - self._last_us
        for dt in each(block[0], payload, count, self._counts):
            us += dt
            for k in range(len(self._places)):
                self._row[self._places[k]] = self._counts[k]
            self._sample(before + dt)
            before = 0
        self._last_s = seconds + us // US
        self._last_us = us % US

    def skip(self, n):
        """So many samples are left out: a gap in the move under way, whose turn is not known."""
        self._at += n
        self._log.follow(False)

    def _sample(self, dt_us):
        to_come = self._to_come
        if to_come and self._at == to_come[0].first:
            self._flush()
            self._log.accept(to_come.pop(0))
        self._at += 1
        full = self._window.add(dt_us, self._row)
        placements = self._log.placements
        if placements and self._at == placements[-1].first + placements[-1].n:
            self._window.clear()
        elif full and not self._resting():
            self._log.add(self._window)

    def _resting(self):
        placements = self._log.placements
        return placements and self._at < placements[-1].first + placements[-1].n

    def _flush(self):
        if self._window.n < LENGTH:  # a full one is in the move already
            self._log.add(self._window)
        self._window.clear()

    def moves(self):
        """To each of the placements, and the one that was under way at the end. Where samples
        were not kept nothing is known of a move: it has none."""
        if self._to_come:
            return self._log.moves + [empty_move(0) for _ in range(len(self._to_come) + 1)]
        if not self._resting():
            self._flush()
        return self._log.moves + [self._log.open]


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
