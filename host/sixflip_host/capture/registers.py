"""Columns of counts: what one stands for, steps, a band that reads nothing, bits and columns that
stick."""
import math

import numpy as np

from sixflip import RAIL

SENSORS = {"accel": "accelerometer", "gyro": "gyro"}  # in words
RANGES = {"accel": "accel_range_g", "gyro": "gyro_range_dps"}  # of a capture's header
SCALES = {"accel": "accel_lsb_per_g", "gyro": "gyro_lsb_per_dps"}
UNITS = {"accel": "g", "gyro": "deg/s"}  # of ranges and scales
RAIL_CODES = 4  # the last codes of a range: scales that are rounded end a few short of 2^15
FEWEST_VALUES = 12  # distinct counts before a common divisor means anything
# Fewer tell one that is wide enough: each value beyond the first has a chance of one in the step,
# for as many nats as hold a name (detection.present) when the widest of six bits is paid; and
# where noise takes the column from one to the next, not a command from one level to another: 0.19
# of the samples are new in a public log whose z has 7 values 10 counts apart.
FEW_NATS, RESTLESS = 12.5, 0.1
FEWEST_SAMPLES = 50
SPACED = 6  # times the smallest value: as far as the values next to each other are looked at
LOW_BITS = 6  # bits that noise and motion must have moved
MOVED = 4  # times a bit's weight that a column must span to have moved it


def beside(x):
    """(4, n - 4, ...): the two samples before and the two after each of x (n, ...) with both."""
    return np.stack([x[:-4], x[1:-3], x[3:-1], x[4:]])


def unit_of_count(meta, sensor):
    """mg or deg/s of one count of a capture's sensor ("accel", "gyro")."""
    if sensor == "accel":
        return 1000.0 / meta["accel_lsb_per_g"]
    return 1.0 / meta["gyro_lsb_per_dps"]


def codes(column):
    """The different values of a column of 16-bit counts, in order."""
    return np.flatnonzero(np.bincount(column.astype(np.int64) + RAIL + 1)) - RAIL - 1


def steps(counts):
    """(3,) greatest common divisor of the counts' distances; 1 where too few values differ."""
    sizes = []
    for column in counts.T:
        values = codes(column)
        values = values[np.abs(values) < RAIL]  # a rail need not lie on a step
        step = int(np.gcd.reduce(np.diff(values))) if len(values) > 1 else 1
        few = len(values) < FEWEST_VALUES and not _told_by_few(column, len(values), step)
        sizes.append(1 if few else step)
    return np.array(sizes)


def _told_by_few(column, number, step):
    """Whether so few values of a column (n,) tell a step."""
    paid = 1 <= step <= 1 << LOW_BITS  # three levels that lie evenly apart are no steps
    return paid and (number - 1) * math.log(step) > FEW_NATS and np.count_nonzero(
        column[1:] != column[:-1]) > RESTLESS * len(column)


def rail(capture, sensor):
    """Largest size of a count of a capture's sensor ("accel", "gyro"): the end of the range that
    its header states; or, where more samples lie beyond that than at it, the code that most of
    them end at, as where a scale is rounded; or else that of the register: of an LSM6DS3, whose
    8.75 mdps a count are 286 deg/s, the range is 250 by name."""
    stated = _stated(capture.meta, sensor)
    if stated > RAIL:
        return stated
    size = np.abs(getattr(capture, sensor).astype(np.int32))
    beyond = size[size > stated + RAIL_CODES]
    if len(beyond) <= np.count_nonzero(size >= stated - RAIL_CODES) - len(beyond):
        return stated
    last = int(beyond.max())
    return last if (beyond >= last - RAIL_CODES).mean() > 0.5 else RAIL + 1


def end_known(meta, sensor):
    """True when a header tells where a sensor's readings end: an import that is told no range
    scales values so that its counts have nothing to do with a converter's."""
    return "imported_from" not in meta or RANGES[sensor] in meta


def _stated(meta, sensor):
    """Count at the end of the range that a header states, or of the register before that."""
    return int(min(meta.get(RANGES[sensor], np.inf) * meta[SCALES[sensor]], RAIL + 1))


def gyro_railed(capture, first, end):
    """True when a gyro axis reads the end of its range, or of its register, in samples
    first..end-1 of a capture."""
    if capture.gyro is None:
        return False
    peak = np.abs(capture.gyro[first:end].astype(np.int32)).max(initial=0)
    # Where the range ends all of the capture tells, which few moves have to ask.
    return bool(peak >= _stated(capture.meta, "gyro") - 1 and peak >= rail(capture, "gyro") - 1)


def spacing(size, least):
    """Usual distance of the values next to each other among sizes (n,) of codes from `least` to
    SPACED times that: what a column counts in where a file's decimals, a factor or few samples
    leave codes out that have no common divisor."""
    values = np.unique(size[(size >= least) & (size <= SPACED * least)])
    return float(np.median(np.diff(values))) if len(values) > 2 else float(least)


