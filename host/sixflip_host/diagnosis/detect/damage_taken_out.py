"""Captures as they are looked at, for the diagnosis of one and the summary of a fleet's alike:
with their rows in order, without those that nobody read, and with their bytes put right."""
from . import byte_faults, held_values, row_order, unread_rows


def taken_out(captures, processors=1):
    """([(name, Capture)] without their damage, [Damage]). The captures given are not changed;
    processors: that captures share."""
    captures, disordered = row_order.as_read(captures)
    captures, unread = unread_rows.as_read(captures)
    captures, held = held_values.as_read(captures)
    captures, bytes_mended = byte_faults.repaired(captures, processors)
    return captures, [*disordered, *unread, *held, *bytes_mended]
