"""After a calibration: the record now in force, new or let go of for the session, corrects."""

import gc

from . import in_force
from .blank_record import blank_record


def run(unit):
    in_force.again(unit, blank_record(unit))
    in_force.use(unit, unit.slot, unit.record)
    if unit.record is None or not unit.record.terms:
        return "stream"
    if hasattr(gc, "mem_free") and gc.mem_free() < 65536:
        # the names of all that ran stay in the heap
        unit.events.error("the record's terms are not in force: no room after a session",
                          "a power-up")
        return "stream"
    return "terms"
