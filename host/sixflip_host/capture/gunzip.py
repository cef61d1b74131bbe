"""Unpack a .gz, and when it was cut short say how far it went."""

import zlib

from ..errors import BadFile

MAGIC = b"\x1f\x8b"
PIECE = 1 << 14         # bytes fed at a time: what is left behind a member is copied each time
GROWTH = 1 << 20        # bytes unpacked at a time
LARGEST = 1 << 28       # bytes unpacked in all: 14 hours at 100 Hz; gzip packs 1 : 1000


def gunzip(path, data):
    """The bytes inside a gzip file of one or more members, LARGEST at most.

    Raises BadFile naming the line in which a file that was cut short or damaged ends.
    """
    out = bytearray()
    member, pending, at = None, b"", 0
    while pending or at < len(data):
        if not pending:
            pending, at = data[at:at + PIECE], at + PIECE
        if member is None:
            pending = pending.lstrip(b"\0")     # tape drives pad with zeros
            if not pending:
                continue
            member = zlib.decompressobj(wbits=31)
        before = member.copy()
        try:
            out += member.decompress(pending, GROWTH)
        except zlib.error:
            out += _readable_part(before, pending)
            raise _ends(path, out, "the gzip file is damaged, here or before")
        if len(out) > LARGEST:
            raise BadFile("%s: unpacks to more than %d MB, expected less (unpack it first if that "
                          "is meant)" % (path, LARGEST >> 20))
        pending = member.unused_data if member.eof else member.unconsumed_tail
        member = None if member.eof else member
    if member is not None:
        raise _ends(path, out, "the gzip file was cut short here")
    return bytes(out)


def _ends(path, out, fault):
    return BadFile.at(path, out.count(b"\n") + 1, fault, "a complete gzip file")


def _readable_part(member, data):
    """What can be unpacked of a damaged piece, byte by byte."""
    out = b""
    try:
        for start in range(len(data)):
            out += member.decompress(data[start:start + 1], GROWTH)
    except zlib.error:
        pass
    return out
