"""A board's capture, written down on this computer while it is taken.

The blocks that come over the port (sixflip.capture.pieces) are appended to a file as they are,
so that it is a capture of a board at every moment: kill this program, pull the plug, and what
is missing is the block that was on its way.
"""

import contextlib
import json
import math
import os
import struct
import time
import zlib

from sixflip.capture import blocks as cb
from sixflip.capture.blocks import start
from sixflip.capture.reader import LOST

from ..capture.capture_binary import UNLABELLED
from ..errors import BadFile, SixflipError
from ..narration import log
from .stream_reader import decode_piece

SYNC_S = 1.0            # so much may be lost where this computer loses its power
WAITING = 2000          # pieces kept while the header has not come: ten minutes
ASK_EVERY = 20          # pieces from one question for the header to the next
# Bytes on the wire, as tests/studies/bench/capture_size.py prints them.
UART_BYTES = 11520      # a second at 115200 baud, of a board without USB of its own
SHAKEN_BYTES = 33       # a sample of seven columns that jump by more than a byte, in base64
EVENTS_BYTES = 1000     # a second that a session's events take: three states of 300 bytes
SLOW = 0.97             # of rate_hz: a board that is held up by more, not by its flash alone


class Recording:
    """take(line) every line of the port; close() at last, which raises nothing.

    path       of the file; None: DEVICE-SESSION.bin in the current folder, known with the header
    labelled   whether poses will be named: not of a static log
    samples, lost, gaps   so many are in the file, so many never came, in so many places
    ended      the board has said that it was all
    """

    def __init__(self, path=None, labelled=True):
        self.path = path
        self.labelled = labelled
        self.samples = self.lost = self.gaps = 0
        self.times = []         # (seconds of the first and of the last block, samples before)
        self.ended = self.other = False
        self.header = None
        self.file = None
        self.synced = 0.0
        self.expected = 0       # samples by the board's count
        self.waiting = []
        self.poses = set()
        self.meta = {}

    # -- what the board sends

    def take(self, line):
        """Whether the line was a piece; it is on the disk then."""
        decoded = decode_piece(line)
        if decoded is None:
            return False
        _, samples, piece = decoded
        if piece[:4] == cb.MAGIC:
            self._begin(piece)
        elif self.file is None:
            if len(self.waiting) < WAITING:
                self.waiting.append((samples, piece))
        else:
            self._piece(samples, piece)
        return True

    def wants_header(self):
        """Whether to ask the board for the header once more: it got lost on the way."""
        return self.file is None and len(self.waiting) % ASK_EVERY == 1

    def _begin(self, header):
        if self.header is not None:
            self.other |= header != self.header     # else it was asked for twice
            return
        size = struct.calcsize(cb.HEAD)
        try:
            meta = json.loads(header[size:-4])
        except (ValueError, RecursionError):
            meta = None
        self.meta = meta if isinstance(meta, dict) else {}
        if self.path is None:
            self.path = name_of(self.meta)
        try:
            # a name that is given was asked about before, one that is made up replaces nothing
            self.file = open(self.path, "wb", buffering=0)  # noqa: SIM115 - closed by close()
        except OSError as error:
            raise BadFile("%s: cannot be written: %s" % (self.path, error.strerror)) from None
        self.header = header
        log.info("recording into %s", self.path)
        self._write(header)
        if not self.labelled:
            self._block(cb.NOTE, UNLABELLED.encode())
        waiting, self.waiting = self.waiting, []
        for samples, piece in waiting:
            self._piece(samples, piece)

    def _piece(self, samples, piece):
        if self.ended or self.other or samples < self.expected:
            return
        if samples > self.expected:
            self._block(LOST, struct.pack("<II", self.expected, samples - self.expected))
            self.lost += samples - self.expected
            self.gaps += 1
            self.expected = samples
        kind, payload = piece[0], piece[4:-4]
        if kind == cb.POSE:
            if piece in self.poses:     # they come once more at the end
                return
            self.poses.add(piece)
        elif kind == cb.END:
            self.ended = True
            self._say_gaps()
        elif kind in (cb.SAMPLES, cb.STEPS):
            with contextlib.suppress(ValueError):
                seconds, us, count = start(payload)
                self.times = [*self.times[:1], (seconds + us * 1e-6, self.expected)]
                self.expected += count
                self.samples += count
        self._write(piece)

    # -- the file

    def _write(self, data):
        try:
            self.file.write(data)
            now = time.monotonic()
            if now - self.synced > SYNC_S:
                os.fsync(self.file.fileno())
                self.synced = now
        except OSError as error:
            raise BadFile("%s: cannot be written: %s" % (self.path, error.strerror)) from None

    def _block(self, kind, payload):
        block = struct.pack(cb.BLOCK, kind, 0, len(payload)) + payload
        self._write(block + struct.pack("<I", zlib.crc32(block)))

    def _say_gaps(self):
        if self.lost:
            self._block(cb.NOTE, ("recorded over the port: %s" % self.gaps_in_words()).encode())

    def gaps_in_words(self):
        return "%d of %d samples never came, in %d place%s" % (
            self.lost, self.lost + self.samples, self.gaps, "s" if self.gaps > 1 else "")

    def end(self):
        """For a log that has no end of its own: what came was all of it."""
        if self.file is not None and not self.ended:
            self._say_gaps()
            self._block(cb.END, struct.pack(cb.FINISH, self.expected, 0))
            self.ended = True

    def close(self):
        """Whatever happened. What has not come to its end is still readable."""
        file, self.file = self.file, None
        if file is not None:
            with contextlib.suppress(OSError):
                os.fsync(file.fileno())
            file.close()

    def words(self):
        """Lines on what came of it."""
        if self.header is None:
            return ["nothing was recorded: %s" % (
                "the board's header never came" if self.waiting else
                "the board sends no samples; is its firmware of this version? "
                "(sixflip provision)")]
        said = ["recorded: %s, %d samples" % (self.path, self.samples)]
        if self.lost:
            said.append("%s; diagnose does not take them for the sensor's losses"
                        % self.gaps_in_words())
        if self.held_up():
            said.append("the samples came at %.1f Hz instead of %g: the link is too slow for the "
                        "board, or its flash" % (self.rate(), self.meta["rate_hz"]))
        if not self.ended:
            said.append("the recording was cut short: all but its last block is there")
        if self.other:
            said.append("the board has begun another session meanwhile, which is not in the file")
        return said

    def recorded_s(self):
        """Seconds by the board's clock, to the beginning of the last block."""
        return self.times[-1][0] if self.times else 0.0

    def rate(self):
        """Samples a second by the board's clock, those that never came among them."""
        (begun, before), (ended, after) = self.times[0], self.times[-1]
        return (after - before) / (ended - begun) if ended > begun else math.nan

    def held_up(self):
        nominal = self.meta.get("rate_hz")
        return len(self.times) == 2 and isinstance(nominal, (int, float)) and (
            self.rate() < SLOW * nominal)

    def slow_link(self):
        """A sentence where a port of 115200 baud would be too slow for this board's rate, None
        else. USB has room for every rate."""
        rate = self.meta.get("rate_hz")
        if not isinstance(rate, (int, float)):
            return None
        needed = rate * SHAKEN_BYTES + EVENTS_BYTES
        if needed < UART_BYTES:
            return None
        return ("at %g Hz a shaken sensor sends %.1f KB a second: a port of 115200 baud (%.1f KB) "
                "would hold the board up, USB does not" % (rate, needed / 1e3, UART_BYTES / 1e3))


def name_of(meta):
    """DEVICE-SESSION.bin of a header, which is not to be trusted; a name that is free."""
    device = "".join(c for c in str(meta.get("device_id", "")) if c.isascii() and c.isalnum())
    session = meta.get("session")
    stem = "%s-%s" % (device[:40] or "board", "%08x" % session
                      if type(session) is int and 0 <= session < 1 << 32 else "session")
    number, name = 1, stem + ".bin"
    while os.path.exists(name):
        number += 1
        name = "%s-%d.bin" % (stem, number)
    return name


class RecordingLink:
    """A Link whose lines pass through a Recording; everything else is the link's."""

    def __init__(self, link, recording):
        self.link = link
        self.recording = recording

    def __getattr__(self, name):
        return getattr(self.link, name)

    def lines(self, timeout):
        """Text lines; an empty one for each piece of the capture, which is in the file."""
        for line in self.link.raw_lines(timeout):
            piece = self.recording.take(line)
            if piece and self.recording.wants_header():
                with contextlib.suppress(SixflipError):
                    self.link.send('{"cmd": "record"}')
            yield "" if piece else line.decode("utf-8", "replace")
