"""Values of one sensor that are held: its rows repeat while noise would have moved them.

Three axes that do not change from a row to the next may do so by chance: where each of them
repeats with a chance of its own, all three do with the product of the three. Those chances are
seen in the neighbouring rows in which another axis changed, for a sensor at rest repeats more
often than one that moves: the product of means over both is less than the mean of products. Held
values repeat all three at once. Single rows that were read again are looked for where the sensor
moves on before and after them. Where both sensors repeat in the same rows, now and then or for a
while, samples were not read: there are none.
"""
import copy
import math

import numpy as np
from scipy import special

from ...capture import clock
from ...capture.registers import SENSORS, steps
from .detection import Damage, present
from .stuck_axes import FEWEST, LEAST_NOISE, by_chance, lengths, unforeseen

STRETCH = 256  # rows
NEIGHBOURS = 25  # rows, half a second and less, in which a sensor rests or moves
AT_REST = 8  # rows that repeat on end, of a value each: no noise moves it, or it was not read
FEWEST_HELD = 3  # times that so many do: once is what a log begins or ends with
HELD = 0.05  # share of rows that are held: fewer are single rows, not a rate
# Standard deviation of the spacing of held rows, of its mean: of rows that are lost at random it
# is 1, and of a sensor that is read faster than it measures half a row at most.
AT_RANDOM = 0.5
MOVES = 8.0  # times the noise, from a row to the next: six deviations of a difference at rest
# Rows that come again on end; rows later, at most: as many as a chip's FIFO and two drivers'
# buffers hold; distances to either side that what is slow or periodic has as well; rows of a
# session that are looked at.
ON_END, FARTHEST, NEAR, LONGEST = 3, 300, 2, 100_000
ROW = np.array([1, 1 << 17, 1 << 34])  # of three numbers of 16 bits, which makes one of them
TIMES = {2: "twice", 3: "three times", 4: "four times"}
REGULAR = 0.1  # share of the usual stay that half of all stays differ from it by, of what is held
NOT_READ = "not read"  # kind of the Damage of samples that are missing though rows are not


def findings(sessions):
    """[Damage] of sensors that hold their values."""
    damages = []
    for sensor, words in SENSORS.items():
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None or len(c) < FEWEST for c in columns):
            continue
        parts = [repeats(c) for c in columns]
        nats, held, rows = (sum(v) for v in zip(*parts))
        share = held / max(rows, 1)
        if share < HELD:
            nats, held = (sum(v) for v in zip(*(read_again(c) for c in columns)))
        if not present(nats):
            damages += _blocks_again(sensor, columns)
            continue
        if share < HELD:
            said, value = "about %.0f rows of the %s are the row before once more: read again" % (
                held, words), {"rows": round(held)}
        else:  # of the rows of the file, of which those that neither sensor was read in are gone
            every = sum(len((getattr(s.capture, "recorded", None) or [c])[0])
                        for s, c in zip(sessions, columns))
            times = every / sum(map(len, columns)) / (1.0 - min(share, 0.999))
            whole = TIMES.get(round(times)) if abs(times - round(times)) < 0.1 else None
            said = "the %s gives each value %s: it is read faster than it measures, or rows were" \
                " filled in" % (words, whole or "%.3g times on the mean" % times)
            value = {"times": round(times, 3)}
        damages.append(Damage("repeats", sensor, (), "timing", said, nats, value))
    return damages


def _blocks_again(sensor, columns):
    """[Damage] of whole blocks of rows that come again later: a FIFO that is read twice, or a
    buffer that is sent before it is filled."""
    nats, lag, rows = again_later(columns)
    if not present(nats):
        return []
    said = "%d rows of the %s, %d on end and more, are those of %d rows before once more" % (
        rows, SENSORS[sensor], ON_END, lag)
    return [Damage("repeats", sensor, (), "timing", said, nats, {"rows": rows, "later": lag})]


