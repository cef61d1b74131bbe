"""What the rests themselves say of a drift: it goes on while the box lies still.

A random walk is given to the contrasts as a few slow terms (strangers.walk). What it does from
one block of a rest to the next is faster than those, and is judged here: what only differs from
pose to pose does nothing within a rest, and is no drift.
"""
import numpy as np

from ..experiment.flicker import differences


def within_rests(part, kind, size, flicker):
    """(3,) log likelihood ratio (nats), axis by axis, of the differences between neighbouring
    blocks of the rests of a session: a random walk that ends `size` off on average, against
    noise and usual flicker alone. size, flicker in mg or deg/s."""
    values, noise = (part.accel, part.noise_accel) if kind == "accel" else (
        part.gyro, part.noise_gyro)
    same = np.flatnonzero(np.diff(part.placement) == 0)
    if not len(same):
        return np.zeros(3)
    difference, gap = np.diff(values, axis=0)[same], np.diff(part.t)[same]
    over = noise[None] ** 2 * (1.0 / part.seconds[same] + 1.0 / part.seconds[same + 1])[:, None]
    over = over + flicker ** 2 * differences(gap, gap)[:, None]
    # Two neighbouring means over g seconds of a walk of rate q differ by 2/3 q g.
    more = (size ** 2 / max(float(np.ptp(part.t)), 1.0) * gap * 2.0 / 3.0)[:, None] + over
    # What is smooth in time changes alike in one rest and the next, and is in the slow terms.
    pairs = len(same) // 2 * 2
    rate = difference[:pairs] / gap[:pairs, None]
    apart = rate[::2] - rate[1::2]
    over, more = ((v[:pairs] / gap[:pairs, None] ** 2).reshape(-1, 2, 3).sum(axis=1)
                  for v in (over, more))
    ratio = np.log(over / more) + apart ** 2 * (1.0 / over - 1.0 / more)
    return 0.5 * ratio.sum(axis=0)
