"""Arrays of a row a board that are larger than memory: in a file that has no name and is gone
with its last reader. What is asked for is read, and nothing else kept.
"""
import math
import os
import tempfile
import weakref

import numpy as np

from ..errors import BadFile


class Stored:
    """Float64 (boards, *shape), nan where nothing was put. Rows are asked for like those of an
    array, by a slice or by their numbers."""

    def __init__(self, boards, shape):
        self.shape = (boards, *shape)
        self._bytes = 8 * math.prod(shape)
        with _one_sentence():
            self._file, name = tempfile.mkstemp(prefix="sixflip-fleet-")
            os.unlink(name)
            weakref.finalize(self, os.close, self._file)
            nothing = np.full((1024, *shape), np.nan).tobytes()
            for first in range(0, boards, 1024):
                _write(self._file, nothing[:self._bytes * min(1024, boards - first)],
                       self._bytes * first)

    def __len__(self):
        return self.shape[0]

    def put(self, number, value):
        """Write the row of a board."""
        with _one_sentence():
            _write(self._file, np.asarray(value, float).tobytes(), self._bytes * number)

    def __getitem__(self, wanted):
        index = np.arange(len(self))[wanted]
        # one read for all that lie beside each other
        runs = np.split(index, np.flatnonzero(np.diff(index) != 1) + 1)
        data = b"".join(os.pread(self._file, self._bytes * len(run), self._bytes * int(run[0]))
                        for run in runs if len(run))
        return np.frombuffer(data).reshape(len(index), *self.shape[1:])


class Picked:
    """Some of the rows of an array or a Stored, asked for in the same way; index: their
    numbers."""

    def __init__(self, rows, index):
        self.rows, self.index = rows, np.asarray(index)

    def __len__(self):
        return len(self.index)

    def __getitem__(self, wanted):
        return self.rows[self.index[wanted]]


def _write(file, data, place):
    while data:
        done = os.pwrite(file, data, place)
        data, place = data[done:], place + done


class _one_sentence:
    """BadFile instead of an OSError."""

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if isinstance(error, OSError):
            raise BadFile("%s: cannot be written: %s; the population needs about 4 kB a board "
                          "there, TMPDIR names another folder" % (
                              tempfile.gettempdir(), error.strerror)) from None
