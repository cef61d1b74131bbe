"""Captures as they are looked at, for the diagnosis of one and the summary of a fleet's alike:
without the rows that nobody read, and with their bytes put right."""
from . import byte_faults, held_values, unread_rows


def taken_out(captures, processors=1):
    """([(name, Capture)] without their damage, [Damage]). The captures given are not changed;
    processors: that captures share."""
    captures, unread = unread_rows.as_read(captures)
    captures, held = held_values.as_read(captures)
    captures, bytes_mended = byte_faults.repaired(captures, processors)
    return captures, [*unread, *held, *bytes_mended]
