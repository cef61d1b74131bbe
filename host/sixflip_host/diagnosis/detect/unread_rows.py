"""Rows that nobody read: a sensor's three axes give one and the same code at once.

A driver that gets no answer writes 0, or -1, which a bus reads where nothing pulls it down; a chip
that has measured nothing yet gives the code that its registers begin with (ICM-42688-P, DS-000347,
register 1Fh: -32768); who lays logs of several sensors onto one clock fills up with 0. Such a row
is told from a reading by two things together: the sensor leaps there, and back where it goes on,
further than it ever goes from a row to the next, and each of its axes hardly ever gives a code as
often as all three would have to. What rests at 0 (with codes as coarse as its noise, within a dead
band, or in a simulator without noise) comes there by and by, or gives 0 on single axes as well.
Where the code of what was not read is known, rows in which a single axis leaps to it were read in
part only.
"""
import itertools
import math

import numpy as np
from scipy import ndimage

from ...capture.registers import SENSORS
from .. import odds
from .detection import Damage
from .held_values import NOT_READ, without_rows
from .stuck_axes import FEWEST

AXES = 3  # each of which may be the one that leaps


def as_read(captures):
    """([(name, Capture)] without the rows that nobody read of one of their sensors, [Damage]). The
    captures given are not changed."""
    found = [{sensor: _unread(getattr(capture, sensor)) for sensor in SENSORS
              if getattr(capture, sensor) is not None} for _, capture in captures]
    read = []
    for (name, capture), by_sensor in zip(captures, found):
        rows = np.unique(np.concatenate([rows for _, rows, _ in by_sensor.values()]))
        read.append((name, without_rows(capture, rows) if len(rows) else capture))
    total = sum(len(capture) for _, capture in captures)
    damages = [_damage(sensor, [one[sensor] for one in found if sensor in one], total)
               for sensor in SENSORS]
    return read, [damage for damage in damages if damage]


def _damage(sensor, found, total):
    """Damage of a sensor by [(nats, rows, codes)] of each capture, None where all were read."""
    number = sum(len(rows) for _, rows, _ in found)
    if not number:
        return None
    codes = " or ".join(str(code) for code in sorted({c for *_, codes in found for c in codes}))
    said = "%d rows (%.2g %%) of the %s were not read, and hold the code %s instead" % (
        number, 100.0 * number / total, SENSORS[sensor], codes)
    return Damage(NOT_READ, sensor, (), "timing", said, sum(nats for nats, *_ in found),
                  {"rows": number})


def nobody_read(counts):
    """(k,) rows of counts (n, 3) that nobody read."""
    return _unread(counts)[1]


def _unread(counts):
    """(nats of rows of counts (n, 3) not having been read over their being readings, (k,) rows,
    their codes)."""
    x = counts.astype(np.int64)
    alike = (x == x[:, :1]).all(axis=1)
    steps = np.sort(np.abs(np.diff(x, axis=0))[~alike[1:] & ~alike[:-1]], axis=0)
    if not alike.any() or len(steps) < FEWEST:
        return 0.0, np.zeros(0, dtype=int), []
    new = (x[1:] != x[:-1]).any(axis=1)
    first = np.flatnonzero(alike & np.append(True, new))
    after = np.flatnonzero(alike & np.append(new, True)) + 1
    code = x[first, 0]
    chance, begins = _leap(x, code, first - 1, -1, steps)
    chance_back, ends = _leap(x, code, after, 1, steps)
    chance = np.maximum(chance, chance_back)
    nats = -np.log(chance) - _log_of_codes(x[~alike], code) - math.log(len(code))
    unread = (chance <= odds.CHANCE) & (nats >= odds.COST + odds.PRESENT)
    # A knock may drive all axes to one end; before the first reading nothing has knocked.
    unread &= (np.abs(code) < np.abs(x).max() - 1) | (first == 0)
    rows = [np.arange(a - early, b + late) for a, b, early, late in zip(
        first[unread], after[unread], begins[unread], ends[unread])]
    codes = np.unique(code[unread]).tolist()
    rows.append(_in_part(x, codes))
    return (float(nats[unread].sum()), np.unique(np.concatenate([np.zeros(0, dtype=int), *rows])),
            codes)


def _in_part(x, codes):
    """(k,) rows of x (n, 3) in which an axis gives one of the codes of what was not read and leaps
    there and back, as where a bus stops in the middle of a row."""
    read = ~np.isin(x, codes).any(axis=1)
    steps = np.sort(np.abs(np.diff(x, axis=0))[read[1:] & read[:-1]], axis=0)
    rows = []
    for axis, code in itertools.product(range(AXES), codes):
        column = x[:, axis]
        for run, in ndimage.find_objects(ndimage.label(column == code)[0]):
            beside = column[[k for k in (run.start - 1, run.stop) if 0 <= k < len(column)]]
            leaps = np.zeros((len(beside), AXES), np.int64)
            leaps[:, axis] = np.abs(beside - code)
            if len(beside) == 2 and (_rare(leaps, steps) <= odds.CHANCE).all():
                rows += range(run.start, run.stop)
    return np.array(rows, dtype=int)


def _leap(x, code, beside, way, steps):
    """((k,) chance that a sensor goes from one row to the next as far as between the rows `beside`
    k runs and the code there, on the axis that goes furthest; (k,) True where that row is on the
    way itself, as who fills in draws a line). 1 over all steps where the log ends with the run:
    what is not there says nothing. x (n, 3); way: -1 before the runs, 1 after them; steps sorted
    (m, 3)."""
    inside = (beside >= 0) & (beside < len(x))
    near, far = (x[np.clip(row, 0, len(x) - 1)] for row in (beside, beside + way))
    code = code[:, None]
    leap, more = np.abs(near - code), np.abs(far - near)
    on_way = ((near >= np.minimum(code, far)) & (near <= np.maximum(code, far))).all(axis=1)
    on_way &= inside & (_rare(more, steps) <= odds.CHANCE)
    chance = _rare(np.where(on_way[:, None], np.maximum(leap, more), leap), steps)
    return np.where(inside, chance, AXES / (len(steps) + 2.0)), on_way


def _rare(leaps, steps):
    """(k,) chance of leaps (k, 3) by how many of the steps, sorted (m, 3), go as far."""
    further = np.array([len(steps) - np.searchsorted(steps[:, axis], leaps[:, axis])
                        for axis in range(AXES)])
    return np.minimum(AXES * (further.min(axis=0) + 1.0) / (len(steps) + 2.0), 1.0)


def _log_of_codes(others, code):
    """(k,) log of the chance that all axes give these codes at once, by how often the rows that
    differ, others (n, 3), give them, or the commonest that they give: what may rest anywhere."""
    log = np.zeros(len(code))
    for column in others.T:
        values, times = np.unique(column, return_counts=True)
        place = np.minimum(np.searchsorted(values, code), len(values) - 1)
        often = np.where(values[place] == code, times[place], 0)
        log += np.log((np.maximum(often, times.max()) + 1.0) / (len(column) + 2.0))
    return log
