"""Noise that wanders: how much a sensor does, with its interval, and what the rests say of it.

A random walk is given to the contrasts as a few slow terms (session_strangers.walk). What it does
from one block of a rest to the next is faster than those, and is judged within the rests: what
only differs from pose to pose does nothing while the box lies still, and is no drift.
"""
from dataclasses import dataclass

import numpy as np

from ..experiment import nominal_rows
from ..experiment.noise_arrays import flicker_differences
from ..experiment.signal_measures import HALF_OF_90
from . import adequacy, evidence, gap_figures, hypotheses, strangers
from .elimination import NONE

# Nats that a drift has for it at most from what it does within the rests: beyond doubt (odds.COST
# and twice what a choice costs).
MOVES = 10.0


@dataclass(frozen=True)
class Drift:
    """Noise that wanders more than it usually does: flicker level with its 90 % interval, score
    (nats), share of the excess over the usual noise that goes with it, and letters of the axes
    that alone have it, if not all do."""

    level: float
    low: float
    high: float
    score: float
    share: float
    axes: tuple = ()


def drift(kind, sessions, units, data, noise, posterior, fitted, chosen):
    """Drift where it is in the likeliest set, its interval by the profile of the likelihood, or
    None; what jumps, or is the same on several axes, is no noise, and has no name."""
    if "drift" not in posterior.best.names or fitted.odd:
        return None
    free = frozenset(["flicker"])
    course = sum(by_flicker(unit, statistics, posterior.best.shared, noise.prior(unit, free))
                 for unit, statistics in zip(units, data.statistics) if not unit.between)
    levels = sorted({b for _, b in units[0].grid})
    level, low, high = profile(levels, course)
    left = _left(kind, units, data.statistics, posterior.best)
    axes = _louder(left(level))
    if axes:
        # Of fewer axes less is known, in the logarithm of the level.
        spread, whole = (3.0 / len(axes)) ** 0.5, level
        level = _level_of(axes, left, levels) * _share_of(axes, kind, sessions)
        low, high = (level * (end / whole) ** spread for end in (low, high))
    share = gap_figures.drift_share(units, data.statistics, posterior.best, chosen, fitted.index,
                                    noise)
    return Drift(level, low, high, posterior.gains["drift"], share,
                 tuple("xyz"[k] for k in axes))


def _left(kind, units, statistics, scored):
    """Function of a flicker level: (n, 3) what it leaves of the readings of all sessions,
    whitened, beside all that was found but the drift."""
    theta = evidence.coefficients(scored.fits, scored.shared)[0][0]
    parts = []
    for unit, sums, choices in zip(units, statistics, scored.chosen):
        if not unit.between:
            others = sum((c.columns for c in choices if c.form.effect != "drift"), NONE)
            fit = evidence.fit(unit, sums, scored.shared, others, np.zeros(len(unit.grid)))
            parts.append((unit, unit.grid[int(fit.index[0])][0], others,
                          unit.raw(scored.shared.index) @ theta))
    return lambda level: np.concatenate([adequacy.innovations(
        unit, (placement, level), others, explained, kind == "accel")
        for unit, placement, others, explained in parts])


def _louder(left):
    """Axes (0..2) that wander more than the quietest one; () where all do alike."""
    each = [x[np.isfinite(x)] for x in left.T]
    if min(len(x) for x in each) < adequacy.FEWEST:
        return ()
    quiet = min(each, key=lambda x: (x ** 2).mean())
    return tuple(k for k, x in enumerate(each)
                 if adequacy.louder(x, quiet) < adequacy.DOUBTFUL_P)


def _level_of(axes, left, levels):
    """The flicker level that leaves of these axes a standard deviation of 1."""
    power = np.array([float(np.nanmean(left(level)[:, axes] ** 2)) for level in levels])
    # From the largest level down, along which what is left grows.
    return float(np.exp(np.interp(0.0, np.log(power[::-1]), np.log(levels[::-1]))))


def _share_of(axes, kind, sessions):
    """What the level of these axes is of all three's, as the kernel of their noise has it."""
    shares = [nominal_rows.axis_shares(session, *_readings(session, kind))[list(axes)]
              for session in sessions]
    return float(np.sqrt(np.mean(shares)))


def _readings(session, kind):
    """((n, 3) means of the blocks, (3,) noise of a mean over one second)."""
    return (session.accel, session.noise_accel) if kind == "accel" else (
        session.gyro, session.noise_gyro)


def by_flicker(unit, statistics, shared, level):
    """(F,) largest log likelihood of a unit at each of its flicker levels, smallest first."""
    flickers = np.array([pair[1] for pair in unit.grid])
    course = []
    for value in np.unique(flickers):
        points = np.flatnonzero(flickers == value)
        fit = evidence.fit(unit, statistics, shared, NONE, level, points)
        course.append(fit.evidence[0])
    return np.array(course)


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


def walks_beside_others(scored):
    """Whether a Scored set has a walk and something else."""
    return len(scored.forms) > 1 and any(
        form.effect == "drift" and form.choices for form in scored.forms)


def beside_others(unit, statistics, scored, place):
    """(n, 3) of the readings of a unit, the place-th, what all members of a Scored set but the
    drift explain, as the unit alone has it."""
    own = scored.shared + sum((c.columns for c in scored.chosen[place]), NONE)
    walk = [index for c in scored.chosen[place] if c.form.effect == "drift"
            for index in c.columns.index]
    fit = evidence.fit(unit, statistics, own, NONE, np.zeros(len(unit.grid)),
                       scored.fits[place].index)
    theta = evidence.coefficients([fit], own)[0][0]
    others = ~np.isin(own.index, walk)
    return (unit.raw(own.index[others]) @ theta[others]).reshape(-1, 3)


def within_rests(part, kind, explained, size, flicker):
    """(3,) log likelihood ratio (nats), axis by axis, of the differences between neighbouring
    blocks of the rests of a session: a random walk that ends `size` off on average, against
    noise and usual flicker alone. size, flicker in mg or deg/s, explained (n, 3) what
    something else explains of the blocks' readings."""
    values, noise = _readings(part, kind)
    values = values - explained
    same = np.flatnonzero(np.diff(part.placement) == 0)
    if not len(same):
        return np.zeros(3)
    difference, gap = np.diff(values, axis=0)[same], np.diff(part.t)[same]
    over = noise[None] ** 2 * (1.0 / part.seconds[same] + 1.0 / part.seconds[same + 1])[:, None]
    over = over + flicker ** 2 * flicker_differences(gap, gap)[:, None]
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


def walks_within_rests(part, kind, chip, explained):
    """{(effect, variant, number of its choice): nats}: what the rests of a session say of each
    walk; explained: see within_rests. It is enough to know that it moves while the box lies still:
    so do other things, whose own likelihood says so."""
    nats = np.array([within_rests(
        part, kind, explained, width * strangers.SCALE[kind], adequacy.usual(chip, kind))
        for width in hypotheses.WALKS])
    by_choice = {("drift", "walk", k): float(row.sum()) for k, row in enumerate(nats)}
    by_choice.update({("drift", hypotheses.ONE_AXIS, k): float(v)
                      for k, v in enumerate(nats.T.ravel())})
    return {key: min(value, MOVES) for key, value in by_choice.items()}
