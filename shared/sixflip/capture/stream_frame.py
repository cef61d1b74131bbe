"""Samples as binary frames on a serial line that text uses too.

    A5 | COBS of the body, 0A the forbidden byte | 5A 0A
    body: kind u8, sequence u16, t_us u32, values, CRC-32 of all before; little-endian

A frame holds no newline but its last byte, so it is a line like any other: after noise the
next newline puts a receiver right, and no text is taken for a frame. COBS: Cheshire and
Baker, IEEE/ACM Trans. Networking 7(2), 1999.
"""

import struct
from binascii import crc32

SYNC = 0xA5
END = 0x5A
NEWLINE = 0x0A
RAW, CORRECTED, HEADING = 0, 1, 2
# 7 counts; a m/s2 and w rad/s; roll, pitch, yaw in degrees
VALUES = ("<7h", "<6f", "<3f")
HEAD = "<BHI"
HEAD_SIZE = 7
SIZES = tuple([HEAD_SIZE + struct.calcsize(form) + 4 for form in VALUES])  # of the bodies


class FrameWriter:
    """frame(t_us, values) -> the bytes to send, in a buffer that is used again."""

    def __init__(self, kind):
        self.sequence = 0
        self._kind = kind
        self._body = bytearray(SIZES[kind])
        self._encoded = bytearray(SIZES[kind] + 4)
        self._encoded[0] = SYNC
        self._encoded[-2] = END
        self._encoded[-1] = NEWLINE

    def frame(self, t_us, values):
        """The bytes of a frame; they are valid until the next call."""
        body = self._body
        struct.pack_into(HEAD, body, 0, self._kind, self.sequence, t_us & 0xFFFFFFFF)
        struct.pack_into(VALUES[self._kind], body, HEAD_SIZE, *values)
        end = len(body) - 4
        struct.pack_into("<I", body, end, crc32(memoryview(body)[:end]) & 0xFFFFFFFF)
        self.sequence = (self.sequence + 1) & 0xFFFF
        encoded = self._encoded
        code = 1  # where the distance to the next forbidden byte goes
        for i in range(len(body)):
            encoded[i + 2] = body[i]
            if body[i] == NEWLINE:
                encoded[code] = (i + 2 - code) ^ NEWLINE
                code = i + 2
        encoded[code] = (len(body) + 2 - code) ^ NEWLINE
        return encoded
