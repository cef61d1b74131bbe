"""The record at power-up: one that a host has uploaded is taken first, then the newest that fits
is loaded. Without one a calibration comes first; where one was left unfinished, that one goes on.
"""

import os

from ..capture.files import file_cut_short, unfinished
from ..flash_files import NEW, REFUSED, UPLOADED, remove, size
from .active_record import blank_record, load, misfit


def run(firmware):
    """Sets slot and record, or a request without a record; what a power cut left is filed."""
    root = firmware.board.root
    if size(root + UPLOADED):
        take_uploaded(firmware)
    load(firmware)
    try:
        os.stat(root + NEW)
    except OSError:
        pass  # no session was cut short
    else:
        try:
            file_cut_short(root)
        except OSError as e:
            firmware.events.error("the capture stays as capture.new: %s" % e,
                                  "a rename that works")
    first, firmware.first = firmware.first, False
    if firmware.record is None and first and firmware.request is None:
        firmware.request = {"unasked": True}
        if size(root + REFUSED) and unfinished(root):
            firmware.request["continue"] = True


def _checked(firmware, name):
    """(slot, record) of an uploaded file, saved; ValueError or OSError when it cannot be used."""
    from sixflip.record.correction import correction_of
    from sixflip.record.correction_record import MOST, decode
    from sixflip.record.record import implausible

    from .record_slots import RecordSlots
    with open(name, "rb") as f:
        record = decode(f.read(MOST + 1))
    reason = implausible(record) or misfit(blank_record(firmware))(record)
    if reason:
        raise ValueError(reason)
    correction_of(record)  # its terms are ones that can be calculated with
    return RecordSlots(firmware.board.root).save(record), record


def take_uploaded(firmware):
    """A record that a host has put on the flash as offered.bin becomes the newest, or is refused.

    It is looked at once and gone afterwards, whatever came of it.
    """
    name = firmware.board.root + UPLOADED
    reason = ""
    try:
        slot, record = _checked(firmware, name)
    except (ValueError, OSError, ArithmeticError) as e:
        reason = str(e)
    remove(name)  # before a host hears of it and lets go of the board
    if reason:
        firmware.events.emit("not_restored", reason=reason)
    else:
        firmware.events.emit("restored", slot=slot, sequence=record.sequence,
                             session=record.session, measured=record.measured(),
                             terms=[tag for tag, _ in record.terms])
