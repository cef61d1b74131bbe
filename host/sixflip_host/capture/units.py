"""Counts out of units: undo what somebody's logger did to the chip's whole numbers."""

import math

import numpy as np

from ..errors import BadFile
from .capture_header import STANDARD_G

# how many g, or deg/s, one of the unit is; None: counts already
ACCEL_UNITS = {"counts": None, "si": 1 / STANDARD_G, "m/s2": 1 / STANDARD_G, "g": 1.0,
               "mg": 1e-3}
GYRO_UNITS = {"counts": None, "si": 180 / math.pi, "rad/s": 180 / math.pi, "dps": 1.0,
              "deg/s": 1.0}
ON_GRID = 0.02          # of a step: how far values may lie off whole steps to be called counts


def find_step(values):
    """The step every value is a whole multiple of, or None when there is no such step.

    values  float array of any shape. The smallest difference between two values is the first
            guess; least squares over all values refines it.
    """
    distinct = np.unique(np.abs(values))
    gaps = np.diff(np.concatenate(([0.0], distinct)))
    gaps = gaps[gaps > 1e-9 * max(distinct[-1], 1e-300)]
    if not len(gaps):
        return None
    step = float(gaps.min())
    for near in (50, 1000, np.inf):         # a rough step is good for small multiples only
        multiples = np.rint(distinct / step)
        few = (multiples <= near) & (multiples > 0)
        if few.any():
            step = float((distinct[few] * multiples[few]).sum() / (multiples[few] ** 2).sum())
    off = np.abs(distinct / step - np.rint(distinct / step)).max()
    return step if off < ON_GRID else None


def to_counts(path, what, values, unit, lsb, tables):
    """Whole counts of values in a unit.

    values  float (n, 3); unit a key of `tables` (ACCEL_UNITS or GYRO_UNITS)
    lsb     counts per g or per deg/s; None: found from the values' own step
    Returns int16 (n, 3), counts per g or deg/s, largest rounding in counts.
    """
    per_unit = tables[unit]
    if per_unit is None:
        counts = values
        if lsb is None:
            raise BadFile("%s: the %s is in counts, so its LSB must be given (%s)" % (
                path, what, "--accel-lsb, counts per g" if what == "accelerometer"
                else "--gyro-lsb, counts per deg/s"))
    else:
        values = values * per_unit
        if lsb is None:
            step = find_step(values)
            if step is None:
                raise BadFile("%s: the %s is not in whole steps, so its LSB must be given" % (
                    path, what))
            lsb = 1 / step
        counts = values * lsb
    whole = np.rint(counts)
    rounding = float(np.abs(counts - whole).max())
    if per_unit is None and rounding:
        row = int(np.argmax(np.abs(counts - whole).max(axis=1)))
        raise BadFile("%s: row %d of the %s is %s, expected whole counts (or say --units)" % (
            path, row + 1, what, counts[row].tolist()))
    if np.abs(whole).max() > 32768 or whole.max() > 32767:
        raise BadFile("%s: the %s reaches %.0f counts, expected at most 32767: is its LSB %g "
                      "right?" % (path, what, np.abs(whole).max(), lsb))
    return whole.astype(np.int16), lsb, rounding


def common_step(counts):
    """The largest whole number every count is a multiple of (4: two low bits never move)."""
    return int(np.gcd.reduce(np.abs(counts.astype(np.int64)).ravel())) or 1
