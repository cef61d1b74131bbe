"""Somebody else's CSV: its delimiter, its header lines, its columns of numbers and of labels."""

import math

from .. import atomic_write
from ..errors import BadFile
from .capture_rows import quoted
from .gunzip import MAGIC as GZIP_MAGIC
from .gunzip import gunzip

DELIMITERS = (",", ";", "\t", None)     # None: any run of blanks
LONGEST_LINE = 1 << 16
HEADER_SEARCH = 50                      # lines in which the column names must appear


class Table:
    """The text of a CSV cut into rows; line numbers are kept for the errors.

    names       column names, or None when the file has none
    rows        list of lists of strings
    lines       line number of every row
    """

    def __init__(self, path, names, rows, lines):
        self.path = path
        self.names = names
        self.rows = rows
        self.lines = lines

    def index(self, column):
        """Position of a column given by name or, counted from 1, by number."""
        if self.names and column in self.names:
            return self.names.index(column)
        width = len(self.rows[0])
        if column.isascii() and column.isdigit() and 1 <= int(column) <= width:
            return int(column) - 1
        raise BadFile("%s: there is no column %s, expected one of %s" % (
            self.path, quoted(column), " ".join(self.names or ["1 to %d" % width])))

    def numbers(self, column):
        """The column as a list of floats; BadFile names the line that holds none."""
        place = self.index(column)
        out = []
        for line, row in zip(self.lines, self.rows):
            try:
                value = float(row[place] if "_" not in row[place] else "")
            except ValueError:
                raise BadFile.at(self.path, line, "%s is %s" % (column, quoted(row[place])),
                                 "a number")
            if not math.isfinite(value):
                raise BadFile.at(self.path, line, "%s is %s" % (column, quoted(row[place])),
                                 "a finite number")
            out.append(value)
        return out

    def words(self, column):
        """The column as a list of strings."""
        place = self.index(column)
        return [row[place].strip().strip('"') for row in self.rows]


def read_table(path, delimiter="auto", skip=None, names=None, is_header=None):
    """Read a CSV, plain or gzipped, into a Table.

    delimiter   a character, "blank", or "auto"
    skip        lines to leave out before the names (or the numbers); None: find them
    names       column names when the file has none, or other names than the file's
    is_header   function(list of names) -> bool, to find the line of names by itself
    """
    data = atomic_write.read_bytes(path)
    if data.startswith(GZIP_MAGIC):
        data = gunzip(path, data)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadFile.at(path, data.count(b"\n", 0, error.start) + 1,
                         "bytes that are not UTF-8 text", "a CSV file")
    lines = text.split("\n")
    if lines[-1].strip():
        raise BadFile.at(path, len(lines), "the last line has no newline, it may be cut short",
                         "a complete line")
    longest = max(range(len(lines)), key=lambda number: len(lines[number]))
    if len(lines[longest]) > LONGEST_LINE:
        raise BadFile.at(path, longest + 1, "a line of %d characters" % len(lines[longest]),
                         "%d at most" % LONGEST_LINE)
    if not text.strip():
        raise BadFile.at(path, 1, "the file is empty", "a CSV file")
    head, separator = _find_head(path, lines, delimiter, skip, is_header)
    found = None if head is None else _cells(lines[head], separator)
    first = (skip or 0) if head is None else head + 1
    return _rows(path, lines, first, separator, names or found)


def _find_head(path, lines, delimiter, skip, is_header):
    """Index of the line of column names (None: there is none) and the delimiter."""
    choices = DELIMITERS if delimiter == "auto" else \
        (None if delimiter == "blank" else delimiter,)
    start = skip or 0
    if start >= len(lines):
        raise BadFile.at(path, len(lines), "only %d lines" % len(lines),
                         "more than the %d to skip" % start)
    search = range(start, min(len(lines), start + HEADER_SEARCH)) if skip is None else (start,)
    for number in search:
        for separator in choices:
            if is_header and is_header(_cells(lines[number], separator)):
                return number, separator
    separator = max(choices, key=lambda one: (len(_cells(lines[start], one)), one is not None))
    return (None if _all_numbers(_cells(lines[start], separator)) else start), separator


def _cells(line, separator):
    return [cell.strip().strip('"') for cell in line.strip().split(separator)]


def _all_numbers(cells):
    try:
        return bool([float(cell) for cell in cells])
    except ValueError:
        return False


def _rows(path, lines, first, separator, names):
    """The rows behind the names; every row as long as the first one says."""
    rows, numbers = [], []
    width = len(names) if names else None
    for number in range(first, len(lines)):
        line = lines[number].rstrip("\r")
        if not line.strip():
            continue
        row = line.split(separator)
        width = width or len(row)
        if len(row) != width:
            raise BadFile.at(path, number + 1, "%d values" % len(row), str(width))
        rows.append(row)
        numbers.append(number + 1)
    if not rows:
        raise BadFile.at(path, len(lines), "no rows behind the column names",
                         "at least one row of numbers")
    return Table(path, names, rows, numbers)
