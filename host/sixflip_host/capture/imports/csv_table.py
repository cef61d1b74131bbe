"""Somebody else's CSV as a table: its columns of numbers and of labels, block by block.

What loggers and serial monitors leave in a file and means nothing is passed over and counted:
comments, the header once more, NUL bytes, a last line without newline. What may mean something
is refused with its line.
"""

import math
import re
from typing import NamedTuple

import numpy as np

from ...errors import BadFile
from ..capture_rows import quoted
from ..unpack import Source
from . import column_names, csv_text, serial_monitor, wall_clock
from .csv_text import COMMENT, all_numbers, cells_of

DECIMAL_COMMA = re.compile(r"(^|[;\t ])[+-]?\d+,\d+([eE][+-]?\d+)?($|[;\t ])")


class Block(NamedTuple):
    """Some rows of a table: their line numbers, float (n, columns), labels or None."""

    lines: list
    values: np.ndarray
    labels: list


class Table:
    """A CSV whose rows are read block by block, as often as they are asked for.

    names       column names, or None when the file has none
    width       values in every row
    preamble    lines before the names, or before the rows of a file that has none
    passed_over {what: lines} that means nothing, after blocks() has come to its end
    said        {sentence: True} on what nobody said of the text itself, after blocks()
    units       {sensor: unit} that the file's format says, whatever the names
    """

    units = {}
    names_in_file = False

    def __init__(self, path, source, names, width, separator, first, preamble=(), comma=False,
                 dress=None):
        self.path = path
        self.names = names
        self.width = width
        self.preamble = preamble
        self.passed_over, self.said = {}, {}
        self._source = source
        self._separator = separator
        self._first = first             # lines before the rows
        self._comma = comma             # decimals are behind a comma
        self._dress = dress             # serial_monitor.Dress, or None

    def index(self, column):
        """Position of a column given by name or, counted from 1, by number."""
        if self.names and column in self.names:
            return self.names.index(column)
        if column.isascii() and column.isdigit() and 1 <= int(column) <= self.width:
            return int(column) - 1
        raise BadFile("%s: there is no column %s, expected one of %s" % (
            self.path, quoted(column), " ".join(self.names or ["1 to %d" % self.width])))

    def first_cell(self, column):
        """What the first row has in a column; "0" where there is no row at all."""
        place = self.index(column)
        for _, text in self._texts():
            for line in text.split("\n")[self._first:]:
                if line.strip() and not line.startswith(COMMENT):
                    cells = cells_of(self._decimal(line), self._separator)
                    return cells[place] if place < len(cells) else ""
        return "0"

    def holds_numbers(self, column):
        """True where the first row has a number in a column."""
        return all_numbers([self.first_cell(column)])

    def holds_stamps(self, column):
        """True where the first row has a date or a time of day in a column, to be read as
        seconds."""
        return wall_clock.is_stamp(self.first_cell(column))

    def blocks(self, columns, label=None):
        """Block after Block of columns of numbers, and of one with labels.

        BadFile names the line that has another width, or no number where one belongs.
        """
        places = [self.index(column) for column in columns]
        word = None if label is None else self.index(label)
        self.passed_over = {}
        before = [] if self.names_in_file else csv_text.filled(self.preamble)
        if before:
            self._pass_over("lines before the first row", len(before))
        line, rows = 0, 0
        for line, text in self._texts():
            texts = text.split("\n")
            open_end = texts[-1] if texts[-1].strip() else None
            skip = max(0, self._first - line + 1)
            texts, line = texts[skip:-1], line + skip
            block = texts and (self._fast(line, texts, places, word)
                               or self._slow(line, texts, columns, places, word))
            if block and len(block.lines):
                rows += len(block.lines)
                yield block
            line += len(texts)
            if open_end is not None and line > self._first:
                block = self._last(line, open_end, columns, places, word)
                if block:
                    rows += 1
                    yield block
        if not rows:
            raise BadFile.at(self.path, line, "no rows behind the column names",
                             "at least one row of numbers")

    def _texts(self):
        """(number of the first line, text) of the file, without NULs, with decimal points."""
        for line, text in csv_text.texts(self.path, self._source, self.said,
                                           self._first):
            text, left_out = csv_text.plain(text)
            for why, number in left_out.items():
                self._pass_over(why, number)
            if self._dress is not None:
                text = self._dress.plain(text)
                self.said.update(dict.fromkeys(self._dress.said, True))
            yield line, self._decimal(text)

    def _decimal(self, text):
        return text.replace(",", ".") if self._comma else text

    def _pass_over(self, why, lines=1):
        self.passed_over[why] = self.passed_over.get(why, 0) + lines

    def _fast(self, line, texts, places, word):
        """A Block of plain numbers in rows of the right width, or None for the slow way."""
        if word is not None or not self._right_width(texts):
            return None
        try:
            values = np.loadtxt(texts, delimiter=self._separator, usecols=places, ndmin=2,
                                comments=None)
        except ValueError:
            return None
        if len(values) != len(texts) or not np.isfinite(values).all():
            return None
        return Block(range(line, line + len(texts)), values, None)

    def _right_width(self, texts):
        """True where every line has as many cells as it should, and no quotes."""
        if self._separator is None:
            return {len(text.split()) for text in texts} == {self.width}
        whole = "\n".join(texts)
        if '"' in whole or not whole.isascii():
            return False
        raw = np.frombuffer(whole.encode() + b"\n", np.uint8)
        ends = raw[(raw == ord(self._separator)) | (raw == 10)]
        if len(ends) != self.width * len(texts):
            return False
        return bool((ends.reshape(-1, self.width)[:, -1] == 10).all())

    def _slow(self, line, texts, columns, places, word):
        """One row after the other; ends at the first fault."""
        lines, rows, labels = [], [], []
        for number, text in enumerate(texts, line):
            if self._means_nothing(text):
                continue
            cells = cells_of(text, self._separator)
            if len(cells) != self.width:
                raise BadFile.at(self.path, number, "%d values" % len(cells), str(self.width))
            if csv_text.has_only_times([cells[place] for place in places]):
                self._pass_over("rows without a reading")
                continue
            rows.append([self._number(number, column, cells[place])
                         for column, place in zip(columns, places)])
            lines.append(number)
            if word is not None:
                labels.append(cells[word].strip())
        values = np.array(rows, float).reshape(len(rows), len(places))
        return Block(lines, values, labels if word is not None else None)

    def _means_nothing(self, text):
        """True for a blank line, a comment, the column names once more."""
        if not text.strip():
            return True
        names = self.names and cells_of(text, self._separator) == self.names
        why = "comments" if text.startswith(COMMENT) else names and "the column names once more"
        if why:
            self._pass_over(why)
        return bool(why)

    def _last(self, line, text, columns, places, word):
        """The Block of a last line without newline: None where it is no whole row."""
        if self._means_nothing(text):
            return None
        if len(cells_of(text, self._separator)) != self.width:
            self._pass_over("a last row that is cut short")
            return None
        self._pass_over("a missing newline at the end")
        return self._slow(line, [text], columns, places, word)

    def _number(self, line, column, cell):
        try:
            value = wall_clock.seconds(cell) if ":" in cell else float(
                cell if "_" not in cell else "")
        except ValueError:
            if wall_clock.is_ambiguous(cell):
                raise BadFile.at(self.path, line, "%s is %s, whose day and month cannot be told"
                                 % (column, quoted(cell)), wall_clock.EXPECTED) from None
            seen = quoted(cell) if cell.strip() else "missing"
            raise BadFile.at(self.path, line, "%s is %s" % (column, seen),
                             "a number" + csv_text.IN_TURN * (not cell.strip())) from None
        if not math.isfinite(value):
            raise BadFile.at(self.path, line, "%s is %s" % (column, quoted(cell)),
                             "a finite number")
        return value


