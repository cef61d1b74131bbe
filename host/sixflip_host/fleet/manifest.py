"""A manifest: a CSV of boards and their captures, a line each.

    board,capture,batch
    e6614c311b4c5a2f,captures/a-warming.csv,lot 7
    e6614c311b4c5a2f,captures/a-cooling.csv,lot 7

`board` and `capture` have to be there, `batch` may; other columns are left alone. Paths are taken
from where the manifest lies. A line that is wrong is said and left out, the others stand.
"""
import csv
import io
import os
from dataclasses import dataclass

from .. import atomic_write
from ..errors import BadFile
from ..terminal import plain

COLUMNS = ("board", "capture", "batch")
LONGEST = 200  # characters of an id or of a batch's name
MOST_LINES = 1_000_000


@dataclass(frozen=True)
class Line:
    """board, batch ("" none), capture: path; number: of the line, from 1."""

    board: str
    batch: str
    capture: str
    number: int


def read(path):
    """([Line], [(what, sentence)] on lines left out) of a manifest; BadFile where it is none."""
    return parse(path, atomic_write.read_bytes(path))


def parse(path, data):
    """The same of its bytes; path is for the sentences, and for where captures lie."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadFile("%s: byte %d is no UTF-8, expected a CSV with the columns board and capture"
                      % (path, error.start)) from None
    if "\0" in text:
        raise BadFile("%s: holds a NUL, expected a CSV with the columns board and capture" % path)
    rows = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True)
    try:
        head = [name.strip().lower() for name in next(rows, [])]
    except csv.Error as error:
        raise BadFile.at(path, 1, str(error), "board,capture,batch") from None
    for name in COLUMNS[:2]:
        if head.count(name) != 1:
            raise BadFile.at(path, 1, "%s column %r" % (
                "more than one" if name in head else "no", name), "board,capture,batch")
    return _lines(path, rows, head)


def _lines(path, rows, head):
    place = {name: head.index(name) for name in COLUMNS if name in head}
    kept, wrong, seen = [], [], {}
    folder = os.path.dirname(os.path.abspath(path))
    while True:
        try:
            row = next(rows, None)
        except csv.Error as error:
            wrong.append((_where(path, rows.line_num), "%s" % error))
            continue
        if row is None:
            break
        number = rows.line_num
        if len(kept) + len(wrong) >= MOST_LINES:
            raise BadFile("%s: more than %d lines, expected fewer: split it" % (path, MOST_LINES))
        if not any(cell.strip() for cell in row):
            continue
        cells = {name: row[k].strip() if k < len(row) else "" for name, k in place.items()}
        why = _fault(cells, len(row), len(head))
        if not why:
            line = Line(cells["board"], cells.get("batch", ""),
                        os.path.join(folder, cells["capture"]), number)
            before = seen.setdefault(os.path.normpath(line.capture), line)
            if before is not line:
                why = "the capture stands on line %d already%s" % (
                    before.number, "" if before.board == line.board else
                    ", for board %s" % plain(before.board))
        if why:
            wrong.append((_where(path, number), why))
        else:
            kept.append(line)
    return kept, wrong


def _where(path, number):
    return "%s line %d" % (os.path.basename(path), number)


def _fault(cells, width, wanted):
    """What is wrong with a line, or ""."""
    if width > wanted:
        return "%d cells, expected %d" % (width, wanted)
    for name in COLUMNS[:2]:
        if not cells[name]:
            return "no %s, expected one" % name
    for name in ("board", "batch"):
        if len(cells.get(name, "")) > LONGEST:
            return "%s of %d characters, expected at most %d" % (name, len(cells[name]), LONGEST)
        if any(ord(c) < 32 or ord(c) == 127 for c in cells.get(name, "")):
            return "%s holds a control character, expected a name" % name
    return ""
