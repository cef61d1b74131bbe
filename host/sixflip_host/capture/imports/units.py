"""Counts out of units: undo what somebody's logger did to the chip's whole numbers."""

import math
from typing import NamedTuple

import numpy as np

from sixflip import RAIL

from ...errors import BadFile
from ..capture_header import STANDARD_G
from .value_steps import ON_GRID

# how many g, or deg/s, one of the unit is; None: counts already
ACCEL_UNITS = {"counts": None, "si": 1 / STANDARD_G, "m/s2": 1 / STANDARD_G, "g": 1.0,
               "mg": 1e-3, "mm/s2": 1e-3 / STANDARD_G}
GYRO_UNITS = {"counts": None, "si": 180 / math.pi, "rad/s": 180 / math.pi, "dps": 1.0,
              "deg/s": 1.0, "mdps": 1e-3}
LARGEST = 1e9           # in any unit: no sensor, and squares of more leave a float
ROOM = 32000            # counts that the largest of float values gets; the rest is headroom
MOST_ON_RAIL = 1e-3     # share of samples one count beyond 16 bits that are taken as on the rail
AT_A_TIME = 1 << 16     # rows; the first of them are new values
# Rows in which a value that stays has one count: more than any log has that is read faster than
# its sensor (32 in detect/held_values.py), few enough for the mean of a rest.
HELD_ROWS = 64


def _blocks(values):
    for first in range(0, len(values), AT_A_TIME):
        yield values[first:first + AT_A_TIME].astype(float)


class Counts(NamedTuple):
    """counts int16 (n, 3); lsb: counts per g or deg/s; kind: "counts", or "float" where the
    values had no steps and the counts are those of this file; remarks: sentences."""

    counts: np.ndarray
    lsb: float
    kind: str
    remarks: list


def counts_of(path, what, values, unit, lsb, per_unit, step=None):
    """Counts of values (n, 3) in a unit; per_unit: g or deg/s that one of the unit is, or None
    where they are counts already; step: what all of them are multiples of, or None.

    BadFile where they reach beyond 16 bits, are no whole counts, or are of no sensor.
    """
    largest = max(float(values.max()), -float(values.min()))
    if not largest < LARGEST:
        raise BadFile("%s: the %s reaches %g, expected less than %g" % (
            path, what, largest, LARGEST))
    if per_unit is None:
        return _whole(path, what, values, lsb)
    of = "g" if what == "accelerometer" else "deg/s"
    if lsb is not None:
        counts, rounding, remarks = _scaled(path, what, values, per_unit * lsb)
        if rounding > ON_GRID:
            remarks.append("%s values are not whole counts at %g per %s: rounded by up to %.2f "
                           "count" % (what, lsb, of, rounding))
        return Counts(counts, lsb, "counts", remarks)
    if step is not None and round(largest / step) <= RAIL + 1 and not _printed(step):
        lsb = 1 / (step * per_unit)
        counts, _, remarks = _scaled(path, what, values, 1 / step)
        return Counts(counts, lsb, "counts", [
            "%s values are whole steps of 1/%.6g %s" % (what, lsb, of), *remarks])
    if step is None or largest / step > ROOM:
        step = max(largest, 1e-300) / ROOM
        words = "are no whole steps: kept as floats, to %.2g %s, without shifting a mean"
    else:
        words = "are printed to %.2g %s, which says nothing of the sensor's own steps"
    return Counts(_shaped(values, step), 1 / (step * per_unit), "float",
                  ["%s values %s" % (what, words % (step, _name(what, unit)))])


def _name(what, unit):
    return {"accelerometer": "m/s2", "gyro": "rad/s"}[what] if unit == "si" else unit


def _printed(step):
    """True for 0.1, 0.01 and so on: decimals that somebody printed."""
    power = math.log10(step)
    return power < 0.5 and abs(power - round(power)) < 1e-7


def _whole(path, what, values, lsb):
    """Counts of values that are counts."""
    if lsb is None:
        raise BadFile("%s: the %s is in counts, so its LSB must be given (%s)" % (
            path, what, {"accelerometer": "--accel-lsb, counts per g",
                         "gyro": "--gyro-lsb, counts per deg/s"}.get(what, "--mag-lsb")))
    counts = np.empty(values.shape, np.int16)
    beyond = at = 0
    for block in _blocks(values):
        whole = np.rint(block)
        off = np.abs(block - whole)
        if off.any():
            row = int(np.argmax(off.max(axis=1)))
            raise BadFile("%s: row %d of the %s is %s, expected whole counts (or say --units)" % (
                path, at + row + 1, what, block[row].tolist()))
        beyond += _clip(path, what, whole, counts[at:at + len(block)], lsb)
        at += len(block)
    return Counts(counts, lsb, "counts", _clipped(path, what, beyond, len(values), lsb))


