"""The record is in force; while the board is at rest the gyro's bias is measured anew."""

from ..sensor import BusLost


def run(unit):
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
    if unit.asked or unit.stopped:
        return "asked" if unit.asked else ""
    if unit.record is not None and unit.record.terms:
        from .activate import small
        return "terms" if small() else "stream"
    return "stream"
