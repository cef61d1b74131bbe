"""Bytes put together wrongly: a sign that is not extended, a low byte with a sign of its own,
bytes in the other order.

Each fault is a rule that takes true counts to those that were read, and has one that takes them
back. Counts that were taken back rightly are told by those before them: they go on from them, or
stay about one level. The likelihood is that of what remains unforeseen, a Student's t of its own
width with leaps of any size and share; counts taken back have it in the same family of foresights
as the counts as they were read (course_likelihood.py).
"""
import copy
import math
from functools import partial

import numpy as np
from scipy import ndimage

from ... import side_by_side
from ...capture import registers
from ...capture.registers import RAIL, SENSORS
from . import course_likelihood
from .detection import Damage, present

FEWEST = 50  # samples, of which a width, its tails and a share of leaps are told
FEWEST_CHANGED = 8  # steps that a rule must change: a recording whose moves were cut out leaps
# Nats a sample by which a rule's coarse likelihood may be behind that of the counts as read: the
# finer foresight, which is tried then, gains less. It saves time and decides nothing else.
HOPELESS = 0.05
LONGEST = 200_000  # samples that are looked at: half an hour at 100 Hz
WIDTHS = range(8, 16)  # bits of a reading whose sign may be lost: a byte, to all but one of 16
BESIDE = 500  # samples around one that a rule changes, of which what is usual there is told
AROUND = (3, 9, 33)  # samples around one whose level tells its lost high byte: fast, slow, still


def _unsigned(bits):
    """Numbers of so many bits whose sign bit was not carried on: y = x mod 2^bits."""
    def back(y):
        return np.where(y >= 1 << (bits - 1), y - (1 << bits), y)
    return ("sign_extension", "negative readings lost their sign: they are %d too large, as "
            "%d-bit numbers are whose sign is not extended" % (1 << bits, bits), back,
            lambda y: y.min() >= 0 and y.max() < 1 << bits)


def _folded(bits):
    """Numbers cut to so many bits with a sign: they go on at the other end."""
    def back(y):
        return _likeliest([_unfolded(y, 1 << bits), _about_level(y, 1 << bits)], y)
    half = 1 << (bits - 1)
    return ("sign_extension", "what exceeds %d goes on at %d: readings are cut to %d bits" % (
        half - 1, -half, bits), back, lambda y: y.min() >= -half and y.max() < half)


def _low_added(y):
    """The low byte had a sign when it was added: 256 are missing where it is 128 or more."""
    return np.where(y & 255 >= 128, y + 256, y)


def _low_or(y):
    """The low byte had a sign when the high one was or-ed to it: where it is 128 or more, the
    high one is lost; it is the one that goes on from the samples around."""
    lost = _low_lost(y)
    if lost.all():
        return y
    tried = [_carried(y, lost)]
    for width in AROUND:
        level = _level_of_low(y, lost, width)
        tried.append(np.where(lost, y + 256 * np.rint((level - y) / 256.0).astype(np.int64), y))
    return _likeliest(tried, y)


def _level_of_low(y, lost, width):
    """Level (n,) around each sample: within a page as the low bytes tell, which all samples have;
    the page as the high bytes do that were not lost."""
    turn = 2.0 * np.pi / 256.0
    inside = np.arctan2(*(ndimage.uniform_filter1d(part(turn * (y & 255)), width)
                          for part in (np.sin, np.cos))) / turn
    known = np.flatnonzero(~lost)
    pages = np.rint((y[known] - inside[known]) / 256.0)
    # From one known sample to the next the level goes on, over the edge of a page where it must.
    low = np.interp(np.arange(len(y)), known, inside[known] + 256.0 * ndimage.median_filter(
        pages, min(width, len(known)), mode="nearest"))
    return inside + 256.0 * np.rint((low - inside) / 256.0)


def _low_lost(y):
    return y & 255 >= 128


def _carried(y, lost):
    """y with the lost high bytes that bring each sample nearest to the one before, or after where
    one that has them is nearer there."""
    known = np.flatnonzero(~lost)
    after = np.minimum(np.searchsorted(known, np.arange(len(y))), len(known) - 1)
    far = np.abs(known[after] - np.arange(len(y))) > np.abs(
        np.arange(len(y)) - known[np.maximum(after - 1, 0)])
    return np.where(far, _onward(y, lost), _onward(y[::-1], lost[::-1])[::-1])


def _onward(y, lost):
    counts, level = y.tolist(), 0
    for k, alone in enumerate(lost.tolist()):
        if alone:
            counts[k] += 256 * round((level - counts[k]) / 256)
        level = counts[k]
    return np.array(counts, np.int64)


def _or_ed(y):
    lost = y[_low_lost(y)]
    return len(lost) > 0 and lost.min() >= -128 and lost.max() < 0 and np.ptp(y) > 256


def _swapped(y):
    """High and low byte exchanged."""
    both = ((y & 255) << 8) | ((y >> 8) & 255)
    return np.where(both >= 1 << 15, both - (1 << 16), both)


def _magnitude(y):
    """A sign bit with a magnitude, read as two's complement."""
    return np.where(y < 0, -(y + (1 << 15)), y)


def _told(x, y):
    """(n - 2,) whether a rule that takes y to x changed a step to a sample or to the one before.
    The others go on alike in both, those that are mirrored too: that a width or a foresight which
    suits the moves better suits the rests less says nothing about bytes."""
    before, after = np.diff(y), np.diff(x)
    same, mirrored = after == before, after == -before
    return ~((same[1:] & same[:-1]) | (mirrored[1:] & mirrored[:-1]))


