"""One axis that keeps its value while the others of its sensor change is stuck, or is read faster
than it measures; how often a code is read once more by chance."""
import math

import numpy as np

from ...capture.registers import SENSORS, steps
from .detection import Damage, present

FEWEST = 200  # rows of a capture
AGAIN = 3  # repeats on end
# Rows of a window; share of the windows that are the quietest, in which a sensor rests; counts of
# noise from which on a code is read less than three times in four.
WINDOW, QUIETEST, LEAST_NOISE = 64, 0.1, 0.5
# Of a third repeat being followed by another at least: noise that comes and goes from row to row,
# in the quiet of which half of them are (the rests of imucal_ferraris).
BY_CHANCE = 0.6
ORDERS = (1, 2, 3, 4)  # of differences
# Of an axis that gives each value the same number of times: share of its values, where a log that
# is read at random times has 0.25 of them twice at the most and recordings to 0.3; counts that it
# changes by, where half of the changes of what creeps are of a count, at times that look even.
EQUAL, FAR = 0.6, 3.0
NEAR_END = 0.97  # of the largest reading: beyond it a soft limit keeps a reading as well


def stuck_for_a_while(sessions, coarse=()):
    """[Damage] of single axes that keep a value while others of their sensor change; coarse:
    (sensor, axis letter) of those whose codes are few.

    Whatever it measures, noise of s counts lets no code be read more often than a normal density
    of that width has room for: a value that was read AGAIN times on end is read once more with
    that chance.
    """
    damages = []
    for sensor, words in SENSORS.items():
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None or len(c) < FEWEST for c in columns):
            continue
        for axis in range(3):
            if (sensor, "xyz"[axis]) in coarse:
                continue
            nats, longest = 0.0, 0
            for counts in columns:
                more, rows = _kept(counts, axis)
                nats, longest = nats + more, max(longest, rows)
            if present(nats):
                letter = "xyz"[axis]
                said = ("the %s axis of the %s keeps its value for up to %d rows while the others "
                        "change") % (letter, words, longest + 1)
                damages.append(Damage("repeats", sensor, (letter,), "timing", said, nats,
                                      {"rows": longest + 1}))
    return damages


def read_slower(sessions):
    """[Damage] of single axes that give each value the same number of times, which the others do
    not. By chance, whatever it is and however it comes and goes, a value stays for k rows with
    p^(k - 1) (1 - p), which is (1 - 1/k)^(k - 1) / k at the most; of a rate of its own an axis
    has nearly all its values for k."""
    damages = []
    for sensor, words in SENSORS.items():
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None or len(c) < FEWEST for c in columns):
            continue
        for axis, letter in enumerate("xyz"):
            stays, far = (np.concatenate(v) for v in zip(*(_stays(c, axis) for c in columns)))
            if len(stays) < FEWEST or np.median(far) < FAR:
                continue
            times = int(np.median(stays))
            equal, number = int((stays == times).sum()), len(stays)
            if times < 2 or equal < EQUAL * number:
                continue
            chance, share = (1.0 - 1.0 / times) ** (times - 1) / times, equal / (number + 1.0)
            nats = equal * math.log(share / chance) + (number - equal) * math.log(
                (1.0 - share) / (1.0 - chance)) - 0.5 * math.log(number)
            if present(nats):
                said = ("the %s axis of the %s gives each value %d times, the others do not: it "
                        "is measured less often") % (letter, words, times)
                damages.append(Damage("repeats", sensor, (letter,), "timing", said, nats,
                                      {"times": times}))
    return damages


def _stays(counts, axis):
    """(rows (k,) that an axis of counts (n, 3) keeps each value, counts (k,) that it changes by
    then), of the rows in which an axis changes."""
    fresh = counts[np.append(True, (counts[1:] != counts[:-1]).any(axis=1))].astype(np.int64)
    steps_away = np.diff(fresh[:, axis]) / max(int(steps(counts)[axis]), 1)
    changes = np.flatnonzero(steps_away)
    return np.diff(changes), np.abs(steps_away[changes[1:]])


def _kept(counts, axis):
    """(nats, length of the longest run of repeats) of an axis of counts (n, 3)."""
    column, step = counts[:, axis].astype(np.int64), max(int(steps(counts)[axis]), 1)
    noise = unforeseen(column / step)
    chance = by_chance(noise)
    held = _held(counts, axis)
    before = np.flatnonzero(np.convolve(held, np.ones(AGAIN), "valid") == AGAIN) + AGAIN
    before = before[before < len(held)]
    again, number = int(held[before].sum()), len(before)
    if noise < LEAST_NOISE or again <= chance * number:
        return 0.0, 0
    share = min(again / number, 1.0 - 1.0 / (number + 1.0))
    nats = again * math.log(share / chance) + (number - again) * math.log(
        (1.0 - share) / (1.0 - chance)) - 0.5 * math.log(number)
    return nats, int(lengths(held).max())


def _held(counts, axis):
    """(n - 1,) which of the rows of counts (n, 3) after the first have an axis as the row before
    and not all others. What a dead band or a rail holds is theirs, and so is a code that an axis
    comes to rest at again and again, as one does that is gated about its bias; where all axes
    repeat no row was read."""
    column, same = counts[:, axis].astype(np.int64), counts[1:] == counts[:-1]
    first = np.flatnonzero(np.append(True, ~same[:, axis]))
    long = column[first[np.diff(np.append(first, len(column))) >= WINDOW]]
    gates, times = np.unique(long, return_counts=True)
    return same[:, axis] & ~same.all(axis=1) & (column[1:] != 0) & (
        np.abs(column[1:]) < NEAR_END * np.abs(column).max()) & ~np.isin(
            column[1:], gates[times > 1])


def stuck_rows(session, damages):
    """(n,) rows of a Session in which an axis that is stuck by one of damages keeps its value."""
    return np.any([lengths(np.append(False, _held(
        getattr(session.capture, damage.sensor), "xyz".index(letter)))) >= AGAIN
        for damage in damages for letter in damage.axes], axis=0)


def unforeseen(x, still=False):
    """Counts: standard deviation of what the samples before do not foretell of a column (n,) where
    it is the quietest. White noise has the same in differences of every order, over the root of
    the sum of their weights' squares; what a filter leaves of it has less, and rounding adds its
    own. still: where it never changes it has no noise, and is not stuck there."""
    variances = []
    for order in ORDERS:
        left = np.diff(x, n=order)
        windows = left[:len(left) // WINDOW * WINDOW].reshape(-1, WINDOW)
        power = (windows ** 2).mean(axis=1)
        if not still:  # what never changes is stuck there, or has no noise anywhere
            power = power[power > 0.0]
        variances.append(float(np.quantile(power, QUIETEST)) / math.comb(2 * order, order)
                         if len(power) else 0.0)
    return math.sqrt(max(min(variances) - 1.0 / 12.0, 0.0))


def by_chance(noise):
    """Chance that a code is read once more where the noise is so many counts."""
    return max(math.erf(0.5 / max(noise, 1e-9) / math.sqrt(2.0)), BY_CHANCE)


def lengths(rows):
    """(n,) the length of the unbroken run of rows (n,) bool that each is in; 0 outside of them."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], rows, [False]])))
    lengths = np.zeros(len(rows), dtype=int)
    lengths[rows] = np.repeat(edges[1::2] - edges[::2], edges[1::2] - edges[::2])
    return lengths
