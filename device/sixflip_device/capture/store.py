"""Streams a session's capture to flash: samples in blocks, and the poses' exact sums.

When space is short the samples are left out and the sums kept, and the file's end block says
so. Room for the records is always left free.
"""

from sixflip.capture.writer import BlockWriter

from ..flash_files import NEW, REFUSED, UNSAVED, free_bytes, remove
from .meta import meta_of

RESERVE = 24576      # bytes left for the records, and for the file system's own needs
SUMS_BYTES = 4096    # what the poses of a session take without their samples
ENOSPC = 28          # everywhere; MicroPython's errno module does not list it


class CaptureStore:
    """add() every sample, pose() every placement; none of them ever raises.

    Free space is asked for once, before the file is open: littlefs counts one that is being
    written up to three times, and goes through all of the flash for it, 0.15 s without a sample.

    expected_bytes  what the session may take; for that much, captures of sessions that no record
                    belongs to are removed. None: a file is continued, and they are left alone
    sums_only  True from the moment samples are no longer kept
    reason     why, in words
    recorded   True where every sample is asked for, whatever the file holds (session_stores.py)
    samples    how many the session had, kept how many of them are in the file; bytes its size
    """

    recorded = False

    def __init__(self, root, meta_bytes, columns, expected_bytes=None):
        self._root = root
        self._meta = None
        self._columns = columns
        self._file = None
        self._writer = None
        self._broken = False
        self.sums_only = False
        self.reason = ""
        self.kept = 0
        self.bytes = 0
        free = free_bytes(root)
        if expected_bytes is not None:
            for name in (NEW, REFUSED, UNSAVED):
                if free is not None and free < RESERVE + expected_bytes:
                    remove(root + name)
                    free = free_bytes(root)
            if free is not None and free < RESERVE + expected_bytes:
                self._short("%d bytes free, %d of them for the records; a session may take %d" % (
                    free, RESERVE, expected_bytes))
        self._free = free  # less what was written since; None: the port cannot tell
        self._open(meta_bytes)

    def _open(self, meta):
        """A new file with its header, on the flash at once: a capture written again needs it."""
        self._broken = False
        self.bytes = 0
        try:
            self._file = open(self._root + NEW, "wb")  # noqa: SIM115 - open for a session
        except OSError as e:
            self._fail(e)
        # with a broken file its blocks go nowhere, and the samples are still counted
        self._writer = BlockWriter(self._write, meta, self._columns,
                                   sums_only=self.sums_only and not self.recorded)
        self._flush()
        self._meta = meta if self._broken else None  # else it can be read from the file

    @property
    def samples(self):
        """How many the session had."""
        return self._writer.samples

    def _short(self, reason):
        self.sums_only = True
        self.reason = reason

    def _fail(self, error):
        self._broken = True
        if error.args and error.args[0] == ENOSPC:
            self._short("the flash is full")
        else:
            self._short("the flash gives an error: %s" % error)

    def _write(self, data):
        if self._broken:
            return
        try:
            self._file.write(data)
        except OSError as e:
            self._fail(e)
            return
        self.bytes += len(data)
        if self._free is not None:
            self._free -= len(data)
            if self._free < RESERVE + SUMS_BYTES and not self.sums_only:
                self._short("the flash is nearly full, %d bytes free" % self._free)

    def add(self, dt_us, sample):
        """Counts the sample and, unless sums_only, keeps it."""
        writer = self._writer
        writer.add(dt_us, sample)
        if not self.sums_only:
            self.kept += 1
        elif not writer.sums_only:
            self.kept += 1
            writer.flush()  # what waited was captured while there was room
            writer.sums_only = True

    def pose(self, placement):
        """Keeps a Placement, and all before it, on the flash at once."""
        self._writer.pose(placement)
        self._flush()

    def withdraw(self, code, first=None):
        """The placements of a pose (with first: only that one) do not count any more."""
        self._writer.withdraw(code, first)

    def note(self, text):
        """Keeps a sentence about what happened."""
        self._writer.note(text)

    def _flush(self):
        """So that a power cut leaves the file up to here (littlefs commits at flush)."""
        if not self._broken:
            try:
                self._file.flush()
            except OSError as e:
                self._fail(e)

    def _close(self):
        if self._file is not None:
            try:
                self._file.close()
            except OSError as e:
                self._fail(e)
            self._file = None

    def finish(self, complete, placements=()):
        """Ends the file. False when not even the sums could be kept (reason says why).

        placements: those accepted, to be written again if the file is broken.
        """
        if not self._broken:
            self._end(complete)
        if self._broken:
            self._write_sums(placements, complete)
        self._close()
        if self._broken:
            remove(self._root + NEW)
        return not self._broken

    def _end(self, complete):
        self._writer.sums_only = self.sums_only
        self._writer.end(complete)
        self._flush()
        self._close()

    def _write_sums(self, placements, complete):
        """The last resort where the file is broken: the poses' sums alone, in a new file, for a
        half-written block lies in the way of the old one."""
        self._close()
        meta = self._meta or meta_of(self._root)
        if meta is None:
            return
        remove(self._root + NEW)
        self.kept = 0
        samples = self.samples
        self._open(meta)
        self._writer.samples = samples
        if not self._broken:
            for placement in placements:
                self._writer.pose(placement)
            self._end(complete)
