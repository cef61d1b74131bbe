"""After a calibration: the record now in force, new or let go of for the session, corrects."""

import gc

from . import active_record
from .blank_record import blank_record


def run(unit):
    active_record.again(unit, blank_record(unit))
    active_record.use(unit, unit.slot, unit.record)
    if unit.record is None or not unit.record.terms:
        return "stream"
    if hasattr(gc, "mem_free") and gc.mem_free() < 65536:
        # the names of all that ran stay in the heap
        unit.events.error("the record's terms are not in force: no room after a session",
                          "a power-up")
        return "stream"
    return "terms"
