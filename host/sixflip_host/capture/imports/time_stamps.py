"""The times in somebody's table: their unit told by plausibility, put in order, made
microseconds."""

from typing import NamedTuple

import numpy as np

from ...errors import BadFile
from .. import stamp_envelope
from .column_vocabulary import COUNTED, TICKS, TIME_UNITS

# When a stamp counts from 1970 it lies between 2001 and 2065 in one unit only.
EPOCH_S = (1e9, 3e9)
USUAL_HZ = (15.0, 4000.0)       # of an IMU's log; a factor below 1000, so that one unit fits
POSSIBLE_HZ = (0.5, 8000.0)
# The fastest that a log of a moment comes at as often as one of a row a second comes with decimals
# [LSM6DSO, DocID030463 rev 2, table 52: 1.66 kHz; most parts end at 1 or 1.6].
MOMENT_HZ = 1700.0
SHORTEST_S = 1.0                # of a log that somebody keeps: no rest is found in less
MOST_C_PER_S = 10.0             # no chip's temperature changes faster
LATEST_US = 1e16                # three centuries: what times in the wrong unit pass
FAR_ROWS = 3                    # so few rows behind a gap that is longer than all the rest
# Where counters begin anew: at 16 to 32 bits, after the second of a fraction, after a day.
COUNTERS = (2.0 ** 16, 2.0 ** 24, 2.0 ** 32, 1e3, 1e6, 1e9, 86400.0)
LONGEST_STEPS = 50.0            # usual intervals that may be missing where a counter begins anew
TIMES_STATED = 2.0              # a rate that was set may be that far off, rows left out
FEWEST_STEPS = 3                # new stamps that show a grid
FEWEST_SHARED = 2               # rows of a stamp, usually: with fewer clock.measure sees the rest
SPAN = 20                       # rows over which intervals are averaged


def unit_of(path, column, times, celsius=None):
    """(unit, sentence) of a column of times; BadFile asking for it where two units would do. What
    its maker is known to count under its name is all that it may be.

    times float (n,), in order or nearly so; celsius (n,) or None: temperatures beside them.
    """
    usual = _usual(times)
    if not usual > 0:
        raise BadFile("%s: %s stands still, expected times that run, or --rate HZ" % (
            path, column))
    scales = COUNTED.get(column.lower(), TIME_UNITS)
    rates = {unit: 1e6 / (usual * us) for unit, us in scales.items()}
    first = abs(float(times[0]))
    epochs = [unit for unit, us in scales.items()
              if EPOCH_S[0] < first * us / 1e6 < EPOCH_S[1] and _within(rates[unit], 1e-3, 1e5)]
    if len(epochs) == 1:
        return epochs[0], "%s counts %s from 1970" % (column, epochs[0])
    if usual == 1.0 and (np.diff(times[:1000]) == 1.0).all():
        raise BadFile("%s: %s counts by 1, which may be samples, expected --time-unit samples "
                      "with --rate HZ, or --time-unit ms" % (path, column))
    units = [unit for unit in scales if celsius is None
             or _warming(times, celsius, scales[unit]) < MOST_C_PER_S]
    seconds = {unit: float(times[-1] - times[0]) * us / 1e6 for unit, us in scales.items()}
    usually = [unit for unit in units if _within(rates[unit], *USUAL_HZ)]
    possible = [unit for unit in units if _within(rates[unit], *POSSIBLE_HZ)]
    likely = [unit for unit in usually if seconds[unit] >= SHORTEST_S]
    if not likely:
        parts = bool((times[:1000] != np.rint(times[:1000])).any())
        likely = usually or possible
        if parts and "s" in possible:
            likely = ["s", *(unit for unit in usually
                             if unit != "s" and rates[unit] <= MOMENT_HZ)]
    readings = {unit: "%s (%.4g Hz, %.3g s)" % (unit, rates[unit], seconds[unit])
                for unit in scales}
    if len(likely) != 1:
        raise BadFile("%s: %s goes on by %.6g, expected --time-unit with one of %s" % (
            path, column, usual, ", ".join(readings[unit] for unit in likely or scales)))
    others = [readings[unit] for unit in possible if unit != likely[0]]
    return likely[0], "%s taken as %s: %.4g Hz%s" % (
        column, likely[0], rates[likely[0]], ", %.3g s; --time-unit if it is %s" % (
            seconds[likely[0]], " or ".join(others)) if others else "")


