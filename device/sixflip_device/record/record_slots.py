"""Two files for the correction record; the newest valid one wins.

A new record is written beside both (record.new), read back, and only then put in the place
of the older one. FAT renames by unlink and rename: a power cut in between leaves a whole
record.new, which the next load() takes and puts in its place. So at every moment at least
one valid record is complete on the flash, and a cut leaves the old one or the new one.
"""

import os

from sixflip.record.record import following, newer

from ..flash_files import remove

SLOTS = ("a", "b")
NEW = "record.new"
MOST = 2049  # bytes to read: one more than a record may have


class RecordSlots:
    """Records in root + record_a.bin and record_b.bin."""

    def __init__(self, root):
        self._root = root

    def _name(self, slot):
        return self._root + "record_" + slot + ".bin"

    def _read(self, name):
        """-> (record, "") or (None, reason); a file that is not there gives no reason."""
        try:
            with open(name, "rb") as f:
                data = f.read(MOST)
        except OSError:
            return None, ""
        from sixflip.record.correction_record import decode  # not needed while sampling
        from sixflip.record.record import implausible
        try:
            record = decode(data)
        except ValueError as e:
            return None, str(e)
        reason = implausible(record)
        return (None, "it cannot be a sensor's: " + reason) if reason else (record, "")

    def _settle(self):
        """Finish or clear away what a power cut left behind."""
        new, reason = self._read(self._root + NEW)
        if new is None:
            if reason:
                os.remove(self._root + NEW)
            return
        slot, newest = self._newest()
        if newest is not None and not newer(new.sequence, newest.sequence):
            os.remove(self._root + NEW)
        else:
            self._place(self._other(slot))

    def _newest(self):
        best = None, None
        for slot in SLOTS:
            record = self._read(self._name(slot))[0]
            if record is not None and (best[1] is None or newer(record.sequence,
                                                                best[1].sequence)):
                best = slot, record
        return best

    def _other(self, slot):
        return "b" if slot == "a" else "a"

    def _place(self, slot):
        remove(self._name(slot))
        os.rename(self._root + NEW, self._name(slot))

    def _write(self, record, slot):
        from sixflip.record.correction_record import encode
        data = encode(record)
        name = self._root + NEW
        try:
            with open(name, "wb") as f:
                f.write(data)
            with open(name, "rb") as f:
                same = f.read() == data
        except OSError:
            remove(name)
            raise
        if not same:
            os.remove(name)
            raise OSError("the record reads back differently from what was written")
        self._place(slot)

    def load(self, misfit):
        """misfit(record) -> "" or why it does not belong to this sensor.

        Returns (slot, record, refusals): slot and record None when neither will do, refusals
        a list of (slot, reason).
        """
        try:
            self._settle()
        except OSError as e:
            error = [("new", "could not be put in its place: %s" % e)]
        else:
            error = []
        best = None, None
        refusals = error
        for slot in SLOTS:
            record, reason = self._read(self._name(slot))
            if record is not None:
                reason = misfit(record)
            if reason:
                refusals.append((slot, reason))
            elif record is not None and (best[1] is None or newer(record.sequence,
                                                                  best[1].sequence)):
                best = slot, record
        return best[0], best[1], refusals

    def save(self, record):
        """Sets record.sequence, writes it in place of the older one, returns the slot.

        OSError when the flash will not take it; what was valid before still is.
        """
        self._settle()
        slot, newest = self._newest()
        record.sequence = 1 if newest is None else following(newest.sequence)
        slot = self._other(slot)
        self._write(record, slot)
        return slot

    def restore(self, misfit):
        """Makes the record before the newest one again; returns (slot, record).

        ValueError with a sentence when there is none, or it belongs to another sensor.
        """
        self._settle()
        slot, newest = self._newest()
        if newest is None:
            raise ValueError("no valid record is stored")
        slot = self._other(slot)
        record, reason = self._read(self._name(slot))
        if record is None:
            raise ValueError("there is no record before this one"
                             + (": " + reason if reason else ""))
        reason = misfit(record)
        if reason:
            raise ValueError("the record before this one does not fit: " + reason)
        record.sequence = following(newest.sequence)
        self._write(record, slot)
        return slot, record
