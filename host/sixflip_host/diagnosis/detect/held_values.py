"""Values of one sensor that are held: its rows repeat while noise would have moved them.

Three axes that do not change from a row to the next may do so by chance: where each of them
repeats with a chance of its own, all three do with the product of the three. Those chances are
seen in the rows in which another axis changed, in short stretches of their own, for a sensor at
rest repeats more often than one that moves. Held values repeat all three at once.
"""
import math

from .damage import Damage
from .detection import present

FEWEST = 200  # rows
STRETCH = 256  # rows
HELD = 0.05  # share of rows that are held: fewer are single rows, not a rate
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


def repeats(counts):
    """(nats of rows being held over repeating by chance, rows held, rows) of counts (n, 3)."""
    same = counts[1:] == counts[:-1]
    number = len(same) // STRETCH
    nats = held = 0.0
    if not number:
        return 0.0, 0.0, len(same)
    parts = same[:number * STRETCH].reshape(number, STRETCH, 3)
    for part in parts:
        all_three = int(part.all(axis=1).sum())
        chance = 1.0
        for axis in range(3):
            others = ~part[:, [k for k in range(3) if k != axis]].all(axis=1)
            chance *= (part[others, axis].sum() + 1.0) / (others.sum() + 1.0)
        chance = min(max(chance, 1e-4), 1.0 - 1e-4)
        share = min(max(all_three / STRETCH, 1e-4), 1.0 - 1e-4)
        if share <= chance:
            continue
        nats += all_three * math.log(share / chance) + (STRETCH - all_three) * math.log(
            (1.0 - share) / (1.0 - chance)) - 0.5 * math.log(STRETCH)
        held += STRETCH * (share - chance) / (1.0 - chance)
    return nats, held, number * STRETCH
