"""Somebody else's CSV: its delimiter, its header lines, its columns of numbers and of labels."""

import math
from typing import NamedTuple

import numpy as np

from ..errors import BadFile
from .capture_rows import quoted
from .unpack import Source, whole_lines

DELIMITERS = (",", ";", "\t", None)     # None: any run of blanks
LONGEST_LINE = 1 << 16
HEADER_SEARCH = 50                      # lines in which the column names must appear


class Block(NamedTuple):
    """Some rows of a table: their line numbers, float (n, columns), labels or None."""

    lines: list
    values: np.ndarray
    labels: list


class Table:
    """A CSV whose rows are read block by block, as often as they are asked for.

    names       column names, or None when the file has none
    width       values in every row
    """

    def __init__(self, path, source, names, width, separator, first):
        self.path = path
        self.names = names
        self.width = width
        self._source = source
        self._separator = separator
        self._first = first             # lines before the rows

    def index(self, column):
        """Position of a column given by name or, counted from 1, by number."""
        if self.names and column in self.names:
            return self.names.index(column)
        if column.isascii() and column.isdigit() and 1 <= int(column) <= self.width:
            return int(column) - 1
        raise BadFile("%s: there is no column %s, expected one of %s" % (
            self.path, quoted(column), " ".join(self.names or ["1 to %d" % self.width])))

    def blocks(self, columns, label=None):
        """Block after Block of columns of numbers, and of one with labels.

        BadFile names the line that has another width, or no number where one belongs.
        """
        places = [self.index(column) for column in columns]
        word = None if label is None else self.index(label)
        line, rows = 0, 0
        for line, text in _texts(self.path, self._source):
            texts = text.split("\n")
            if texts[-1].strip():
                raise BadFile.at(self.path, line + len(texts) - 1,
                                 "the last line has no newline, it may be cut short",
                                 "a complete line")
            skip = max(0, self._first - line + 1)
            texts, line = texts[skip:-1], line + skip
            block = texts and (self._fast(line, texts, places, word)
                               or self._slow(line, texts, columns, places, word))
            if block and len(block.lines):
                rows += len(block.lines)
                yield block
            line += len(texts)
        if not rows:
            raise BadFile.at(self.path, line, "no rows behind the column names",
                             "at least one row of numbers")

    def _fast(self, line, texts, places, word):
        """A Block of plain numbers in rows of the right width, or None for the slow way."""
        if word is not None or {self._width(text) for text in texts} != {self.width}:
            return None
        try:
            values = np.loadtxt(texts, delimiter=self._separator, usecols=places, ndmin=2,
                                comments=None)
        except ValueError:
            return None
        if len(values) != len(texts) or not np.isfinite(values).all():
            return None
        return Block(range(line, line + len(texts)), values, None)

    def _width(self, text):
        if self._separator is None:
            return len(text.split())
        return text.count(self._separator) + 1

    def _slow(self, line, texts, columns, places, word):
        """One row after the other; ends at the first fault."""
        lines, rows, labels = [], [], []
        for number, text in enumerate(texts, line):
            text = text.rstrip("\r")
            if not text.strip():
                continue
            cells = text.split(self._separator)
            if len(cells) != self.width:
                raise BadFile.at(self.path, number, "%d values" % len(cells), str(self.width))
            rows.append([self._number(number, column, cells[place])
                         for column, place in zip(columns, places)])
            lines.append(number)
            if word is not None:
                labels.append(cells[word].strip().strip('"'))
        values = np.array(rows, float).reshape(len(rows), len(places))
        return Block(lines, values, labels if word is not None else None)

    def _number(self, line, column, cell):
        try:
            value = float(cell if "_" not in cell else "")
        except ValueError:
            raise BadFile.at(self.path, line, "%s is %s" % (column, quoted(cell)),
                             "a number") from None
        if not math.isfinite(value):
            raise BadFile.at(self.path, line, "%s is %s" % (column, quoted(cell)),
                             "a finite number")
        return value


def _texts(path, source):
    """(number of the first line, text of whole lines), blocks of a file in UTF-8."""
    for line, block in whole_lines(path, source.pieces(), 1, LONGEST_LINE):
        try:
            yield line, block.decode("utf-8-sig" if line == 1 else "utf-8")
        except UnicodeDecodeError as error:
            raise BadFile.at(path, line + block.count(b"\n", 0, error.start),
                             "bytes that are not UTF-8 text", "a CSV file") from None


def read_table(path, delimiter="auto", skip=None, names=None, is_header=None):
    """A Table of a CSV, plain or gzipped.

    delimiter   a character, "blank", or "auto"
    skip        lines to leave out before the names (or the numbers); None: find them
    names       column names when the file has none, or other names than the file's
    is_header   function(list of names) -> bool, to find the line of names by itself
    """
    source = Source(path)
    lines = _first_lines(path, source, (skip or 0) + HEADER_SEARCH)
    head, separator = _find_head(path, lines, delimiter, skip, is_header)
    found = None if head is None else _cells(lines[head], separator)
    first = (skip or 0) if head is None else head + 1
    names = names or found
    row = next((text for text in lines[first:] if text.strip()), "")
    width = len(names) if names else len(row.rstrip("\r").split(separator))
    return Table(path, source, names, width, separator, first)


def _first_lines(path, source, wanted):
    """The first lines of a file, some more than are wanted where there are as many."""
    lines = [""]
    for _, text in _texts(path, source):
        more = text.split("\n")
        lines = [*lines[:-1], lines[-1] + more[0], *more[1:]]
        if len(lines) > wanted:
            break
    if not any(line.strip() for line in lines):
        raise BadFile.at(path, 1, "the file is empty", "a CSV file")
    return lines


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
