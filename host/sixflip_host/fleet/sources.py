"""Which boards there are: from a folder of captures, a manifest, or a history.

In a folder, a folder that holds captures is a board of that name, and what lies above it, from
the folder given on, is its batch. Captures beside each other right in the folder given are boards
of their own, named by themselves.
"""
import os
import sqlite3
from dataclasses import dataclass, field

from .. import file_kinds
from ..errors import BadFile, UsageError
from ..history import store
from . import manifest
from .summary_file import SUFFIX

ENDINGS = (".csv", ".csv.gz", ".bin", ".parquet", ".bag", ".db3", ".mcap", ".ulg")
SQLITE = b"SQLite format 3\0"
RECORDS = ("record_a.bin", "record_b.bin")
MOST_FILES = 1_000_000


@dataclass(frozen=True)
class Board:
    """board: its id; batch: "" where nobody said; captures: paths, in the order of the sessions;
    summaries: paths of summaries whose captures are not there; folder: where its records lie, or
    None; calibrations: Happened rows of a history."""

    board: str
    batch: str = ""
    captures: tuple = ()
    summaries: tuple = ()
    folder: str = None
    calibrations: tuple = ()


@dataclass(frozen=True)
class Sources:
    """boards in the order of their names; failures: [(what, sentence)] of what was left out."""

    boards: tuple
    failures: tuple = field(default_factory=tuple)


def find_boards(path):
    """Sources of what stands on the command line; BadFile or UsageError where it is nothing."""
    path = os.fspath(path)
    if os.path.isdir(path):
        listed = _of_folder(path)
    elif not os.path.exists(path):
        raise BadFile("%s: is not there, expected a folder of captures, a manifest or a history"
                      % path)
    elif _begins(path).startswith(SQLITE):
        listed = _of_history(path)
    elif file_kinds.kind_of(path) in (file_kinds.CAPTURE, file_kinds.SIMULATED,
                                      file_kinds.BOARD_CAPTURE):
        raise UsageError("%s: is one capture, expected a folder of them, a manifest or a history; "
                         "sixflip diagnose looks at one board" % path)
    else:
        listed = _of_manifest(path)
    if not listed.boards and not listed.failures:
        raise BadFile("%s: no board in it, expected captures (%s) in a folder for each board"
                      % (path, " ".join(ENDINGS)))
    return listed


def _begins(path):
    try:
        with open(path, "rb") as file:
            return file.read(16)
    except OSError as error:
        raise BadFile("%s: cannot be read: %s" % (path, error.strerror)) from None


def _of_folder(top):
    boards, failures, files = [], [], 0
    top = os.path.normpath(top)

    def unreadable(error):
        failures.append((error.filename, "cannot be read: %s" % error.strerror))
    for folder, below, names in os.walk(top, onerror=unreadable):
        below[:] = sorted(name for name in below if not name.startswith("."))
        files += len(names)
        if files > MOST_FILES:
            raise BadFile("%s: more than %d files, expected fewer: use a manifest" % (
                top, MOST_FILES))
        captures, alone = _captures(folder, names)
        if folder == top:
            boards += [Board(_stem(p), "", (p,)) for p in captures]
            boards += [Board(_stem(p[:-len(SUFFIX)]), "", (), (p,)) for p in alone]
        elif captures or alone:
            parts = os.path.relpath(folder, top).split(os.sep)
            boards.append(Board(parts[-1], "/".join(parts[:-1]), tuple(captures), tuple(alone),
                                folder))
        elif not below and names and any(name in RECORDS for name in names):
            failures.append((os.path.basename(folder), "no session in %s, expected a capture "
                             "beside its record" % folder))
        elif not below and not names:
            failures.append((os.path.basename(folder), "no session in %s, the folder is empty"
                             % folder))
    return _distinct(boards, failures)


def _captures(folder, names):
    """(paths of captures, paths of summaries without one) among the files of a folder."""
    there = sorted(name for name in names if not name.startswith("."))
    captures = [name for name in there if name.endswith(ENDINGS) and name not in RECORDS]
    alone = [name for name in there if name.endswith(SUFFIX)
             and name[:-len(SUFFIX)] not in captures]
    # `pull` leaves capture.bin and the same as capture.csv; one of them is the session.
    double = {name for name in captures if name.endswith(".bin") and any(
        name[:-4] + ending in captures for ending in (".csv", ".csv.gz"))}
    return ([os.path.join(folder, name) for name in captures if name not in double],
            [os.path.join(folder, name) for name in alone])


def _stem(path):
    name = os.path.basename(path)
    for ending in sorted(ENDINGS, key=len, reverse=True):
        if name.endswith(ending):
            return name[:-len(ending)]
    return name


def _distinct(boards, failures):
    """Sources with every id once; the others are said."""
    kept, failed = {}, list(failures)
    for board in boards:
        first = kept.setdefault(board.board, board)
        if first is not board:
            failed.append((board.board, "the id stands twice, in %s and in %s: only the first is "
                           "taken, expected one place for a board" % (
                               _place(first), _place(board))))
    return Sources(tuple(sorted(kept.values(), key=lambda b: (b.batch, b.board))), tuple(failed))


def _place(board):
    return board.folder or (board.captures or board.summaries or ("batch %r" % board.batch,))[0]


def _of_manifest(path):
    lines, wrong = manifest.read(path)
    lines_of = {}
    for line in lines:
        lines_of.setdefault(line.board, []).append(line)
    boards, failures = [], list(wrong)
    for board, its in lines_of.items():
        batches = list(dict.fromkeys(line.batch for line in its))
        if len(batches) > 1:
            failures.append((board, "is in the batches %s: the first is taken, expected one"
                             % " and ".join(map(repr, batches))))
        its = [line for line in its if line.batch == batches[0]]
        boards.append(Board(board, batches[0], tuple(line.capture for line in its)))
    if not boards and not failures:
        raise BadFile("%s: no board in it, expected a line for each capture" % path)
    return Sources(tuple(sorted(boards, key=lambda b: (b.batch, b.board))), tuple(failures))


def _of_history(path):
    try:
        rows = store.read(path)
    except sqlite3.Error as error:
        raise BadFile("%s: cannot be used as history: %s" % (path, error)) from None
    rows_of = {}
    for row in rows:
        if row.kind == "calibration" and row.record is not None and row.verb != "refine":
            rows_of.setdefault(row.board, []).append(row)
    without = sorted({row.board for row in rows} - set(rows_of))
    failures = [(board, "no calibration with its record in the history: sixflip pull fetches it")
                for board in without]
    return Sources(tuple(Board(board, "", calibrations=tuple(its))
                         for board, its in sorted(rows_of.items())), tuple(failures))
