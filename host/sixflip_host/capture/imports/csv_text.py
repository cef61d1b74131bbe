"""The text of somebody's CSV, whatever bytes it is in: its lines, its delimiter, and the line with
the column names.

UTF-8, with a mark at its beginning or without; UTF-16 where such a mark says so, as some
spreadsheets write; else Latin-1, in which ° and µ are one byte each. Numbers are the same in all
of them, so that nothing is guessed that a reading depends on.
"""

import codecs
import collections
import csv
import re

from ...errors import BadFile
from ..unpack import whole_lines
from . import column_names

LONGEST_LINE = 1 << 16
LATIN = 0xA0            # the first letter or sign of Latin-1 beyond ASCII
MOST_LATIN = 0.05       # of the bytes: a text with more is no table of numbers
UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
DELIMITERS = (",", ";", "\t", None)     # None: any run of blanks
SEARCH = 200            # lines in which the column names must appear
DECIMAL = re.compile(r"(?<=\d),(?=\d)")
COMMENT = ("#", "//")
# The exclusive or of a sentence's characters behind a star, as receivers and VectorNav's sensors
# write it [NMEA 0183, 5.3].
CHECKSUM = re.compile(r"^([ \t]*\$[^\n]*)\*[0-9A-Fa-f]{2}[ \t\r]*$", re.MULTILINE)
# A cell in quotes, from where a cell begins to where one ends, and a line's end within it.
QUOTED = re.compile(r'(?:(?<=[,;\t])|^) *"(?:[^"]|"")*"(?= *(?:[,;\t]|$))', re.MULTILINE)
INSIDE = "\v"
IN_TURN = " in each row, or a file for each sensor where they have rows in turn"


def texts(path, source, said=None, head=0):
    """(number of the first line, text of whole lines), blocks of a file in which every row is one
    line: a line's end within quotes is a blank, and the row has as many empty lines behind it, so
    that numbers of lines stay. said: a dictionary whose keys become what nobody said of the bytes;
    head: lines that are no samples. BadFile for bytes that are no text."""
    held, first = "", 1
    for line, text in _decoded(path, source, said, head):
        if held:
            line, text = first, held + text
        if '"' not in text:
            held = ""
            yield line, text
            continue
        text = _rows_in_lines(text)
        # A row whose quotes are still open ends in the next block, or they are no quotes.
        start = text.rfind("\n", 0, text.rfind('"')) + 1
        is_open = text.count('"', start) % 2 and not (held and not start)
        end = start if is_open and len(text) - start < LONGEST_LINE else len(text)
        held, first = text[end:], line + text.count("\n", 0, end)
        if end:
            yield line, text[:end]
    if held:
        yield first, held


def _rows_in_lines(text):
    """Text in which every row that has an end of a line within quotes is one line."""
    if not any(line.count('"') % 2 for line in text.split("\n")):
        return text
    text = QUOTED.sub(lambda cell: cell[0].replace("\n", INSIDE), text)
    return "\n".join(line.replace(INSIDE, " ") + "\n" * line.count(INSIDE)
                     for line in text.split("\n"))


def _decoded(path, source, said, head):
    """(number of the first line, text of whole lines), blocks of a file as it is."""
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
    separator = max(choices, key=lambda one: (
        sum(len(_numbers(line, one)) for line in lines[start:start + SEARCH]),
        len(cells_of(lines[start], one)), one is not None))
    if skip is None:
        start = _before_rows(lines, separator)
    if _numbers(lines[start], separator):       # no line of names has numbers in it
        return None, start, separator
    return start, start + 1, separator


def _before_rows(lines, separator):
    """Index of the first line that is a row, or of the one before it where that has as many cells,
    names that nobody knows, or of that before a line of their units. What else stands before them
    is what a board says when it starts. Rows are the lines with the usual number of numbers; where
    there are none, of the first line with anything in it."""
    places = filled(lines[:SEARCH])
    numbers = [len(_numbers(lines[place], separator)) for place in places]
    rows = collections.Counter(number for number in numbers if number)
    if not rows:
        return places[0] if places else len(lines) - 1
    first = numbers.index(rows.most_common(1)[0][0])
    cells = [cells_of(lines[place], separator) for place in places[:first + 1]]
    named = first > 0 and not numbers[first - 1] and len(cells[first - 1]) == len(cells[first])
    units = named and first > 1 and not numbers[first - 2] and column_names.with_units(
        cells[first - 2], cells[first - 1])
    return places[first - named - bool(units)]


def of_the_rows(names, row):
    """The names of the columns that a row, a list of cells, has: in somebody's tables each row
    ends with a delimiter, or the line of names alone does."""
    if not names:
        return names
    if len(row) == len(names) + 1 and not row[-1]:
        return [*names, "-"]
    return names[:-1] if len(row) == len(names) - 1 and not names[-1].strip() else names


def has_only_times(cells):
    """Whether the cells of a row that are wanted are blank but for its time, one cell or two: of
    several sensors' rows in one table that of another one."""
    blanks = sum(not cell for cell in cells)
    return blanks >= 3 and blanks >= len(cells) - 2


def plain(text):
    """(text, {what it is now without: lines}): NULs, and the checksums of sentences."""
    left_out = {}
    if "\0" in text:
        left_out["NUL bytes"] = sum("\0" in one for one in text.split("\n"))
        text = text.replace("\0", "")
    if "$" in text:
        text, number = CHECKSUM.subn(r"\1", text)
        if number:
            left_out["a checksum at the end"] = number
    return text, left_out


def filled(lines):
    """The indices of lines that are neither blank nor comments."""
    return [place for place, line in enumerate(lines)
            if line.strip() and not line.startswith(COMMENT)]


def _numbers(line, separator):
    """The cells of a line that are numbers. Between two digits a comma that is no delimiter may be
    where decimals begin."""
    cells = cells_of(line if separator == "," else DECIMAL.sub(".", line), separator)
    return [cell for cell in cells if all_numbers([cell])]


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
