"""Rows out of order: blocks that a chip's FIFO or a driver's buffer hands over in another order
than they were measured in, and runs that were read backwards.

The stamps do not tell, since they are those of the rows as they came. A motion does: where two
blocks were exchanged the readings leap at three places that lie a block apart, and go on smoothly
at all three once the blocks are exchanged again; a run that was reversed leaps at its two ends.
How smoothly they go on is the step over a place less the mean of the steps before and after it,
and its likelihood Student's t of the width that such bends have around there. So a log competes as
it stands with the same log in another order, and noise or shaking, of which no order is smoother
than another, speaks for neither. What was tried is paid: every row where a block may begin, and
every length.
"""
import copy
import math

import numpy as np
from scipy import ndimage

from ...capture.registers import SENSORS
from .. import odds
from .detection import Damage, present

LONGEST = 64  # rows of a block: twice the FIFO of an ADXL345, half of what a driver reads at once
ROWS = 200_000  # that are looked at: half an hour at 100 Hz
# Of Student's t, in which a bend's likelihood falls slowly enough that a knock is no proof; rows
# whose bends tell how wide it is, of which the leaps of a block are few.
FREEDOM, AROUND = 4.0, 41
LEAP = 4.0  # nats beyond the usual of a leap: it is not asked of smaller ones, which tell little
# Nats that a block gains or loses by another order where a motion tells it: as many as one alone
# has to pay among so many rows and orders. Shaking at one frequency makes a block in a thousand
# likelier by up to 15, and as many less likely.
SEEN = odds.COST + odds.PRESENT + math.log(ROWS)
# Correlation of the noise of two bends so many rows apart: of (1, -3, 3, -1) with itself.
IN_COMMON = np.array([20.0, -15.0, 6.0, -1.0]) / 20.0
EXCHANGED, REVERSED = "exchanged", "reversed"


def as_read(captures):
    """([(name, Capture)] with its rows in the order in which they were measured as far as their
    motion tells it, [Damage]). The captures given are not changed."""
    put_right, found = [], []
    for name, capture in captures:
        kind = _best(capture)
        if kind is not None:
            capture = _in_order(capture, *kind[1:5])
            found.append(kind)
        put_right.append((name, capture))
    return put_right, [_damage(*kind) for kind in found[:1]]


def _damage(nats, sensor, way, length, starts, share):
    who = "rows" if sensor == "device" else "rows of the %s" % SENSORS[sensor]
    how = ("runs of %d are in reversed order" % length if way == REVERSED else
           "one is exchanged with the next" if length == 1 else
           "blocks of %d are exchanged with the next %d" % (length, length))
    return Damage("row order", sensor, (), "timing",
                  "%s are out of order, about %.2g %% of them: %s" % (who, 100.0 * share, how),
                  nats, {"rows": len(starts) * length * (1 + (way == EXCHANGED)),
                         "block": length, "share": round(share, 4)})


def _best(capture):
    """(nats, sensor, way, length, (k,) first rows, share of all rows) of the likeliest other order
    of a Capture's rows, None where they are in order."""
    counts = {sensor: getattr(capture, sensor)[:ROWS].astype(float) for sensor in SENSORS
              if getattr(capture, sensor) is not None}
    counts = {sensor: x for sensor, x in counts.items() if len(x) > 4 * LONGEST}
    tried = [(sensor, x, _widths(x)) for sensor, x in counts.items()]
    if len(tried) > 1:
        tried.append(("device", *(np.hstack(each) for each in list(zip(*tried))[1:])))
    tried = [(*each, _far(*each[1:])) for each in tried]
    found = [(*_judged(x, width, far, way, length), sensor, way, length, x, width)
             for sensor, x, width, far in tried for way in (EXCHANGED, REVERSED)
             for length in range(1 if way == EXCHANGED else 3, LONGEST + 1)]
    if not found:
        return None
    nats, starts, sensor, way, length, x, width = max(found, key=lambda f: f[0])
    others = max(len(f[1]) for f in found if f[3:5] != (way, length))
    nats = min(nats, _beyond(len(starts), 1 + others)) - math.log(len(tried))
    if not present(nats):
        return None
    share = _share(x, width, way, length, starts)
    # Now that the habit is known, a block is where it is likelier than not.
    usual = math.log((_places(way, length)[-1] + 1) / share)
    far = next(each[3] for each in tried if each[0] == sensor)
    return nats, sensor, way, length, _judged(x, width, far, way, length, usual)[1], share


