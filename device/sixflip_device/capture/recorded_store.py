"""A session whose capture goes to the host as well, block by block as it is taken: all of it,
whatever the flash has room for. Loaded only when the host asks for it.
"""

from sixflip.capture.blocks import STEPS, header
from sixflip.capture.pieces import PieceWriter

from .store import CaptureStore


class RecordedStore(CaptureStore):
    """CaptureStore, and every block to the host; header_again() for one that missed it."""

    recorded = True

    def __init__(self, board, root, meta, columns, expected_bytes):
        self._pieces = PieceWriter(board.write_bytes)
        self._to_host = self._to_file = True
        CaptureStore.__init__(self, root, meta, columns, expected_bytes)

    def _write(self, data):
        if self._to_host:
            self._send(data)
        if self._to_file and not (self.sums_only and data[0] == STEPS):
            CaptureStore._write(self, data)

    def _send(self, data):
        try:
            self._pieces.send(self._writer.written if self._writer else 0, data)
        except MemoryError:
            self._pieces.sequence += 1  # the host says which samples it has not got

    def add(self, dt_us, sample):
        self._writer.add(dt_us, sample)
        if not self.sums_only:
            self.kept += 1

    def header_again(self):
        from .rescue import meta_of
        meta = self._meta or meta_of(self._root)
        if meta is not None:
            self._send(header(meta, self._columns))

    def finish(self, complete, placements=()):
        """The host gets the poses in force once more: it knows those that it has."""
        self._writer.flush()
        self._to_file = False
        for placement in placements:
            self._writer.pose(placement)
        self._writer.end(complete)
        self._to_file, self._to_host = True, False
        return CaptureStore.finish(self, complete, placements)
