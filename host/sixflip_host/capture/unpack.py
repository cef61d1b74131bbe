"""The bytes of a file piece by piece, unpacked where they are gzip, and in whole lines."""

import os
import stat
import tempfile
import zlib

from .. import sample_limit
from ..errors import BadFile
from ..narration import log

MAGIC = b"\x1f\x8b"
PIECE = 1 << 14         # bytes fed at a time: what is left behind a member is copied each time
GROWTH = 1 << 18        # bytes handed on at a time: reading takes ten times as much memory


class Source:
    """pieces() of a file, from its beginning each time, also where it is a pipe."""

    def __init__(self, path):
        self.path = os.fspath(path)
        self._pipe = None
        self._so_far = None     # of a pipe: what came out of it

    def pieces(self):
        """The content in pieces of some 256 KB; BadFile where it cannot be read or unpacked."""
        log.info("reading %s", self.path)
        raw = self._raw()
        first = next(raw, b"")
        size = 0
        for piece in _gunzip(self.path, first, raw) if first.startswith(MAGIC) \
                else _chain(first, raw):
            size += len(piece)
            sample_limit.check_bytes(self.path, size)
            yield piece

    def _raw(self):
        try:
            if self._pipe is None:
                with open(self.path, "rb") as file:
                    if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                        yield from iter(lambda: file.read(GROWTH), b"")
                        return
                    self._pipe = os.fdopen(os.dup(file.fileno()), "rb")
                    self._so_far = tempfile.TemporaryFile()     # noqa: SIM115  kept to read again
            yield from self._of_a_pipe()
        except OSError as error:
            raise BadFile("%s: cannot be read: %s" % (self.path, error.strerror)) from None

    def _of_a_pipe(self):
        at = 0
        while True:
            self._so_far.seek(at)
            piece = self._so_far.read(GROWTH)
            if not piece:
                piece = self._pipe.read(GROWTH)
                self._so_far.write(piece)
            if not piece:
                return
            at += len(piece)
            yield piece


def _chain(first, rest):
    if first:
        yield first
    yield from rest


def _gunzip(path, first, rest):
    """What is inside one or more gzip members.

    Raises BadFile naming the line in which a file that was cut short or damaged ends.
    """
    member, pending, lines = None, b"", 0
    for raw in _chain(first, rest):
        for start in range(0, len(raw), PIECE):
            pending = raw[start:start + PIECE]
            while pending:
                if member is None:
                    pending = pending.lstrip(b"\0")     # tape drives pad with zeros
                    if not pending:
                        break
                    member = zlib.decompressobj(wbits=31)
                before = member.copy()
                try:
                    unpacked = member.decompress(pending, GROWTH)
                except zlib.error:
                    lines += _readable_part(before, pending).count(b"\n")
                    raise _ends(path, lines, "the gzip file is damaged, here or before") from None
                lines += unpacked.count(b"\n")
                if unpacked:
                    yield unpacked
                pending = member.unused_data if member.eof else member.unconsumed_tail
                member = None if member.eof else member
    while member is not None:       # what is left in it after the last byte
        unpacked = member.decompress(b"", GROWTH)
        if not unpacked:
            raise _ends(path, lines, "the gzip file was cut short here")
        lines += unpacked.count(b"\n")
        yield unpacked
        member = None if member.eof else member


def _ends(path, lines, fault):
    return BadFile.at(path, lines + 1, fault, "a complete gzip file")


def _readable_part(member, data):
    """What can be unpacked of a damaged piece, byte by byte."""
    unpacked = b""
    try:
        for start in range(len(data)):
            unpacked += member.decompress(data[start:start + 1], GROWTH)
    except zlib.error:
        pass
    return unpacked


def whole_lines(path, pieces, first_line, longest, head=0):
    """(number of the first line, whole lines) of pieces of text, \\r\\n made \\n.

    The last one has no newline at its end where the text has none. BadFile for a line of more
    than `longest` bytes; lines count against the limit of samples, all
    but the first `head`.
    """
    rest, line = b"", first_line
    for piece in pieces:
        end = piece.rfind(b"\n") + 1
        if not end:
            rest += piece
            _check_length(path, line, rest, longest)
            continue
        block = (rest + piece[:end]).replace(b"\r\n", b"\n")
        rest = piece[end:]
        _check_length(path, line, block[:block.find(b"\n")], longest)
        yield line, block
        line += block.count(b"\n")
        sample_limit.check_samples(path, line - first_line - head)
    if rest:
        _check_length(path, line, rest, longest)
        yield line, rest


def _check_length(path, line, text, longest):
    if len(text) > longest:
        raise BadFile.at(path, line, "a line of %d characters" % len(text),
                         "%d at most" % longest)
