"""The boards that are done, as a Parquet data set: a part for every few boards, a folder a batch.

A part is written whole or not at all; what stands in one is not done again as long as the files
of its board and the version of this program are the same. Of two rows of one board the one that
was written last counts.
"""
import os
import re
import secrets
import sys
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from .. import atomic_write, optional
from ..errors import BadFile
from . import analysis, effects

FOLDER = "boards"
TEXTS, LISTS_OF_TEXT = ("board", "batch", "version", "failure", "stamps", "content", "chip",
                        "verified", "gap"), ("paths", "verdicts", "reasons", "findings", "remarks")
NUMBERS = ("written", "accel_range_g", "gyro_range_dps", "cpu_s")
LISTS = ("at", *("%s_%s" % (what, sensor) for sensor in effects.FORMS
                 for what in ("precision", "score")))
TABLES = ("values", "covariances")  # a list for each session
KNOWN_BY = ("board", "batch", "version", "failure", "stamps", "content", "written")


def _arrow():
    return optional.need("sixflip fleet", "fleet", "pyarrow", "pyarrow.parquet")


def schema():
    """The pyarrow schema of a row."""
    pa, _ = _arrow()
    number = pa.list_(pa.float64())
    return pa.schema([*((name, pa.string()) for name in TEXTS),
                      *((name, pa.float64()) for name in NUMBERS),
                      *((name, pa.list_(pa.string())) for name in LISTS_OF_TEXT),
                      *((name, number) for name in LISTS),
                      *((name, pa.list_(number)) for name in TABLES)])


@dataclass(frozen=True, slots=True)
class Done:
    """What is known of a board that was done: path and row of its part; stamps, content and
    failure as in the row."""

    part: str
    stamps: str
    content: str
    failure: str
    written: float


class DataSet:
    """The data set below a folder; made with the first part that is written."""

    def __init__(self, folder):
        self.folder = Path(folder) / FOLDER

    def parts(self):
        """Paths of the parts, in no order that matters."""
        return sorted(str(path) for path in self.folder.glob("batch=*/*.parquet"))

    def write(self, rows):
        """Write rows, a part for each batch among them. BadFile where the disk is full."""
        pa, pq = _arrow()
        for batch in dict.fromkeys(one["batch"] for one in rows):
            own = [one for one in rows if one["batch"] == batch]
            folder = self.folder / ("batch=" + quote(batch, safe="") if batch else "batch=none")
            name = folder / ("%s-%s.parquet" % (_word(own[0]["board"]), secrets.token_hex(6)))
            try:
                folder.mkdir(parents=True, exist_ok=True)
                sink = pa.BufferOutputStream()
                pq.write_table(pa.Table.from_pylist(own, schema=schema()), sink,
                               compression="zstd")
                atomic_write.write_bytes(str(name), sink.getvalue().to_pybytes())
            except OSError as error:
                raise BadFile("%s: cannot be written: %s; what was done before is kept, the same "
                              "command goes on from there" % (name, error.strerror)) from None
            except BadFile as error:
                raise BadFile("%s; what was done before is kept, the same command goes on from "
                              "there" % error) from None

    def done(self, version=None):
        """({(batch, board): Done} of the boards in it by this version, [sentence] on damaged
        parts)."""
        done, damaged = {}, []
        for part in self.parts():
            try:
                rows = self._read(part, KNOWN_BY)
            except BadFile as error:
                damaged.append(str(error))
                continue
            for row in rows:
                if version is not None and row["version"] != version:
                    continue
                key = sys.intern(row["batch"]), row["board"]
                if key not in done or done[key].written < row["written"]:
                    done[key] = Done(part, row["stamps"], row["content"], row["failure"],
                                     row["written"])
        return done, damaged

    def rows(self, wanted=None, columns=None):
        """Every row that counts, a part in memory at a time; wanted: {(batch, board): Done} as
        done() gives them, None: all of any version."""
        wanted = self.done()[0] if wanted is None else wanted
        parts = {}
        for key, row in wanted.items():
            parts.setdefault(row.part, {})[key] = row.written
        for part in sorted(parts):
            for row in self._read(part, columns):
                if parts[part].get((row["batch"], row["board"])) == row["written"]:
                    yield row

    def _read(self, part, columns=None):
        pa, pq = _arrow()
        try:
            table = pq.ParquetFile(part).read(columns=None if columns is None else list(columns))
            missing = set(columns or schema().names) - set(table.column_names)
            if missing:
                raise BadFile("%s: no column %s, expected a part that sixflip fleet wrote: delete "
                              "it, its boards are done again" % (part, sorted(missing)[0]))
            return table.cast(pa.schema([schema().field(n) for n in table.column_names])
                              ).to_pylist() if columns else table.to_pylist()
        except (OSError, ValueError, KeyError, TypeError, pa.ArrowException) as error:
            raise BadFile("%s: is damaged (%s), expected a part that sixflip fleet wrote: delete "
                          "it, its boards are done again" % (
                              part, str(error)[:80].replace("\n", " "))) from None


def _word(board):
    """A board's id as part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_-]", "_", board)[:40] or "board"


def to_do(boards, known):
    """The boards that are not done, or whose files changed since; boards: [sources.Board],
    known: {(batch, board): Done} of this version."""
    left = []
    for board in boards:
        before = known.get((board.batch, board.board))
        if before is None or not _same(board, before):
            left.append(board)
    return left


def _same(board, before):
    try:
        return bool(before.stamps) and (
            analysis.stamps(board) == before.stamps
            or analysis.content(board) == before.content)
    except BadFile:
        return False


def in_folder(path):
    """Whether a folder is one that `write` made a data set in."""
    return os.path.isdir(os.path.join(path, FOLDER)) and bool(DataSet(path).parts())
