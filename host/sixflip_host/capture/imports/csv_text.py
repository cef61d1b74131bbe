"""The text of somebody's CSV, whatever bytes it is in: its lines, its delimiter, and the line with
the column names.

UTF-8, with a mark at its beginning or without; UTF-16 where such a mark says so, as some
spreadsheets write; else Latin-1, in which ° and µ are one byte each. Numbers are the same in all
of them, so that nothing is guessed that a reading depends on.
"""

import codecs
import csv

from ...errors import BadFile
from ..unpack import whole_lines

LONGEST_LINE = 1 << 16
LATIN = 0xA0            # the first letter or sign of Latin-1 beyond ASCII
MOST_LATIN = 0.05       # of the bytes: a text with more is no table of numbers
UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
DELIMITERS = (",", ";", "\t", None)     # None: any run of blanks
SEARCH = 200            # lines in which the column names must appear
COMMENT = ("#", "//")


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


def first_lines(path, source, wanted):
    """The first lines of a file, some more than are wanted where there are as many."""
    lines = [""]
    for _, text in texts(path, source, head=wanted):
        more = text.replace("\0", "").split("\n")
        lines = [*lines[:-1], lines[-1] + more[0], *more[1:]]
        if len(lines) > wanted:
            break
    if not any(line.strip() for line in lines):
        raise BadFile.at(path, 1, "the file is empty", "a CSV file")
    return lines


def find_header(path, lines, delimiter, skip, is_header):
    """(index of the line of column names or None, lines before the rows, delimiter)."""
    choices = DELIMITERS if delimiter == "auto" else \
        (None if delimiter == "blank" else delimiter,)
    start = skip or 0
    if start >= len(lines):
        raise BadFile.at(path, len(lines), "only %d lines" % len(lines),
                         "more than the %d to skip" % start)
    search = range(start, min(len(lines), start + SEARCH)) if skip is None else (start,)
    for number in search:
        for separator in choices:
            if is_header and is_header(cells_of(lines[number].lstrip("#"), separator)):
                return number, number + 1, separator
    while skip is None and start + 1 < len(lines) and (
            not lines[start].strip() or lines[start].startswith(COMMENT)):
        start += 1
    separator = max(choices, key=lambda one: (len(cells_of(lines[start], one)), one is not None))
    points = lines[start] if separator == "," else lines[start].replace(",", ".")
    cells = cells_of(points, separator)
    if any(all_numbers([cell]) for cell in cells):     # no line of names has numbers in it
        return None, start, separator
    return start, start + 1, separator


def cells_of(line, separator):
    """The cells of a line without the blanks and the quotes around them."""
    if separator is None:
        return [cell.strip('"') for cell in line.split()]
    if '"' in line:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
            return [cell.strip() for cell in cells]
        except csv.Error:       # what it calls a line has an end inside
            pass
    return [cell.strip() for cell in line.strip().split(separator)] if separator != "\t" \
        else [cell.strip() for cell in line.rstrip("\r").split(separator)]


def all_numbers(cells):
    try:
        return bool([float(cell) for cell in cells])
    except ValueError:
        return False
