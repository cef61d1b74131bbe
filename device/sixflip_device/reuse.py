"""After a calibration: the record now in force, new or let go of for the session, corrects."""

from . import in_force
from .blank_record import blank_record


def run(unit):
    in_force.again(unit, blank_record(unit))
    in_force.use(unit, unit.slot, unit.record)
    return "stream"