def read_table(path, delimiter="auto", skip=None, names=None, is_header=None):
    """A Table of a CSV, plain or gzipped.

    delimiter   a character, "blank", or "auto"
    skip        lines to leave out before the names (or the numbers); None: find them
    names       column names when the file has none, or other names than the file's
    is_header   function(list of names) -> bool, to find the line of names by itself
    """
    source = Source(path)
    lines = csv_text.first_lines(path, source, (skip or 0) + csv_text.SEARCH)
    dress = serial_monitor.told(lines[skip or 0:])
    if dress is not None:
        lines = dress.plain("\n".join(lines)).split("\n")
        names = dress.columns(names)
        delimiter = dress.separator if dress.separator != " " else "blank"
        if dress.names:
            skip = (skip or 0) + dress.first
    head, first, separator = csv_text.find_header(path, lines, delimiter, skip, is_header)
    titles = None if head is None else cells_of(lines[head].lstrip("#"), separator)
    told = head is not None and first < len(lines) and column_names.with_units(
        titles, cells_of(lines[first], separator))
    if told:
        titles, first = told, first + 1
    row = next((lines[first + place] for place in csv_text.filled(lines[first:])), "")
    cells = cells_of(row, separator)
    names = csv_text.of_the_rows(names or titles, cells)
    width = len(names or cells)
    comma = separator != "," and bool(DECIMAL_COMMA.search(row))
    table = Table(path, source, names, width, separator, first,
                  lines[:first if head is None else head], comma, dress)
    table.names_in_file = head is not None
    return table
