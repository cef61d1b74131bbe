"""An array that grows by blocks of rows without ever being there twice."""

import numpy as np

ROOM = 1.06     # as much again is asked of the system each time, and not more: it is resident


class Growing:
    """add() blocks, then array(): dtype, (n, width), or (n,) where width is None."""

    def __init__(self, dtype, width=None):
        self._shape = () if width is None else (width,)
        self._room = np.empty((0, *self._shape), dtype)
        self._rows = 0

    def __len__(self):
        return self._rows

    def add(self, rows):
        """Rows behind those that are there."""
        end = self._rows + len(rows)
        if end > len(self._room):       # realloc moves pages, it copies none
            self._room.resize((int(end * ROOM), *self._shape), refcheck=False)
        self._room[self._rows:end] = rows
        self._rows = end

    def array(self):
        """All rows; nothing is to be added any more."""
        self._room.resize((self._rows, *self._shape), refcheck=False)
        return self._room