def check_named(path, column, times, unit):
    """A sentence on times whose unit, by their column's name, makes a log of rows far apart, where
    another unit's are as usual, or ""; BadFile where it makes one faster than any."""
    usual = _usual(times)
    if not usual > 0 or unit not in TIME_UNITS:
        return ""
    rate = 1e6 / (usual * TIME_UNITS[unit])
    others = " or ".join("%s (%.4g Hz)" % (other, 1e6 / (usual * us))
                         for other, us in TIME_UNITS.items()
                         if other != unit and _within(1e6 / (usual * us), *USUAL_HZ))
    if rate > POSSIBLE_HZ[1]:
        raise BadFile("%s: %s goes on by %.6g, which is %.6g Hz in %s as its name says, expected "
                      "less than %g Hz: --time-unit %s, or %s if that is right" % (
                          path, column, usual, rate, unit, POSSIBLE_HZ[1], others or "for another",
                          unit))
    return "%s taken as %s, as its name says: %.4g Hz; --time-unit if it is %s" % (
        column, unit, rate, others) if rate < POSSIBLE_HZ[0] and others else ""


def check_stated(path, words, times, unit, stated):
    """BadFile where the rate in a unit that was told is far from the one that the file states
    (Hz, or None)."""
    rate = 1e6 / (_usual(times) * (TIME_UNITS | TICKS)[unit])
    if stated is not None and not _within(rate / stated, 1.0 / TIMES_STATED, TIMES_STATED):
        raise BadFile("%s: %s, but the file says %.6g Hz, expected --time-unit, or --rate HZ" % (
            path, words, stated))


def _within(value, low, high):
    return low <= value <= high


def _usual(times):
    """The usual interval, over spans of rows where there are enough: stamps come in bursts."""
    span = min(SPAN, len(times) - 1)
    if span < 1:
        return 0.0
    return float(np.median(times[span:] - times[:-span])) / span


def _warming(times, celsius, us):
    """The fastest change of the temperature between tenths of the file, °C/s; us: of a time."""
    edges = np.linspace(0, len(times) - 1, 11).astype(int)
    seconds = np.diff(times[edges]) * us / 1e6
    return float(np.max(np.abs(np.diff(celsius[edges])) / np.maximum(seconds, 1e-12)))


def unwrapped(times):
    """(times that go on where a counter began anew, numbers of the rows that it did at, its size
    or 0). A counter is as wide as its values say, or a day of seconds long: it begins anew where
    one step back is no longer than usual once its size is added."""
    back = np.flatnonzero(np.diff(times) < 0.0) + 1
    usual = _usual(times)
    if not len(back) or not usual > 0.0:
        return times, back[:0], 0.0
    for size in COUNTERS:
        steps = times[back] - times[back - 1] + size
        first = -size / 2.0 if times.min() < 0.0 else 0.0   # with a sign, or without one
        if first <= times.min() and times.max() < first + size and (
                (steps >= 0.0) & (steps <= LONGEST_STEPS * usual)).all():
            turns = np.zeros(len(times))
            turns[back] = size
            return times + np.cumsum(turns), back, size
    return times, back[:0], 0.0


def sorted_order(times):
    """(order that puts times in order or None, rows that are moved, the farthest way in rows)."""
    if not (np.diff(times) < 0).any():
        return None, 0, 0
    order = np.argsort(times, kind="stable")
    way = np.abs(order - np.arange(len(order)))
    late = times < np.maximum.accumulate(times)     # rows that stand behind a later one
    return order, int(late.sum()), int(way.max())