def _unfolded(y, size):
    """y that goes on from each sample to the next by less than half of `size`."""
    step = np.diff(y)
    return y + size * np.concatenate([[0], np.cumsum(-np.rint(step / size))]).astype(np.int64)


def _about_level(y, size):
    """y within half of `size` of one level, that which most are near on the circle."""
    turn = 2.0 * np.pi / size
    level = np.angle(np.exp(1j * turn * y).mean()) / turn
    return y + size * np.rint((level - y) / size).astype(np.int64)


def _likeliest(tried, y):
    """Of columns that y may have been, the likeliest; y where all of them are y."""
    tried = [x for x in tried if (x != y).any()]
    if len(tried) < 2:
        return tried[0] if tried else y
    return max(tried, key=lambda x: course_likelihood.fit(x).log)


RULES = [
    ("sign_extension", "the low byte has a sign of its own: readings are 256 too small where it "
     "is 128 or more", _low_added, lambda y: True),
    ("sign_extension", "the low byte has a sign of its own and wipes the high one out where it "
     "is 128 or more; it is put back by the samples around, and wrong by 256 where they leave it "
     "open", _low_or, _or_ed),
    ("byte_order", "high and low byte are exchanged", _swapped, lambda y: True),
    ("sign_extension", "negative readings are a sign and a magnitude, and were read as two's "
     "complement", _magnitude, lambda y: y.min() < 0),
    *[_unsigned(bits) for bits in WIDTHS], *[_folded(bits) for bits in WIDTHS]]


def repaired(captures, processors=1):
    """([(name, Capture)] with the bytes put right, [Damage]): a recording is looked at further as
    it was meant. The captures given are not changed; processors: that captures share."""
    mended = side_by_side.results([partial(_mended, capture) for _, capture in captures],
                                  processors)
    faults = {}
    for fault, *seen in (one for _, found in mended for one in found):
        faults.setdefault(fault, []).append(seen)
    return [(name, capture) for (name, _), (capture, _) in zip(captures, mended)], [
        Damage(kind, sensor, axes, "amplitude", "the %s of the %s: %s" % (
            ", ".join(axes) + (" axes" if len(axes) > 1 else " axis"), SENSORS[sensor], words),
            sum(nats for _, nats in seen))
        for (kind, sensor, words), seen in faults.items()
        for axes in [tuple(sorted({letter for letter, _ in seen}))]]


def _mended(capture):
    """(Capture with the bytes put right, [((kind, sensor, words), axis letter, nats)])."""
    mended, found = copy.copy(capture), []
    for sensor in ("accel", "gyro"):
        counts = getattr(capture, sensor)
        known = counts is not None and registers.own_counts(capture, sensor)
        for axis in range(3 if known else 0):
            fault = column_fault(counts[:, axis].astype(np.int64))
            if fault is None:
                continue
            kind, words, back, nats = fault
            found.append(((kind, sensor, words), "xyz"[axis], nats))
            values = np.array(getattr(mended, sensor))
            values[:, axis] = np.clip(back(counts[:, axis].astype(np.int64)), -RAIL - 1, RAIL)
            setattr(mended, sensor, values)
    return mended, found


def column_fault(counts):
    """(kind, words, rule that takes counts back, nats) of the fault of a column (n,) of int64, or
    None."""
    y = counts[:LONGEST]
    if len(y) < FEWEST:
        return None
    rails = np.abs(y) >= RAIL - 3
    seen = np.concatenate([[True], ~(rails[1:] & rails[:-1])])  # rail to rail is no rule of bytes
    best, least = None, course_likelihood.coarse(y) - HOPELESS * len(y)
    for kind, words, back, possible in RULES:
        if not possible(y):
            continue
        x = back(y)
        moved = np.count_nonzero((np.abs(np.diff(x)) != np.abs(np.diff(y)))[seen[1:]])
        if moved < FEWEST_CHANGED:
            continue
        if back is not _low_or and course_likelihood.coarse(x) < least:
            continue
        lost = _low_lost(y) if back is _low_or else None
        likelihood = course_likelihood.fit(x, seen, lost).log
        if best is None or likelihood > best[0]:
            best = likelihood, (kind, words, back), moved, (x, y, seen, lost)
    if best is None:
        return None
    _, fault, moved, columns = best
    score = course_likelihood.score(_gains(*columns), moved) - math.log(len(RULES))
    return (*fault, score) if present(score) else None


def _gains(x, y, seen, lost):
    """Nats of each of the samples seen for a rule which takes y to x: none of those that go on
    alike in both, and of the others by what suits them and those around them best in each. What
    suits the moves says nothing of the rests, nor the other way round; and what suits x may suit y
    better, too, where the samples that the rule changes are asked alone."""
    told = np.append([False, False], _told(x, y))
    asked = seen & ndimage.maximum_filter1d(told, BESIDE)
    counted = told[2:][asked[2:]]
    after = course_likelihood.fit(x, asked, lost)
    before = max((course_likelihood.fit(y, asked, as_=as_) for as_ in (None, after)),
                 key=lambda found: found.each[counted].sum())
    gains = np.zeros(len(x))
    gains[np.flatnonzero(asked[2:]) + 2] = np.where(counted, after.each - before.each, 0.0)
    return gains[2:][seen[2:]]
