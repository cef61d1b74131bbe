"""The other end of stream_frame: frames and text out of lines, whatever the cable did to them."""

import struct
from binascii import a2b_base64, crc32

from sixflip.capture import pieces
from sixflip.capture.stream_frame import END, HEAD, HEAD_SIZE, NEWLINE, SIZES, SYNC, VALUES


def decode(line):
    """(kind, sequence, t_us, values) at the end of a line without newline, or None."""
    for size in SIZES:
        at = len(line) - size - 3
        if at >= 0 and line[at] == SYNC and line[-1] == END:
            frame = _body(bytearray(line[at + 1:-1]))
            if frame:
                return frame
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


def decode_piece(line):
    """(sequence, samples, piece of a capture) at the end of a line without newline, or None."""
    at = line.rfind(b"\xa5")
    if at < 0:
        return None
    try:
        body = a2b_base64(line[at + 1:])
    except ValueError:
        return None
    end = len(body) - 4
    if len(body) <= pieces.HEAD_SIZE + 4 \
            or struct.unpack_from("<I", body, end)[0] != crc32(body[:end]):
        return None
    return struct.unpack_from(pieces.HEAD, body) + (body[pieces.HEAD_SIZE:end],)


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
        frame = decode(line)
        if frame:
            if self.expected is not None:
                self.lost += (frame[1] - self.expected) & 0xFFFF
            self.expected = (frame[1] + 1) & 0xFFFF
            return frame
        for byte in line:
            if not 32 <= byte < 127 and byte != 9:
                self.damaged += 1
                return None
        return str(bytes(line), "ascii")