def again_later(columns):
    """(nats of rows coming again over chance, rows later, how many) of the distance of rows that
    says most, of all columns (n, 3). What repeats by chance does so at every distance alike, or
    nearly; what is periodic does at twice its period, and as often as its noise reads one code
    twice."""
    found, periodic, rows = np.zeros(FARTHEST + NEAR + 1, int), 1.0, []
    for counts in columns:
        twice = [by_chance(unforeseen(column / step, still=True)) for column, step in zip(
            counts.T.astype(np.int64), np.maximum(steps(counts), 1))]
        periodic += len(counts[:LONGEST]) * math.prod(twice) ** ON_END
        row = counts[:LONGEST].astype(np.int64) @ ROW
        rows.append((row, np.append(False, row[1:] != row[:-1])))
        found[2:] += [_again(*rows[-1], lag) for lag in range(2, len(found))]
    near = np.array([found[lag - NEAR:lag + NEAR + 1] for lag in range(NEAR, FARTHEST + 1)])
    near[:, NEAR] = 0
    expected = np.maximum(max(float(np.median(found)), periodic), near.max(axis=1))
    nats = _of_blocks(found[NEAR:FARTHEST + 1], expected)
    lag = NEAR + int(nats.argmax())
    twice = sum(_again(*each, 2 * lag) for each in rows)
    return float(_of_blocks(found[lag], max(expected[lag - NEAR], twice))), lag, int(found[lag])


def _again(row, fresh, lag):
    """How many rows, a number each (n,), come again so many rows later, ON_END of them and more;
    fresh (n,): those that are not the one before."""
    same = (row[lag:] == row[:-lag]) & fresh[lag:] & fresh[:-lag]
    if same.sum() < ON_END:
        return 0
    return np.count_nonzero(lengths(same) >= ON_END)


def _of_blocks(rows, expected):
    """Nats of rows coming again over those expected: of rows on end the first says that the others
    will, so of blocks, Poisson; what was tried is paid."""
    more = np.maximum(rows / expected, 1.0)
    return (rows * np.log(more) - np.maximum(rows - expected, 0.0)) / ON_END - math.log(FARTHEST)


def as_read(captures):
    """([(name, Capture)] without the rows in which neither sensor was read anew, [Damage]). The
    captures given are not changed."""
    found = [_not_read(capture) for _, capture in captures]
    captures_as_read = [(name, without_rows(capture, rows) if len(rows) else capture)
                        for (name, capture), (_, rows, _) in zip(captures, found)]
    number = sum(len(rows) for _, rows, _ in found)
    if not number:
        return captures_as_read, []
    every = sum(len(capture) for _, capture in captures) / number
    said = "%d rows (%.2g %%) are the row before once more, of both sensors: %s" % (
        number, 100.0 / every, "one in %.1f: read faster than they measure" % every if all(
            even for _, rows, even in found if len(rows)) else "samples that were not read")
    return captures_as_read, [Damage(NOT_READ, "device", (), "timing", said,
                                     sum(nats for nats, *_ in found), {"rows": number})]


def _not_read(capture):
    """(nats, (k,) rows that are the one before once more, whether at regular times), none where
    that happens by chance, or at regular times in so many that findings() tells a rate of them."""
    none = 0.0, np.zeros(0, dtype=int), False
    if capture.accel is None or capture.gyro is None or len(capture) < FEWEST:
        return none
    counts = np.hstack([capture.accel, capture.gyro])
    nats, held = (sum(v) for v in zip(repeats(counts)[:2], _frozen(counts)))
    rows = np.flatnonzero((counts[1:] == counts[:-1]).all(axis=1)) + 1
    even = len(rows) > 2 and bool(np.diff(rows).std() < AT_RANDOM * np.diff(rows).mean())
    # As many as are held repeat: where some do by chance, nobody knows which.
    odd = held < 0.9 * len(rows) or len(rows) < 3 or even and held >= HELD * len(counts)
    return (nats, rows, even) if present(nats) and not odd else none


def _frozen(counts):
    """(nats of rows being held over repeating by chance, how many) of counts (n, axes), of those
    that repeat on end for longer than any log is read faster than its sensor: by what the noise of
    the axis that has most leaves to chance, as if all others followed it. What has no noise at
    rest keeps its values there. Rows that are not held pay nothing: few runs may be by chance, and
    that they are as many as repeat is for whoever asks."""
    frozen = counts[1:].any(axis=1) & _resting(counts)
    if (np.diff(np.append(0, frozen)) > 0).sum() < FEWEST_HELD:
        return 0.0, 0
    noise = max(unforeseen(column / step, still=True) for column, step in zip(
        counts.T.astype(np.int64), np.maximum(steps(counts), 1)))
    if noise < LEAST_NOISE:
        return 0.0, 0
    held = int(frozen.sum())
    return -held * math.log(by_chance(noise)) - math.log(len(counts)), held


