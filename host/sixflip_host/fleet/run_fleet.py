"""A whole run: boards found, those that are not done given to the cluster, the rest taken over."""
import os
from dataclasses import dataclass

from .. import progress
from ..errors import BadFile
from . import analysis, cluster, dataset, members, sources

ROWS_OF_A_PART = 64  # boards that are kept in memory before they are written
SECONDS_OF_A_PART = 20.0  # and no longer, so that little is lost with this program


@dataclass(frozen=True)
class Run:
    """data: dataset.DataSet; wanted: {(batch, board): Done}; failures [(what, sentence)]; remarks
    [sentence]; fresh: boards that were done now."""

    data: dataset.DataSet
    wanted: dict
    failures: list
    remarks: list
    fresh: int

    def rows(self, columns=members.COLUMNS):
        """Rows of the boards wanted."""
        return Rows(self.data, self.wanted, columns)


@dataclass(frozen=True)
class Rows:
    """The rows of the boards wanted, as often as they are asked for, a part in memory at a
    time."""

    data: dataset.DataSet
    wanted: dict
    columns: tuple

    def __iter__(self):
        return self.data.rows(self.wanted, self.columns)


class _Writer:
    """Takes rows and writes a part now and then."""

    def __init__(self, data, number):
        import time
        self.data, self.rows, self.clock = data, [], time.monotonic
        self.last, self.done, self.number = self.clock(), 0, number

    def take(self, rows):
        self.rows += rows
        self.done += len(rows)
        progress.doing("%d of %d boards" % (self.done, self.number))
        late = self.clock() - self.last > SECONDS_OF_A_PART
        if len(self.rows) >= ROWS_OF_A_PART or late:
            self.flush()

    def flush(self):
        rows, self.rows, self.last = self.rows, [], self.clock()
        if rows:
            self.data.write(rows)


def boards(path, output, target, options=None, work=cluster.rows_of):
    """Run of what stands on the command line; the data set below `output` grows by it."""
    options = options or analysis.Options()
    if os.path.isdir(path) and dataset.in_folder(path):
        return _taken_over(path)
    listed = sources.find_boards(path)
    data = dataset.DataSet(output)
    known, damaged = data.done(options.version)
    left = dataset.to_do(listed.boards, known)
    if left:
        progress.doing("the cluster")
        writer = _Writer(data, len(left))
        with cluster.connected(target) as client:
            try:
                cluster.run(client, left, writer.take, target,
                            cluster.Task(work, analysis.failed, options))
            finally:
                writer.flush()
        known, damaged = data.done(options.version)
    names = {(one.batch, one.board) for one in listed.boards}
    wanted = {key: one for key, one in known.items() if key in names}
    failures = [*listed.failures, *((board, one.failure) for (_, board), one in wanted.items()
                                    if one.failure)]
    return Run(data, wanted, failures, [*damaged, *_kinds(data, wanted)], len(left))


def _taken_over(path):
    """Run of the data set that an earlier run left in a folder."""
    data = dataset.DataSet(path)
    known, damaged = data.done(analysis.Options(diagnose=True).version)
    plain, _ = data.done(analysis.VERSION)
    known = {**plain, **known}
    if not known:
        raise BadFile("%s: its boards were done by another version of sixflip, expected %s: run "
                      "sixflip fleet on their captures again" % (path, analysis.VERSION))
    return Run(data, known, [(board, one.failure) for (_, board), one in known.items()
                             if one.failure], [*damaged, *_kinds(data, known)], 0)


def _kinds(data, wanted):
    """Sentences on boards of more than one chip or range, and on captures that repeat."""
    kinds, contents = {}, {}
    for row in data.rows(wanted, ("board", "batch", "written", "chip", "accel_range_g",
                                  "gyro_range_dps", "failure", "content")):
        if row["failure"]:
            continue
        kinds.setdefault((row["chip"], str(row["accel_range_g"]), str(row["gyro_range_dps"])),
                         []).append(row["board"])
        contents.setdefault(row["content"], []).append(row["board"])
    said = ["%d kinds of boards, each judged by itself: %s" % (len(kinds), "; ".join(
        "%d of %s ±%s g ±%s °/s" % (len(its), *kind) for kind, its in sorted(kinds.items())))] \
        if len(kinds) > 1 else []
    return said + ["the boards %s hold the same captures: one of them is a copy" % " and ".join(
        sorted(its)) for its in contents.values() if len(its) > 1]
