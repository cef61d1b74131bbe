"""The other end of stream_frame: frames and text out of lines, whatever the cable did to them."""

import struct
from binascii import crc32

from sixflip.stream_frame import END, HEAD, HEAD_SIZE, NEWLINE, SIZES, SYNC, VALUES


def decode(line):
    """(kind, sequence, t_us, values) at the end of a line without newline, or None."""
    for size in SIZES:
        at = len(line) - size - 3
        if at >= 0 and line[at] == SYNC and line[-1] == END:
            found = _body(bytearray(line[at + 1:-1]))
            if found:
                return found
    return None


def _body(coded):
    at = 0
    while at < len(coded):
        step = coded[at] ^ NEWLINE
        coded[at] = NEWLINE
        if not step:
            return None
        at += step
    end = len(coded) - 4
    kind, sequence, t_us = struct.unpack_from(HEAD, coded, 1)
    if (at != len(coded) or kind >= len(SIZES) or SIZES[kind] != len(coded) - 1
            or crc32(bytes(coded[1:end])) & 0xFFFFFFFF != struct.unpack_from("<I", coded, end)[0]):
        return None
    return kind, sequence, t_us, struct.unpack_from(VALUES[kind], coded, 1 + HEAD_SIZE)


class FrameReader:
    """line(bytes) -> a frame, or text (str), or None for what is neither.

    lost     frames missing by their sequence numbers
    damaged  lines that were neither frame nor text
    """

    def __init__(self):
        self.lost = self.damaged = 0
        self.expected = None

    def line(self, line):
        while line[-1:] == b"\r":
            line = line[:-1]
        found = decode(line)
        if found:
            if self.expected is not None:
                self.lost += (found[1] - self.expected) & 0xFFFF
            self.expected = (found[1] + 1) & 0xFFFF
            return found
        for byte in line:
            if not 32 <= byte < 127 and byte != 9:
                self.damaged += 1
                return None
        return str(bytes(line), "ascii")