FEWEST_ZEROS, FEWEST_MISSING = 20, 40  # readings of 0 that are a band; of the codes within it


def _holes(column, least, step):
    """Whether codes are missing beyond `least` as well, up to three times as far from 0 on either
    side: then what left out the one next to 0 is a scale that was rounded."""
    column = column.astype(np.int64)
    return any((np.diff(np.unique(side[(side >= least) & (side <= 3 * least)])) > step).any()
               for side in (column, -column))


def number_of_runs(mask):
    """Number of unbroken runs of True."""
    return int(mask[0]) + int((mask[1:] & ~mask[:-1]).sum())


def sign_changes(windows):
    """(n,) how often the signs of the readings that are not 0 change, row by row."""
    sign = np.sign(windows)
    last = np.maximum.accumulate(np.where(sign != 0, np.arange(sign.shape[1]), 0), axis=1)
    held = np.take_along_axis(sign, last, axis=1)
    return (held[:, 1:] * held[:, :-1] < 0).sum(axis=1)


def dead_band(counts):
    """(3,) counts up to which an axis reads 0: the smallest that is not 0, where many more near 0
    were to be expected; 0 where no code is missing."""
    bands = []
    for column in counts.T:
        small = np.abs(column.astype(np.int64))
        zeros, others = int((small == 0).sum()), small[small > 0]
        least = int(others.min()) if len(others) else 0
        if not least:
            bands.append(0)
            continue
        step = max(1, steps(column[:, None])[0], spacing(small, least))
        each = (others < 2 * least).sum() * step / (2.0 * least)  # readings of a code beside it
        missing = 2.0 * (least / step - 1.0)  # codes, for which 0 is read, and for itself
        banded = missing >= 2.0 and missing * each > FEWEST_MISSING and zeros > max(
            FEWEST_ZEROS, 2.0 * each) and (missing > 2.0 or not _holes(column, least, step))
        bands.append(least if banded else 0)
    return np.array(bands)


def own_counts(capture, sensor):
    """Whether a capture's numbers are the chip's own counts: those of a file of decimals that has
    no spacing are the import's, and have no bytes and bits that could be read wrongly."""
    return capture.meta.get(sensor + "_values") != "float"


def of_counts(sessions, sensor):
    """The sessions whose numbers are the chip's own counts."""
    return [s for s in sessions if own_counts(s.capture, sensor)]


def bit_nats(x, bit):
    """Log likelihood ratio (nats) of a bit of a column (n,) that never changes being stuck, over
    the codes read being such as all have it alike. Of two codes next to each other in order, so
    far apart, wherever they lie, the bit is another one as often as its edges lie between them:
    the codes of one rest lie close together and tell little. Which bit it is, is paid."""
    period = 2 << bit
    apart = np.diff(codes(x)) % period
    changes = np.minimum(apart, period - apart) / (1 << bit)
    return float(-np.log1p(-changes).sum()) - math.log(LOW_BITS)


def fixed_bits(x):
    """[(bit, value)] of single low bits of a column (n,) of int64 that never change while those
    around them do, where that is likelier of a bit that is stuck."""
    if len(x) < FEWEST_SAMPLES:
        return []
    ever, always = np.bitwise_or.reduce(x), np.bitwise_and.reduce(x)
    step, bits = max(1, steps(x[:, None])[0]), []
    for bit in range(LOW_BITS):
        weight = 1 << bit
        fixed = not ever & weight or bool(always & weight)
        if fixed and step < 2 * weight and np.ptp(x) > MOVED * weight * 2 \
                and bit_nats(x, bit) > 0.0:
            bits.append((bit, int(bool(always & weight))))
    return bits


def stuck_bits(sessions):
    """[(sensor, axis, bit, value, nats)] of single low bits that never change while those around
    them do (bits stuck from the lowest on are steps, see quantisation)."""
    bits = []
    for sensor in ("accel", "gyro"):
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        counted = of_counts(sessions, sensor)
        for i in range(3 if counted else 0):
            x = np.concatenate([getattr(s.capture, sensor)[:, i] for s in counted]).astype(
                np.int64)
            bits += [(sensor, "xyz"[i], bit, value, bit_nats(x, bit))
                     for bit, value in fixed_bits(x)]
    return bits


def _others_tell(steps):
    """Whether all axes that ever change do so from many samples to the next; steps (n, 3)."""
    changes = (steps != 0).mean(axis=0)
    return bool((changes[changes > 0.0] > 0.3).all())


def stuck(sessions):
    """Sentences on columns that never change while the sensor's others do: where their steps are
    wider than the noise, an axis that nobody turned reads one value."""
    said = []
    for sensor, words in SENSORS.items():
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None for c in columns):
            continue
        for i in range(3):
            if any(len(c) >= FEWEST_SAMPLES and np.ptp(c[:, i].astype(int)) == 0
                   and _others_tell(np.diff(c.astype(int), axis=0)) for c in columns):
                said.append("the %s axis of the %s never changes: it is stuck" % ("xyz"[i], words))
    return said
