"""After the start: the newest record that fits. Without one a calibration comes first."""

import os

from . import in_force
from .flash_files import NEW, OFFERED, size


def run(unit):
    if size(unit.board.root + OFFERED):
        from .offered import take
        take(unit)
    in_force.recall(unit)
    try:
        os.stat(unit.board.root + NEW)
    except OSError:
        pass  # no session was cut short
    else:
        from .cut_short import file_away
        try:
            file_away(unit.board.root)
        except OSError as e:
            unit.events.error("the capture stays as capture.new: %s" % e, "a rename that works")
    first, unit.first = unit.first, False
    if unit.record is None and first:
        unit.asked = unit.asked or "nobody"  # has: the board does by itself
    return "asked" if unit.asked else "put_in_force"