def _scaled(path, what, values, factor):
    """(int16 counts, largest rounding, remarks) of values times a factor."""
    counts, rounding = np.empty(values.shape, np.int16), 0.0
    beyond = at = 0
    for block in _blocks(values):
        block = block * factor
        whole = np.rint(block)
        rounding = max(rounding, float(np.abs(block - whole).max()))
        beyond += _clip(path, what, whole, counts[at:at + len(block)], factor)
        at += len(block)
    return counts, rounding, _clipped(path, what, beyond, len(values), factor)


def _clip(path, what, whole, counts, lsb):
    """Writes whole counts into out, +32768 as 32767; the number of these. BadFile for more."""
    low, high = float(whole.min()), float(whole.max())
    if low < -32768 or high > RAIL + 1:
        raise BadFile("%s: the %s reaches %.0f counts, expected at most 32767: is its LSB %g "
                      "right?" % (path, what, max(-low, high), lsb))
    counts[:] = np.minimum(whole, RAIL)
    return int((whole > RAIL).sum())


def _clipped(path, what, beyond, rows, lsb):
    """The remark on values at 32768, one count beyond 16 bits."""
    if beyond > max(1, MOST_ON_RAIL * 3 * rows):
        raise BadFile("%s: the %s reaches 32768 counts in %d values, expected at most 32767: is "
                      "its LSB %g right?" % (path, what, beyond, lsb))
    return ["%d value%s of the %s at 32768 %s clipped to 32767" % (
        beyond, "s" * (beyond > 1), what, "are" if beyond > 1 else "is")] if beyond else []


def _shaped(values, step):
    """int16 counts of values in steps, the rounding error of each value carried over to the next,
    so that means and sums are right to a few steps however coarse it is. Values that are equal in
    rows on end are one value, and become equal counts: that a log repeats its rows says how fast
    its sensor was read. One that stays for longer is a new value every HELD_ROWS rows."""
    shaped = np.empty(values.shape, np.int16)
    carry, at = np.zeros(values.shape[1]), 0
    for block in _blocks(values):
        for axis, column in enumerate(block.T):
            began = np.flatnonzero(np.append(True, column[1:] != column[:-1]))
            lasts = np.diff(np.append(began, len(column)))
            fresh = (np.arange(len(column)) - np.repeat(began, lasts)) % HELD_ROWS == 0
            total = np.cumsum(column[fresh] / step) + carry[axis]
            whole = np.rint(total)
            counts = np.clip(np.diff(whole, prepend=0.0), -32768, RAIL)
            shaped[at:at + len(block), axis] = counts[np.cumsum(fresh) - 1]
            carry[axis] = total[-1] - whole[-1]
        at += len(block)
    return shaped


def are_whole(values):
    """True where all values are whole numbers."""
    return all(bool((block == np.rint(block)).all()) for block in _blocks(values))


def give_sign(values):
    """"" where whole values (n, 3) have a sign; else it is given to them, in their place, and
    what they were taken for is answered: of both ways the one with the smaller values."""
    if values.min() < 0 or not RAIL + 1 < values.max() <= 65535 or not are_whole(values):
        return ""
    wrapped = sum(np.abs(np.where(b > RAIL, b - 65536, b)).sum() for b in _blocks(values))
    centred = sum(np.abs(b - 32768).sum() for b in _blocks(values))
    if wrapped <= centred:
        values[values > RAIL] -= 65536
        return "two's complement of 16 bits"
    values -= 32768
    return "offset by 32768, which is 0"


def common_step(counts):
    """The largest whole number every count is a multiple of (4: two low bits never move)."""
    step = 0
    for first in range(0, len(counts), 1 << 16):
        some = counts[first:first + (1 << 16)].astype(np.int64)
        step = int(np.gcd(step, np.gcd.reduce(np.abs(some).ravel())))
        if step == 1:
            break
    return step or 1
