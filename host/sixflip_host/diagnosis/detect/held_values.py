"""Values of one sensor that are held: its rows repeat while noise would have moved them.

Three axes that do not change from a row to the next may do so by chance: where each of them
repeats with a chance of its own, all three do with the product of the three. Those chances are
seen in the rows in which another axis changed, in short stretches of their own, for a sensor at
rest repeats more often than one that moves. Held values repeat all three at once. Single rows
that were read again are looked for where the sensor moves on before and after them.
"""
import math

import numpy as np

from .damage import Damage
from .detection import present

FEWEST = 200  # rows
STRETCH = 256  # rows
HELD = 0.05  # share of rows that are held: fewer are single rows, not a rate
MOVES = 8.0  # times the noise, from a row to the next: six deviations of a difference at rest
WORDS = {"accel": "accelerometer", "gyro": "gyro"}
TIMES = {2: "twice", 3: "three times", 4: "four times"}


def findings(sessions):
    """[Damage] of sensors that hold their values."""
    found = []
    for sensor, words in WORDS.items():
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None or len(c) < FEWEST for c in columns):
            continue
        parts = [repeats(c) for c in columns]
        nats, held, rows = (sum(v) for v in zip(*parts))
        share = held / max(rows, 1)
        if share < HELD:
            nats, held = (sum(v) for v in zip(*(read_again(c) for c in columns)))
        if not present(nats):
            continue
        if share < HELD:
            said = "about %.0f rows of the %s are the row before once more: read again" % (
                held, words)
            found.append(Damage("repeats", sensor, (), "timing", said, nats,
                                {"rows": round(held)}))
            continue
        times = 1.0 / (1.0 - min(share, 0.999))
        whole = TIMES.get(round(times)) if abs(times - round(times)) < 0.1 else None
        said = "each value %s" % whole if whole else "each value %.2f times on the mean" % times
        found.append(Damage("repeats", sensor, (), "timing", "the %s gives %s: it is read faster "
                            "than it measures, or rows were filled in" % (words, said), nats,
                            {"times": round(times, 3)}))
    return found


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
    nats, held = _stretch(same)
    return nats, held


def repeats(counts):
    """(nats of rows being held over repeating by chance, rows held, rows) of counts (n, 3)."""
    # All three at 0 is what a dead band reads at rest.
    same = (counts[1:] == counts[:-1])[counts[1:].any(axis=1)]
    number = len(same) // STRETCH
    nats = held = 0.0
    if not number:
        return 0.0, 0.0, len(same)
    parts = same[:number * STRETCH].reshape(number, STRETCH, 3)
    for part in parts:
        more, rows = _stretch(part)
        nats, held = nats + more, held + rows
    return nats, held, number * STRETCH


def _stretch(same):
    """(nats, rows held) of one stretch: same (n, 3) bool, which axes repeat in a row."""
    n, all_three, chance = len(same), int(same.all(axis=1).sum()), 1.0
    for axis in range(3):
        others = ~same[:, [k for k in range(3) if k != axis]].all(axis=1)
        chance *= (same[others, axis].sum() + 1.0) / (others.sum() + 1.0)
    chance, share = (min(max(p, 1e-4), 1.0 - 1e-4) for p in (chance, all_three / n))
    if share <= chance:
        return 0.0, 0.0
    nats = all_three * math.log(share / chance) + (n - all_three) * math.log(
        (1.0 - share) / (1.0 - chance)) - 0.5 * math.log(n)
    return nats, n * (share - chance) / (1.0 - chance)
