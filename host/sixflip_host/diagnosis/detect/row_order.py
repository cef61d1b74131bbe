"""Rows out of order: blocks that a chip's FIFO or a driver's buffer hands over in another order
than they were measured in, and runs that were read backwards.

The stamps do not tell, since they are those of the rows as they came. A motion does: where two
blocks were exchanged the readings leap at three places that lie a block apart, and go on smoothly
at all three once the blocks are exchanged again; a run that was reversed leaps at its two ends.
How smoothly they go on is the step over a place less the mean of the steps beside it, and its
likelihood Student's t of the width that such bends have around there. So a log competes as it
stands with the same log in another order, and noise or shaking, of which no order is smoother,
speaks for neither. Two explanations compete with a block. A motion that comes again after as many
rows as the block has, as a machine's does, leaps there once more, and a run that is reversed from
a leap to the next ends as it began. A buffer that was handed over twice leaps back by its own
length, and reversed puts a row beside itself. Every row where a block may begin is paid for, and
every length.
"""
import copy
import math

import numpy as np
from scipy import ndimage

from ...capture.registers import SENSORS
from .. import odds
from .detection import Damage, present
from .held_values import HELD

LONGEST = 64  # rows of a block: twice the FIFO of an ADXL345, half of what a driver reads at once
ROWS = 200_000  # in which a habit is looked for, and that are put right at once: half an hour
# Of Student's t, in which a bend's likelihood falls slowly enough that a knock is no proof; rows
# whose bends tell how wide it is, of which the leaps of a block are few.
FREEDOM, AROUND = 4.0, 41
# Explanations of a leap: as it is, or that of so many rows before or after, with the noise of two
# bends, for whose width it is not charged: machines repeat themselves better than one can see.
EXPLAINED = 3.0
BESIDE = range(3)  # rows from a leap: a length that is two too short mends it nearly as well
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
    put_right, found = [], {}
    for name, capture in captures:
        kind = _best(capture)
        if kind is not None:
            nats, sensor, way, length, starts, share = kind
            capture = _in_order(capture, sensor, way, length, starts)
            found.setdefault((sensor, way, length), []).append(
                (nats, len(starts), share * len(capture)))
        put_right.append((name, capture))
    every = sum(len(capture) for _, capture in captures)
    sums = {kind: [sum(v) for v in zip(*each)] for kind, each in found.items()}
    return put_right, [_damage(*kind, nats, blocks, out / every) for kind, (nats, blocks, out) in
                       sorted(sums.items(), key=lambda one: -one[1][0])]


def _damage(sensor, way, length, nats, blocks, share):
    who = "rows" if sensor == "device" else "rows of the %s" % SENSORS[sensor]
    how = ("runs of %d are in reversed order" % length if way == REVERSED else
           "one is exchanged with the next" if length == 1 else
           "blocks of %d are exchanged with the next %d" % (length, length))
    return Damage("row order", sensor, (), "timing",
                  "%s are out of order, about %.2g %% of them: %s" % (who, 100.0 * share, how),
                  nats, {"rows": blocks * (_places(way, length)[-1] + 1), "block": length,
                         "share": round(share, 4)})


def _best(capture):
    """(nats, sensor, way, length, (k,) first rows, share of all rows) of the likeliest other order
    of a Capture's rows, None where they are in order. The habit is that of the first ROWS."""
    sensors = [sensor for sensor in SENSORS if getattr(capture, sensor) is not None]
    if not sensors or len(capture) <= 4 * LONGEST:
        return None
    tried = [(sensor, *_piece(capture, [sensor], 0, ROWS)[:2]) for sensor in sensors]
    if len(tried) > 1:
        tried.append(("device", *(np.hstack(each) for each in list(zip(*tried))[1:])))
    tried = [(*each, _far(*each[1:])) for each in tried]
    found = [(*_judged(x, width, far, way, length), sensor, way, length, x, width)
             for sensor, x, width, far in tried for way in (EXCHANGED, REVERSED)
             for length in range(1 if way == EXCHANGED else 3, LONGEST + 1)]
    nats, starts, sensor, way, length, x, width = max(found, key=lambda f: f[0])
    others = max(len(f[1]) for f in found if f[3:5] != (way, length))
    # Of blocks that a periodic motion may be those count that pay for one place among all rows.
    once = _gain(x, width, way, length, starts, periodic=True)
    nats = min(nats, _beyond(len(starts), 1 + others), _of_blocks(
        once[once > math.log(len(x))], len(x))) - math.log(len(tried))
    if not present(nats):
        return None
    share = _share(x, width, way, length, starts)
    return nats, sensor, way, length, _everywhere(
        capture, sensors if sensor == "device" else [sensor], way, length, share), share


