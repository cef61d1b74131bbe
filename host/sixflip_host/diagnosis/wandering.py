"""Noise that wanders: how much a sensor does, with its interval, and what the rests say of it.

A random walk is given to the contrasts as a few slow terms (strangers.walk). What it does from
one block of a rest to the next is faster than those, and is judged within the rests: what only
differs from pose to pose does nothing while the box lies still, and is no drift.
"""
import numpy as np

from ..experiment.flicker import differences
from . import evidence

HALF_OF_90 = 1.353  # nats below the maximum at the ends of a 90 % interval: half of chi2(0.9, 1)


def by_flicker(unit, statistics, shared, level):
    """(F,) largest log likelihood of a unit at each of its flicker levels, smallest first."""
    flickers = np.array([pair[1] for pair in unit.grid])
    found = []
    for value in np.unique(flickers):
        points = np.flatnonzero(flickers == value)
        one = evidence.fit(unit, statistics, shared, evidence.NONE, level, points)
        found.append(one.evidence[0])
    return np.array(found)


def profile(levels, course):
    """(likeliest level, low, high) of a 90 % interval from the log likelihoods at increasing
    levels, a parabola in the logarithm of the level through the three highest neighbours."""
    x = np.log(np.asarray(levels))
    k = int(np.clip(course.argmax(), 1, len(x) - 2))
    bend, slope, _ = np.polyfit(x[k - 1:k + 2] - x[k], course[k - 1:k + 2] - course[k], 2)
    if bend >= 0.0:
        return float(levels[k]), float(levels[0]), float(levels[-1])
    middle = float(np.clip(-0.5 * slope / bend, x[k - 1] - x[k], x[k + 1] - x[k])) + x[k]
    half = float(np.sqrt(HALF_OF_90 / -bend))
    return tuple(float(np.exp(v)) for v in (middle, middle - half, middle + half))


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
