"""Counts out of units: undo what somebody's logger did to the chip's whole numbers."""

import math

import numpy as np

from ..errors import BadFile
from .capture_header import STANDARD_G
from .growing import Growing

# how many g, or deg/s, one of the unit is; None: counts already
ACCEL_UNITS = {"counts": None, "si": 1 / STANDARD_G, "m/s2": 1 / STANDARD_G, "g": 1.0,
               "mg": 1e-3}
GYRO_UNITS = {"counts": None, "si": 180 / math.pi, "rad/s": 180 / math.pi, "dps": 1.0,
              "deg/s": 1.0}
LARGEST = 1e9           # in any unit: no sensor, and squares of more leave a float
MOST_DISTINCT = 1 << 17 # sizes of values in whole steps: 16 bits have a quarter of that
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


class Counts:
    """Whole counts of three axes, out of blocks of their values in a unit.

    what    name of the sensor; unit: a key of `tables` (ACCEL_UNITS or GYRO_UNITS)
    lsb     counts per g or per deg/s; None: it is found from the values' own step, then every
            block is looked at first, and added after settle()
    rounding    largest distance of a value from a whole count
    """

    def __init__(self, path, what, unit, lsb, tables):
        self.path, self.what, self.lsb = path, what, lsb
        self.per_unit = tables[unit]
        self.rounding = 0.0
        self._low = self._high = 0.0
        self._distinct = np.zeros(0)
        self._counts = Growing(np.int16, 3)
        if self.per_unit is None and lsb is None:
            raise BadFile("%s: the %s is in counts, so its LSB must be given (%s)" % (
                path, what, "--accel-lsb, counts per g" if what == "accelerometer"
                else "--gyro-lsb, counts per deg/s"))

    def look(self, values):
        """Values (n, 3) to find the step of."""
        self._plausible(values)
        self._distinct = np.union1d(self._distinct, np.abs(values * self.per_unit))
        if len(self._distinct) > MOST_DISTINCT:
            self._no_step()

    def settle(self):
        """The LSB from what was looked at."""
        step = find_step(self._distinct)
        if step is None:
            self._no_step()
        self.lsb = 1 / step

    def _no_step(self):
        raise BadFile("%s: the %s is not in whole steps, so its LSB must be given" % (
            self.path, self.what))

    def _plausible(self, values):
        if not np.abs(values).max() < LARGEST:
            raise BadFile("%s: the %s reaches %g, expected less than %g" % (
                self.path, self.what, np.abs(values).max(), LARGEST))

    def add(self, values):
        """Values (n, 3) as counts behind those that are there."""
        self._plausible(values)
        counts = values if self.per_unit is None else values * self.per_unit * self.lsb
        whole = np.rint(counts)
        off = np.abs(counts - whole)
        self.rounding = max(self.rounding, float(off.max()))
        if self.per_unit is None and self.rounding:
            row = int(np.argmax(off.max(axis=1)))
            raise BadFile("%s: row %d of the %s is %s, expected whole counts (or say --units)" % (
                self.path, len(self._counts) + row + 1, self.what, counts[row].tolist()))
        self._low = min(self._low, float(whole.min()))
        self._high = max(self._high, float(whole.max()))
        self._counts.add(np.clip(whole, -32768, 32767).astype(np.int16))

    def array(self):
        """int16 (n, 3); BadFile where they do not fit into 16 bits."""
        if self._low < -32768 or self._high > 32767:
            raise BadFile("%s: the %s reaches %.0f counts, expected at most 32767: is its LSB %g "
                          "right?" % (self.path, self.what, max(-self._low, self._high), self.lsb))
        return self._counts.array()


def common_step(counts):
    """The largest whole number every count is a multiple of (4: two low bits never move)."""
    step = 0
    for first in range(0, len(counts), 1 << 16):
        some = counts[first:first + (1 << 16)].astype(np.int64)
        step = int(np.gcd(step, np.gcd.reduce(np.abs(some).ravel())))
        if step == 1:
            break
    return step or 1
