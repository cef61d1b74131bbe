"""The lines of somebody's text file, whatever bytes it is in.

UTF-8, with a mark at its beginning or without; UTF-16 where such a mark says so, as some
spreadsheets write; else Latin-1, in which ° and µ are one byte each. Numbers are the same in all
of them, so that nothing is guessed that a reading depends on.
"""

import codecs

from ...errors import BadFile
from ..unpack import whole_lines

LONGEST_LINE = 1 << 16
LATIN = 0xA0            # the first letter or sign of Latin-1 beyond ASCII
MOST_LATIN = 0.05       # of the bytes: a text with more is no table of numbers
UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def texts(path, source, said=None, head=0):
    """(number of the first line, text of whole lines), blocks of a file; said: a dictionary
    whose keys become what nobody said of the bytes; head: lines that are no samples. BadFile
    for bytes that are no text."""
    latin = False
    for line, block in whole_lines(path, _narrow(source.pieces(), said), 1, LONGEST_LINE,
                                   head):
        if not latin:
            try:
                yield line, block.decode("utf-8-sig" if line == 1 else "utf-8")
                continue
            except UnicodeDecodeError as error:
                _check_latin(path, line, block, error.start)
                latin = True
                if said is not None:
                    said["its text is Latin-1 (ISO 8859-1), not UTF-8"] = True
        _check_latin(path, line, block, 0)
        yield line, block.decode("latin-1")


def _check_latin(path, line, block, start):
    """BadFile where bytes are no letters of Latin-1, or too many are."""
    wide = [place for place, byte in enumerate(block) if byte > 127]
    bad = [place for place in wide if block[place] < LATIN]
    if bad or len(wide) > max(1, MOST_LATIN * len(block)):
        place = max(start, bad[0]) if bad else start
        raise BadFile.at(path, line + block.count(b"\n", 0, place),
                         "bytes that are neither UTF-8 nor Latin-1 text", "a CSV file")


def _narrow(pieces, said):
    """Pieces of bytes; those of UTF-16, which a mark at the beginning tells, as UTF-8."""
    decoder = None
    for number, piece in enumerate(pieces):
        if not number and piece.startswith(UTF_16):
            decoder = codecs.getincrementaldecoder("utf-16")("replace")
            if said is not None:
                said["its text is UTF-16"] = True
        yield piece if decoder is None else decoder.decode(piece).encode()
