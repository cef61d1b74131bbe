"""After the start: the newest record that fits. Without one a calibration comes first."""

from . import in_force
from .flash_files import NEW, OFFERED, exists, size


def run(unit):
    if size(unit.board.root + OFFERED):
        from .offered import take
        take(unit)
    in_force.recall(unit)
    if exists(unit.board.root + NEW):
        from .cut_short import file_away
        file_away(unit.board.root)
    first, unit.first = unit.first, False
    if unit.record is None and first:
        unit.asked = True
    return "asked" if unit.asked else "put_in_force"