def _everywhere(capture, sensors, way, length, share):
    """(k,) first rows of blocks in all of a Capture, piece by piece. Now that the habit is known,
    a block is where it is likelier than not."""
    size, kept = _places(way, length)[-1] + 1, []
    usual = math.log(size / share)
    for begin in range(0, len(capture), ROWS):
        # To either side as much as blocks need that begin in the piece and leap in the next.
        first = max(begin - AROUND - 2 * LONGEST, 0)
        piece = _piece(capture, sensors, first, begin + ROWS + AROUND + 2 * LONGEST)
        for start in first + _judged(*piece, way, length, usual)[1]:
            if begin <= start < begin + ROWS and (not kept or start >= kept[-1] + size):
                kept.append(start)
    return np.array(kept, dtype=int)


def _piece(capture, sensors, first, end):
    """(x (n, c), widths (n, c), which rows leap (n,)) of a Capture's rows from first to end."""
    x = np.hstack([getattr(capture, sensor)[first:end].astype(float) for sensor in sensors])
    width = _widths(x)
    return x, width, _far(x, width)


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


def _gain(x, width, way, length, starts, periodic=False):
    """(k,) nats by which x is likelier in another order from each of the first rows (k,) on;
    periodic: than if its leaps may be those of as many rows before or after, too."""
    places, source = _places(way, length), _source(way, length, starts)
    # Bends close to one another have readings in common, and noise alike.
    apart = np.abs(np.subtract.outer(places, places))
    white = np.linalg.inv(np.linalg.cholesky(np.where(apart < 4, IN_COMMON[np.minimum(
        apart, 3)], 0.0)))
    own = width[starts + np.array(places)[:, None]]

    def bends(order=None, later=0):
        return np.array([_bends(x, np.clip(starts + place + later, 0, len(x) - 1), order)
                         for place in places])

    def nats(of):
        square = (np.tensordot(white, of / own, 1) ** 2).sum(axis=0)
        return 0.5 * (FREEDOM + len(places)) * np.log1p(square / FREEDOM).sum(axis=1)

    stands = nats(bends())
    for later in (places[-1] + 1, -places[-1] - 1) if periodic else ():
        again = (bends() - bends(later=later)) / math.sqrt(2.0)
        stands = np.minimum(stands, nats(again) + math.log(EXPLAINED))
    return stands - nats(bends(source))


def _handed_twice(x, way, length, starts):
    """(k,) whether the other order from a first row on puts two rows side by side, or nearly, that
    are the same in all of x, where few neighbours are: one and the same row, which came twice."""
    source = _source(way, length, starts)
    twice = np.any([(x[source(starts + place - i)] == x[source(starts + place + j + 1)]).all(1)
                    for place in _places(way, length) for i in BESIDE for j in BESIDE], axis=0)
    around = np.clip(starts[twice, None] + np.arange(AROUND) - AROUND // 2, 0, len(x) - 2)
    twice[twice] = (x[around] == x[around + 1]).all(axis=2).mean(axis=1) < HELD
    return twice


def _judged(x, width, far, way, length, worth=SEEN):
    """(nats of x being out of order in this way over its being in order, (k,) first rows, of as
    many nats each)."""
    places = _places(way, length)
    first = np.arange(2, len(x) - 2 * length - 2)
    starts = first[np.logical_and.reduce([far[first[0] + place:first[-1] + place + 1]
                                          for place in places])]
    if starts.size:
        gain = _gain(x, width, way, length, starts)
        starts, gain = starts[gain > worth], gain[gain > worth]
    if not starts.size:
        return 0.0, starts
    gain[_handed_twice(x, way, length, starts)] = 0.0
    kept, size = [], places[-1] + 1
    taken = np.zeros(len(x), dtype=bool)
    for k in np.argsort(-gain):
        if gain[k] > 0.0 and not taken[starts[k]:starts[k] + size].any():
            taken[starts[k]:starts[k] + size] = True
            kept.append(k)
    return _of_blocks(gain[kept], len(first)), np.sort(starts[kept])


def _of_blocks(gain, number):
    """Nats of blocks of a gain (k,) each, among so many rows where one may begin."""
    chance = len(gain) / number
    return float(gain.sum()) + len(gain) * math.log(chance) + (
        number - len(gain)) * math.log1p(-chance) if chance else 0.0


def _share(x, width, way, length, starts):
    """Share of all rows that stand elsewhere than they were measured, by those first rows at which
    the motion tells the order."""
    first = np.arange(2, len(x) - 2 * length - 2)
    told = int((_gain(x, width, way, length, first) < -SEEN).sum())
    return min(1.0, (_places(way, length)[-1] + 1) * len(starts) / (told + len(starts)))


def _in_order(capture, sensor, way, length, starts):
    """The Capture with its rows in the other order from each of the first rows on."""
    ordered, rows = copy.copy(capture), np.arange(len(capture))
    for start in starts:
        places = np.arange(start, start + _places(way, length)[-1] + 1)
        rows[places] = _source(way, length, start)(places)
    # What else the device reads stands in the same buffer; stamps and poses are the reader's.
    for kind in (*SENSORS, "temp", "mag") if sensor == "device" else (sensor,):
        if getattr(capture, kind) is not None:
            setattr(ordered, kind, getattr(capture, kind)[rows])
    return ordered
