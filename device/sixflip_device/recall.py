"""After the start: the newest record that fits. Without one a calibration comes first."""

from . import in_force
from .flash_files import OFFERED, size


def run(unit):
    if size(unit.board.root + OFFERED):
        from .offered import take
        take(unit)
    in_force.recall(unit)
    first, unit.first = unit.first, False
    if unit.record is None and first:
        unit.asked = True
    return "asked" if unit.asked else "rest"
