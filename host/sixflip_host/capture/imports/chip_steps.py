"""The unit of a sensor's values by their step: a logger that multiplied a chip's counts leaves one
of the few numbers that chips have for a count, in the unit it multiplied them to."""

import math
from typing import NamedTuple

import numpy as np

from sixflip.chips import catalogue

from ..capture_header import ACCEL, GYRO, STANDARD_G
from . import units, value_steps

COUNTS = 32768          # of a full scale, by which many loggers divide it
TELLS = 1e-4            # of a step: data sheets round 250 / 32768 to 1 / 131, which is five of it
# Different values of an axis, at most, whose grid is looked for: 16 bits have room for eight times
# as many. Values beyond the first ones, at least: each lies on a grid by chance with twice
# value_steps.ON_GRID. Parts of a step, at least and at most, in which an offset is kept: a mean is
# off by half of one.
MOST_CODES, FEWEST_ON_GRID, PARTS = 4096, 8, (64, 1024)
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


class Sizes(value_steps.Sizes):
    """Sizes that also keeps the different values of each axis, as long as they are few."""

    def __init__(self):
        super().__init__()
        self._codes = None

    def add(self, values):
        super().add(values)
        known = self._codes or [np.zeros(0)] * values.shape[1]
        self._codes = [axis if len(axis) > MOST_CODES else np.union1d(axis, column)
                       for axis, column in zip(known, values.T)]

    def grid(self):
        """(step, offsets (k,)) of the grid that the values of each axis lie on, or None."""
        axes = self._codes or []
        gaps = np.concatenate([np.diff(axis) for axis in axes] or [np.zeros(0)])
        if len(gaps) < FEWEST_ON_GRID or max(map(len, axes)) > MOST_CODES:
            return None
        for step in value_steps.least_gaps(gaps, max(float(np.abs(axis).max()) for axis in axes)):
            for near in (8, 50, 1000, math.inf):
                number = np.rint(gaps / step)
                few = number <= near
                step = float((gaps[few] * number[few]).sum() / (number[few] ** 2).sum())
            offsets = [float(np.median(axis - np.rint((axis - axis[0]) / step) * step))
                       for axis in axes]
            whole = [(axis - offset) / step for axis, offset in zip(axes, offsets)]
            if max(float(np.abs(x - np.rint(x)).max()) for x in whole) < value_steps.ON_GRID:
                return step, np.array(offsets)
        return None


def counts_of(sensor, path, what, values, unit, lsb, per_unit, sizes):
    """units.counts_of values, in parts of a chip's step where that has an offset on each axis;
    sizes: their Sizes."""
    step = sizes.step()
    grid = sizes.grid() if step is None and lsb is None and per_unit is not None else None
    if grid is not None and is_a_chips(sensor, grid[0] * per_unit):
        size, offsets = grid
        parts = units.ROOM * size / max(float(np.abs(values).max()), size)
        parts = 2 ** int(math.log2(min(max(parts, 1.0), PARTS[1])))
        if parts >= PARTS[0]:
            part = size / parts
            whole = np.rint((values - offsets) / size) * parts + np.rint(offsets / part)
            return units.Counts(whole.astype(np.int16), 1 / (part * per_unit), "float", [])
    return units.counts_of(path, what, values, unit, lsb, per_unit, step)


def is_a_chips(sensor, size, told=TELLS):
    """Whether a size, in g or deg/s, known to such a part of it, is that of a chip's count."""
    return any(abs(size / one - 1) < told for one in SIZES[sensor][1])


def told(sensor, step):
    """The ChipStep that the step of a sensor's values is, or None; step: as Sizes has it."""
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
    more = {name + "_values": "float"} if counts.kind == "float" else {}
    own = int(np.gcd.reduce(np.diff(np.sort(counts.counts.astype(np.int64), axis=0), axis=0),
                            axis=None))
    of = SIZES[sensor][0]
    if own < 2 or not (counts.counts % own).any() or not is_a_chips(sensor, own / counts.lsb):
        return more, []
    if more:
        return {**more, name + "_own_step": own}, [
            "all %s values of an axis are whole steps of 1/%.6g %s apart: an offset was taken off"
            % (name, counts.lsb / own, of)]
    return {name + "_own_step": own}, [
        "all %s counts of an axis are multiples of %d apart: its own step is 1/%.6g %s, and an "
        "offset was taken off" % (name, own, counts.lsb / own, of)]
