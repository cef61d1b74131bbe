"""After the start: the newest record that fits. Without one a calibration comes first: where one
was left unfinished, that one goes on."""

import os

from ..flash_files import NEW, OFFERED, REFUSED, size
from . import active_record


def run(unit):
    if size(unit.board.root + OFFERED):
        from .uploaded_record import take
        take(unit)
    active_record.recall(unit)
    try:
        os.stat(unit.board.root + NEW)
    except OSError:
        pass  # no session was cut short
    else:
        from ..capture.cut_short import file_cut_short
        try:
            file_cut_short(unit.board.root)
        except OSError as e:
            unit.events.error("the capture stays as capture.new: %s" % e, "a rename that works")
    first, unit.first = unit.first, False
    if unit.record is None and first and not unit.asked:
        unit.asked = "nobody"  # has: the board does by itself
        if size(unit.board.root + REFUSED):
            from ..capture.cut_short import unfinished
            if unfinished(unit.board.root):
                unit.request = {"continue": True}
    return "asked" if unit.asked else "put_in_force"