def check_stretch(path, column, times, scale_us, line_of):
    """BadFile for a few stamps so far away that most of the log would be a gap.

    times float (n,) in order; scale_us: microseconds of one; line_of(index): line in the file.
    """
    if len(times) < 10 * FAR_ROWS:
        return
    for some, far in ((times[::-1], -1), (times, 1)):
        gaps = np.abs(np.diff(some[:FAR_ROWS + 1]))
        rest = abs(float(some[-1] - some[FAR_ROWS]))
        worst = int(np.argmax(gaps))
        if gaps[worst] > max(rest, 1e6 / scale_us):
            row = worst if far > 0 else len(times) - 1 - worst
            raise BadFile.at(path, line_of(row), "%s is %.17g, which stretches %.4g s to %.4g s"
                             % (column, times[row], rest * scale_us / 1e6,
                                float(times[-1] - times[0]) * scale_us / 1e6),
                             "a stamp near the others; leave that row out")


def microseconds(path, column, times, scale_us, unit):
    """int64 microseconds from the first time on, in the memory of the times."""
    times -= times.min()
    longest = float(times.max()) * scale_us
    if not longest < LATEST_US:
        raise BadFile("%s: %s spans %.3g s, expected less than %.0g: is --time-unit %s right?" % (
            path, column, longest / 1e6, LATEST_US / 1e6, unit))
    times *= scale_us
    np.rint(times, out=times)
    whole = times.view(np.int64)
    for first in range(0, len(times), 1 << 16):     # the same eight bytes
        some = slice(first, first + (1 << 16))
        whole[some] = times[some].astype(np.int64)
    return whole


class Spread(NamedTuple):
    """t_us int64 (n,): times of rows; step_us: of the stamps that rows shared; rows: that usually
    shared one; between: rows of stamps that are whole, which tell the rate."""

    t_us: np.ndarray
    step_us: float
    rows: int
    between: int


def spread(t_us):
    """The Spread of rows that share their stamps, as those of a second do where a log has whole
    seconds; None where they have their own. (Rows that a link hands over together share one, too,
    but that is on no grid.) Where the recorder stood still, the rows behind have a clock anew."""
    anew = np.flatnonzero(np.diff(t_us)) + 1        # rows with a new stamp
    if len(anew) < FEWEST_STEPS:
        return None
    shared, step = np.diff(anew), stamp_envelope.resolution(t_us)
    usual = int(np.median(shared))
    if usual < FEWEST_SHARED or np.median(np.diff(t_us[anew])) != step:
        return None
    went_on = np.diff(t_us)[anew - 1] == step
    whole = went_on[1:] & went_on[:-1]              # stamps whose rows are all there
    between = int(shared[whole].sum())
    if not between:
        return None
    period, times = step * whole.sum() / between, []
    for rows in np.split(np.arange(len(t_us)), anew[~went_on]):
        new = anew[(anew > rows[0]) & (anew <= rows[-1])]
        times.append(_evenly(rows, new, t_us[new], period) if len(new)
                     else t_us[rows[0]] + (rows - rows[0]) * min(period, step / len(rows)))
    even = np.maximum.accumulate(np.concatenate(times))
    return Spread(np.rint(even - even[0]).astype(np.int64), step, usual, between)


def _evenly(rows, new, stamps, period):
    """Times of rows, by those of them with a new stamp: of an even clock, where they are of one,
    each to a row; else evenly from one to the next."""
    off = stamps - new * period
    if np.ptp(off) <= 2.0 * period:
        return off.mean() + rows * period
    beyond = np.minimum(rows - new[0], 0) + np.maximum(rows - new[-1], 0)
    return np.interp(rows, new, stamps) + beyond * period
