"""The history file: one SQLite table, one row for everything that happened to a board.

Several programs may write at the same time: SQLite's own lock makes them wait for each other.
The file knows whose it is (application_id) and the layout of its table (user_version).
"""

import contextlib
import json
import os
import sqlite3
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import BadFile
from ..narration import log
from ..value_kinds import Either, Fields, Json, MapOf, Nothing, Number, Octets, OneOf, Text

VARIABLE = "SIXFLIP_HISTORY"
OURS = 0x36464C50           # "6FLP"
VERSION = 1
WAIT_S = 10.0
KINDS = ("calibration", "verification", "check")
MADE, SEEN = "made", "seen"

TABLE = """CREATE TABLE happened (
    id INTEGER PRIMARY KEY, board TEXT NOT NULL, kind TEXT NOT NULL, verb TEXT NOT NULL,
    at REAL NOT NULL, time_is TEXT NOT NULL, chip TEXT, session INTEGER, sequence INTEGER,
    verdict TEXT NOT NULL, reason TEXT NOT NULL, temp_c REAL, record BLOB, answer TEXT NOT NULL)"""
COLUMNS = ("board", "kind", "verb", "at", "time_is", "chip", "session", "sequence", "verdict",
           "reason", "temp_c", "record", "answer")
WHOLE = Either(Number(0, 1 << 53, whole=True), Nothing())
ROW = Fields(       # what is written, and what is taken for a row when it is read
    "board kind verb at verdict reason time_is answer", board=Text(), kind=OneOf(*KINDS),
    verb=Text(), at=Number(-1e11, 1e11), verdict=Text(), reason=Text(), time_is=OneOf(MADE, SEEN),
    chip=Text(), session=WHOLE, sequence=WHOLE, temp_c=Number(-1e6, 1e6), record=Octets(),
    answer=MapOf(Text(), Json(8)))


@dataclass
class Happened:
    """One row. board: the board's unique id; verb: the command that saw it.

    at       unix seconds; time_is: "made" when it happened then, "seen" when it was fetched
             then from a board that has no clock
    verdict  of a calibration good, doubtful or refused; else holds or fails
    record   bytes of the correction record of a calibration, or None
    answer   dict with what else is known
    """

    board: str
    kind: str
    verb: str
    at: float
    verdict: str
    reason: str = ""
    time_is: str = MADE
    chip: str = None
    session: int = None
    sequence: int = None
    temp_c: float = None
    record: bytes = None
    answer: dict = field(default_factory=dict)


def path():
    """Where the history is kept; None when SIXFLIP_HISTORY is set to nothing: not at all."""
    given = os.environ.get(VARIABLE)
    if given is not None:
        return Path(given) if given else None
    import platformdirs
    return platformdirs.user_data_path("sixflip", appauthor=False) / "history.sqlite"


def add(file, rows):
    """Put Happened rows into the file, made when missing; all of them or none.

    A record that is there already is not put there twice; one that a `calibrate` told of
    completes its row, whose time stays. Raises BadFile, and ValueError for a row that could not
    be read again.
    """
    file = Path(file)
    for row in rows:
        ROW.take(vars(row))
    log.info("keeping %d rows in the history %s", len(rows), file)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadFile("%s: cannot be made: %s" % (file.parent, error.strerror)) from None
    with _opened(file, "rwc") as connection:
        connection.execute("BEGIN IMMEDIATE")
        if _is_new(connection):
            connection.execute(TABLE)
            connection.execute("PRAGMA application_id = %d" % OURS)
            connection.execute("PRAGMA user_version = %d" % VERSION)
        _check(file, connection)
        for row in rows:
            _put(connection, row)
        connection.execute("COMMIT")


def read(file, board=None):
    """All rows, or those of one board, in the order of their time; [] without a file.

    Raises BadFile for a file that is damaged, another program's, or of a later layout.
    """
    if not Path(file).exists():
        return []
    with _opened(file, "rw") as connection:
        if _is_new(connection):
            return []
        _check(file, connection)
        damage = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
        if damage != "ok":
            raise _damaged(file, damage)
        where = "" if board is None else " WHERE board = :board"
        rows = connection.execute("SELECT %s FROM happened%s ORDER BY at, sequence, id" % (
            ", ".join(COLUMNS), where), {"board": board}).fetchall()
    return [_row(file, dict(zip(COLUMNS, values))) for values in rows]


@contextlib.contextmanager
def _opened(file, mode):
    """A connection without automatic transactions; every fault of SQLite's is a BadFile."""
    connection = None
    try:
        connection = sqlite3.connect("%s?mode=%s" % (Path(file).resolve().as_uri(), mode),
                                     uri=True, timeout=WAIT_S, isolation_level=None)
        yield connection
    except sqlite3.OperationalError as error:
        raise BadFile("%s: cannot be used as history: %s" % (file, error)) from None
    except (sqlite3.Error, ValueError, TypeError, LookupError, ArithmeticError, MemoryError,
            RecursionError) as error:       # sqlite3 itself trips over some damages
        raise _damaged(file, error) from None
    finally:
        if connection is not None:
            connection.close()      # takes back what was not committed


def _damaged(file, what):
    return BadFile("%s: is no history or a damaged one (%s), expected a file sixflip wrote; "
                   "moved away, a new one is begun" % (file, str(what).replace("\n", " ")))


def _is_new(connection):
    return not connection.execute("PRAGMA application_id").fetchone()[0] and \
        not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]


def _check(file, connection):
    if connection.execute("PRAGMA application_id").fetchone()[0] != OURS:
        raise BadFile("%s: is the database of another program, expected a history of sixflip"
                      % file)
    version = connection.execute("PRAGMA user_version").fetchone()[0]
    if version != VERSION:
        raise BadFile("%s: is a history of layout %d, expected %d; is there a newer sixflip?"
                      % (file, version, VERSION))


def _put(connection, row):
    values = dict(vars(row), answer=json.dumps(row.answer))
    if row.kind == "calibration" and row.record is not None and row.verb != "refine":
        same = ("SELECT id, answer FROM happened WHERE kind = 'calibration' AND verb != 'refine'"
                " AND board = :board AND sequence = :sequence AND %s ORDER BY id DESC LIMIT 1")
        if connection.execute(same % "session = :session AND record IS NOT NULL",
                              values).fetchone():
            return
        told = connection.execute(same % "session IS NULL AND record IS NULL", values).fetchone()
        if told:
            kept = json.dumps({**json.loads(told[1]), **row.answer})
            connection.execute(
                "UPDATE happened SET record = :record, session = :session, chip = :chip,"
                " temp_c = :temp_c, verdict = :verdict, reason = :reason, answer = :kept"
                " WHERE id = :id", dict(values, id=told[0], kept=kept))
            return
    connection.execute("INSERT INTO happened (%s) VALUES (%s)" % (
        ", ".join(COLUMNS), ", ".join(":" + name for name in COLUMNS)), values)


def _row(file, values):
    """A Happened of what stands in the table; whoever changed it by hand hears of it."""
    try:
        values["answer"] = json.loads(values["answer"])
        return Happened(**ROW.take(values))
    except (ValueError, TypeError, RecursionError) as error:
        raise _damaged(file, error) from None
