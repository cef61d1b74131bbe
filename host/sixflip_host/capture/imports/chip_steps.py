"""The unit of a sensor's values by their step: a logger that multiplied a chip's counts leaves one
of the few numbers that chips have for a count, in the unit it multiplied them to."""

from typing import NamedTuple

import numpy as np

from sixflip.chips import catalogue

from ..capture_header import ACCEL, GYRO, STANDARD_G
from . import units

COUNTS = 32768          # of a full scale, by which many loggers divide it
TELLS = 1e-4            # of a step: data sheets round 250 / 32768 to 1 / 131, which is five of it
LOGGERS_G = (STANDARD_G, 9.81, 9.8)     # m/s² that loggers make of 1 g


class ChipStep(NamedTuple):
    """unit of the values; words: which chip's count their step is."""

    unit: str
    words: str


def _chips(name):
    """{g or deg/s of a count} of the chips that are known, by the name of their drivers' table of
    ranges: as the data sheet has it, and as a logger has it that divides the range."""
    rows = [row for chip in catalogue.CHIPS if chip[1]
            for row in getattr(catalogue.driver(chip[0]), name)]
    return {size for full, lsb, _ in rows for size in (1 / lsb, full / COUNTS)}


SIZES = {ACCEL: ("g", _chips("ACCEL_RANGES")), GYRO: ("deg/s", _chips("GYRO_RANGES"))}
PER_UNIT = {ACCEL: [("g", 1.0), ("mg", 1e-3), *(("m/s2", 1 / g) for g in LOGGERS_G),
                    ("mm/s2", 1e-3 / STANDARD_G)],
            GYRO: [(unit, units.GYRO_UNITS[unit]) for unit in ("dps", "rad/s", "mdps")]}


def told(sensor, step):
    """The ChipStep that the step of a sensor's values is, or None; step: as units.Sizes has it."""
    if step is None:
        return None
    of, sizes = SIZES[sensor]
    for unit, per_unit in PER_UNIT[sensor]:
        for size in sizes:
            if abs(step * per_unit / size - 1) < TELLS:
                return ChipStep(unit, "its step of %.6g is a chip's, 1/%.6g %s" % (
                    step, 1 / size, of))
    return None


def gyro_lsb(sensor):
    """Counts per deg/s in each of the ranges that a chip has, by its name; () of one that is not
    known."""
    if sensor not in catalogue.SENSORS:
        return ()
    return tuple(sorted({row[1] for row in catalogue.driver(sensor).GYRO_RANGES}, reverse=True))


def of_header(sensor, counts):
    """({key: value} of a capture's header, sentences) on the units.Counts of a sensor: whether
    they are the file's own; and the chip's step where it is a multiple of theirs, as where an
    offset that is none of the chip's counts was taken off."""
    name = {ACCEL: "accel", GYRO: "gyro"}[sensor]
    if counts.kind == "float":
        return {name + "_values": "float"}, []
    own = int(np.gcd.reduce(np.diff(np.sort(counts.counts.astype(np.int64), axis=0), axis=0),
                            axis=None))
    of, sizes = SIZES[sensor]
    if own < 2 or not (counts.counts % own).any() or not any(
            abs(own / counts.lsb / size - 1) < TELLS for size in sizes):
        return {}, []
    return {name + "_own_step": own}, [
        "all %s counts of an axis are multiples of %d apart: its own step is 1/%.6g %s, and an "
        "offset was taken off" % (name, own, counts.lsb / own, of)]