def _resting(counts):
    """(n - 1,) rows of counts (n, axes) that repeat on end for too long to be of a log that is
    read faster than its sensor: AT_REST rows; or, where values stay equally long and a stretch
    has many of them, which is how held ones look, so many times as long as they stay."""
    same = (counts[1:] == counts[:-1]).all(axis=1)
    stays = np.diff(np.flatnonzero(np.concatenate([[True], ~same, [True]])))
    usual = np.median(stays)
    held = usual <= STRETCH / AT_REST and np.median(np.abs(stays - usual)) <= REGULAR * usual
    return lengths(same) >= AT_REST * (usual if held else 1.0)


def without_rows(capture, rows):
    """A Capture without some of its rows; the one given is not changed."""
    shorter = copy.copy(capture)
    shorter.recorded = clock.recorded_without(capture, rows)
    for name in ("t_us", "accel", "gyro", "temp", "mag", "pose"):
        if getattr(shorter, name) is not None:
            setattr(shorter, name, np.delete(getattr(shorter, name), rows, axis=0))
    return shorter


def read_again(counts):
    """(nats of rows that are the row before once more over repeating by chance, how many) of
    counts (n, 3), among the rows before and after which an axis moves further than noise does."""
    steps = np.abs(np.diff(counts.astype(np.int64), axis=0))
    # What moves smoothly has no second difference: its noise has, of six times its variance.
    second = np.median(np.abs(np.diff(counts.astype(np.int64), n=2, axis=0)), axis=0)
    noise = 1.4826 / np.sqrt(6.0) * np.maximum(second, 1.0)
    far = (steps > MOVES * noise).any(axis=1)
    same = (steps[1:-1] == 0)[far[:-2] & far[2:]]
    if len(same) < FEWEST:
        return 0.0, 0.0
    return tuple(float(v[0]) for v in _stretches(same[None]))


def repeats(counts):
    """(nats of rows being held over repeating by chance, rows held, rows) of counts (n, axes)."""
    same = counts[1:] == counts[:-1]
    # All of them at 0 is what a dead band reads at rest, and what never changes for long is at
    # rest with less noise than a count: neither says that it was not read.
    asked = counts[1:].any(axis=1) & ~_resting(counts)
    number = int(asked.sum()) // STRETCH
    if not number:
        return 0.0, 0.0, len(same)
    nats, held = _stretches(same[asked][:number * STRETCH].reshape(number, STRETCH, -1))
    return min(float(nats.sum()), _in_order(counts, asked)), float(held.sum()), number * STRETCH


def _in_order(counts, asked):
    """Nats of rows being the row before once more oftener than the one before that. Noise has both
    alike, where a sensor rests for a few rows only as well; held values are none but the first."""
    last, before = ((counts[2:] == other).all(axis=1) for other in (counts[1:-1], counts[:-2]))
    first, second = (int((one & asked[1:]).sum()) for one in (last & ~before, before & ~last))
    if first <= second:
        return 0.0
    return (first + second) * (math.log(2.0) - float(special.entr(
        np.array([first, second]) / (first + second)).sum()))


def _stretches(same):
    """(nats (s,), rows held (s,)) of stretches: same (s, n, axes) bool, which of them repeat in a
    row."""
    n, together = same.shape[1], same.all(axis=2).sum(axis=1)
    chances = np.ones(same.shape[:2])
    for axis in range(same.shape[2]):
        others = ~np.delete(same, axis, axis=2).all(axis=2)
        counted = same[:, :, axis] & others
        whole = (counted.sum(axis=1) + 1.0) / (others.sum(axis=1) + 1.0)
        chances *= (_around(counted) + whole[:, None]) / (_around(others) + 1.0)
    chance, share = (np.clip(p, 1e-4, 1.0 - 1e-4) for p in (chances.mean(axis=1), together / n))
    nats = together * np.log(share / chance) + (n - together) * np.log(
        (1.0 - share) / (1.0 - chance)) - 0.5 * math.log(n)
    more = share > chance
    return np.where(more, nats, 0.0), np.where(more, n * (share - chance) / (1.0 - chance), 0.0)


def _around(rows):
    """(s, n) how many of the neighbours of each row of a stretch are among `rows` (s, n) bool."""
    sums = np.pad(np.cumsum(rows, axis=1), ((0, 0), (1, 0)))
    place, number = np.arange(rows.shape[1]), rows.shape[1]
    return (sums[:, np.minimum(place + NEIGHBOURS // 2 + 1, number)]
            - sums[:, np.maximum(place - NEIGHBOURS // 2, 0)])
