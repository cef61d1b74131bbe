"""The stores of unusual sessions, loaded only when one is wanted: of a session whose capture goes
to the host as well, and of one that goes on with the capture of the session before.
"""

from sixflip.capture.blocks import STEPS, header
from sixflip.capture.pieces import PieceWriter
from sixflip.capture.writer import BlockWriter

from ..flash_files import NEW
from .meta import meta_of
from .store import CaptureStore


class RecordedStore(CaptureStore):
    """A CaptureStore that sends every block to the host, whatever the flash has room for.

    resend_header() sends the header to a host that missed it.
    """

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
        """As CaptureStore.add; the host gets every sample, whatever the file holds."""
        self._writer.add(dt_us, sample)
        if not self.sums_only:
            self.kept += 1

    def resend_header(self):
        """Sends the header to a host that has missed it."""
        meta = self._meta or meta_of(self._root)
        if meta is not None:
            self._send(header(meta, self._columns))

    def finish(self, complete, placements=()):
        """The host is sent the accepted poses once more; it knows those that it has."""
        self._writer.flush()
        self._to_file = False
        for placement in placements:
            self._writer.pose(placement)
        self._writer.end(complete)
        self._to_file, self._to_host = True, False
        return CaptureStore.finish(self, complete, placements)


class ContinuedStore(CaptureStore):
    """Goes on with the file that redo_session.py has begun; before: its SessionBefore."""

    def __init__(self, root, meta, mask, before):
        self._before = before
        CaptureStore.__init__(self, root, meta, mask)

    def _open(self, meta):
        before, self._before = self._before, None
        if before is None:  # the file was broken: once more, without samples
            return CaptureStore._open(self, meta)
        from sixflip.capture.scan import go_on
        if before.sums_only:
            self._short(before.reason)
        self.bytes, self.kept = before.bytes, before.kept
        try:
            self._file = open(self._root + NEW, "ab")  # noqa: SIM115 - open for a session
        except OSError as e:
            self._fail(e)
        self._writer = BlockWriter(self._write, None, self._columns, sums_only=self.sums_only)
        go_on(self._writer, before.samples, before.seconds, before.us)
        return None