def _beyond(number, expected):
    """Nats of so many blocks over those expected, Poisson: knocks and steps of a walk leap there
    and back in any number of rows, and make as many blocks of other lengths."""
    return number * math.log(number / expected) - number + expected if number > expected else 0.0


def _widths(x):
    """(n, c) width of the bends around each row of x (n, c)."""
    bends = np.abs(_bends(x, np.arange(len(x)), None))
    width = np.stack([ndimage.median_filter(column, AROUND) for column in bends.T], 1)
    return 1.4826 * np.maximum(width, 0.5)


def _far(x, width):
    """(n,) whether x (n, c) leaps after a row."""
    square = (_bends(x, np.arange(len(x)), None) / width) ** 2
    nats = 0.5 * (FREEDOM + 1.0) * np.log1p(square / FREEDOM).sum(axis=1)
    return nats > np.median(nats) + LEAP


def _bends(x, after, source):
    """(k, c) step from row `after` (k,) to the next, less the mean of those on either side;
    source(rows): the row that stands in the place of each of (k,), None for itself."""
    at = [np.clip(after + k, 0, len(x) - 1) for k in (-1, 0, 1, 2)]
    a, b, c, d = (x[place if source is None else source(place)] for place in at)
    return 1.5 * (c - b) - 0.5 * (d - a)


def _places(way, length):
    """Where an order leaps, in rows from the first: each the row before a leap."""
    return (-1, length - 1, 2 * length - 1) if way == EXCHANGED else (-1, length - 1)


def _source(way, length, starts):
    """Function of places (k,), of each the row that stands there in the other order."""
    def source(places):
        k = places - starts
        if way == REVERSED:
            return np.where((k >= 0) & (k < length), starts + length - 1 - k, places)
        return np.where((k < 0) | (k >= 2 * length), places,
                        np.where(k < length, places + length, places - length))
    return source


def _gain(x, width, way, length, starts):
    """(k,) nats by which x is likelier in another order from each of the first rows (k,) on."""
    places, source = _places(way, length), _source(way, length, starts)
    # Bends close to one another have readings in common, and noise alike.
    apart = np.abs(np.subtract.outer(places, places))
    white = np.linalg.inv(np.linalg.cholesky(np.where(apart < 4, IN_COMMON[np.minimum(
        apart, 3)], 0.0)))
    own = width[starts + np.array(places)[:, None]]
    nats = []
    for order in (None, source):
        bends = np.array([_bends(x, starts + place, order) for place in places]) / own
        square = (np.tensordot(white, bends, 1) ** 2).sum(axis=0)
        nats.append(0.5 * (FREEDOM + len(places)) * np.log1p(square / FREEDOM).sum(axis=1))
    return nats[0] - nats[1]


def _judged(x, width, far, way, length, worth=SEEN):
    """(nats of x being out of order in this way over its being in order, (k,) first rows, of as
    many nats each)."""
    places = _places(way, length)
    first = np.arange(2, len(x) - 2 * length - 2)
    starts = first[np.logical_and.reduce([far[first[0] + place:first[-1] + place + 1]
                                          for place in places])]
    if not len(starts):
        return 0.0, starts
    gain = _gain(x, width, way, length, starts)
    kept, size = [], places[-1] + 1
    taken = np.zeros(len(x), dtype=bool)
    for k in np.argsort(-gain):
        if gain[k] <= worth:
            break
        if not taken[starts[k]:starts[k] + size].any():
            taken[starts[k]:starts[k] + size] = True
            kept.append(k)
    if not kept:
        return 0.0, starts[:0]
    chance = len(kept) / len(first)
    nats = float(gain[kept].sum()) + len(kept) * math.log(chance) + (
        len(first) - len(kept)) * math.log1p(-chance)
    return nats, np.sort(starts[kept])


def _share(x, width, way, length, starts):
    """Share of all rows that stand elsewhere than they were measured, by those first rows at which
    the motion tells the order."""
    first = np.arange(2, len(x) - 2 * length - 2)
    told = int((_gain(x, width, way, length, first) < -SEEN).sum())
    size = _places(way, length)[-1] + 1
    return min(1.0, size * len(starts) / (told + len(starts)))


def _in_order(capture, sensor, way, length, starts):
    """The Capture with its rows in the other order from each of the first rows on."""
    rows = np.arange(len(capture))
    size = _places(way, length)[-1] + 1
    for start in starts:
        places = np.arange(start, start + size)
        rows[places] = _source(way, length, start)(places)
    ordered = copy.copy(capture)
    for kind in SENSORS:
        if sensor in ("device", kind) and getattr(capture, kind) is not None:
            setattr(ordered, kind, getattr(capture, kind)[rows])
    return ordered
