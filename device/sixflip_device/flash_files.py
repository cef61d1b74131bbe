"""Files on the board's flash, the record's two slots aside (record_slots.py)."""

import os

FLAG = "calibrate.flag"  # its presence asks for a calibration at the next power-up
UPLOADED = "offered.bin"  # a record that a host has put there (record/load_record.py)
NEW = "capture.new"       # of the session under way; what becomes of it: capture/files.py
GOOD = "capture.bin"
UNSAVED = "unsaved.bin"
REFUSED = "refused.bin"


def free_bytes(root):
    """Free bytes of the file system, or None where the port cannot tell."""
    try:
        v = os.statvfs(root or ".")
    except (AttributeError, OSError):
        return None
    return v[0] * v[4]


def size(name):
    """Bytes of a file, 0 when it is not there."""
    try:
        return os.stat(name)[6]
    except OSError:
        return 0


def remove(name):
    """Removes a file that may not be there."""
    try:  # noqa: SIM105 - MicroPython has no contextlib
        os.remove(name)
    except OSError:
        pass
