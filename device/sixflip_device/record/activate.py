"""The record that was read comes in force; by itself, in a small heap the rest compiles after."""

import gc
import sys

from . import active_record

WORDS = 16384  # of heap; below, it is small


def small():
    if not hasattr(gc, "mem_free"):
        return False
    heap = gc.mem_free() + gc.mem_alloc()
    return heap < WORDS * (8 if sys.maxsize > 0x7FFFFFFF else 4)


def run(unit):
    active_record.use(unit, unit.slot, unit.record)
    if unit.record is not None and unit.record.terms and not small():
        from .terms import bring
        bring(unit)
    return "rest"
