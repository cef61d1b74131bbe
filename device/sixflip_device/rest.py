"""The record comes in force; while the board is at rest the gyro's bias is measured anew."""

from . import in_force
from .bus_recovery import BusLost


def run(unit):
    in_force.use(unit, unit.slot, unit.record)
    try:
        if unit.record is not None:
            from .refresh import refresh
            rest = refresh(unit)
            if unit.settings["mounting"] is not None:
                from .mount import at_power_up
                at_power_up(unit, rest)
    except BusLost as e:
        unit.events.error(str(e), "the sensor that was there a moment ago")
        return "start"
    return "asked" if unit.asked else "" if unit.stopped else "stream"
