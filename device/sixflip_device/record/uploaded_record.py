"""A record that a host has put on the flash: checked, then the newest, or refused.

It comes as offered.bin, is looked at once and is gone afterwards, whatever came of it.
"""

from ..flash_files import OFFERED, remove
from .active_record import misfit
from .blank_record import blank_record


def _take(unit, name):
    """(slot, record); ValueError or OSError when it is not to be had."""
    from sixflip.record.correction_record import MOST, decode
    from sixflip.record.record import implausible

    from .record_slots import RecordSlots
    with open(name, "rb") as f:
        record = decode(f.read(MOST + 1))
    reason = implausible(record) or misfit(blank_record(unit))(record)
    if reason:
        raise ValueError(reason)
    from sixflip.record.correction import correction_of
    correction_of(record)  # it can be calculated with
    return RecordSlots(unit.board.root).save(record), record


def take(unit):
    name = unit.board.root + OFFERED
    reason = ""
    try:
        slot, record = _take(unit, name)
    except (ValueError, OSError, ArithmeticError) as e:
        reason = str(e)
    remove(name)  # before a host hears of it and lets go of the board
    if reason:
        unit.events.emit("not_restored", reason=reason)
    else:
        unit.events.emit("restored", slot=slot, sequence=record.sequence,
                         session=record.session, measured=record.measured(),
                         terms=[tag for tag, _ in record.terms])
