"""The blocks of a capture on a serial line that text uses too, for a host that records them.

    A5 | base64 of the body | 0A
    body: sequence u16, samples u32, piece, CRC-32 of all before; little-endian

A piece is the capture's header or one of its blocks (blocks.py) as it stands in the
file; samples: how many the board had written before it. The base64 of C code costs a third more
bytes and no time in the sampling loop; A5 is in no text and in no base64, so that the last one
in a line is the beginning of a piece whatever came before it, and after noise the next newline
puts a receiver right.
"""

import binascii
import struct

SYNC = 0xA5
HEAD = "<HI"
HEAD_SIZE = 6


class PieceWriter:
    """send(samples, piece) through write_bytes; the body's buffer is used again."""

    def __init__(self, write_bytes):
        self.sequence = 0
        self._write_bytes = write_bytes
        self._body = bytearray(0)

    def send(self, samples, piece):
        """Sends a header or block; samples: how many were written before it."""
        end = HEAD_SIZE + len(piece)
        if len(self._body) < end + 4:
            self._body = bytearray(end + 4)
        body = self._body
        struct.pack_into(HEAD, body, 0, self.sequence, samples)
        self.sequence = (self.sequence + 1) & 0xFFFF
        body[HEAD_SIZE:end] = piece
        view = memoryview(body)[: end + 4]
        struct.pack_into("<I", body, end, binascii.crc32(view[:end]) & 0xFFFFFFFF)
        self._write_bytes(b"\xa5")
        self._write_bytes(binascii.b2a_base64(view))
