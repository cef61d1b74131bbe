"""Stage 5: is what is left no more than noise?

Absolute: the contrasts after the causes found, against white noise, placement and as much
flicker as a reference capture shows; without one, what the wandering within the rests shows, at
least half more and at most four times the chip's typical level. Relative: generic discrepancies,
smooth in one variable, must not add anything.
"""
import numpy as np
from scipy import stats

from sixflip_sim.effects import typical
from sixflip_sim.effects.drift import TIMES_S

from . import which
from .nominal_fit import FURTHER_S

TIMES_TYPICAL, TIMES_SEEN, TIMES_LEAST = 4.0, 1.5, 1.5
DOUBTFUL_P, DOUBTFUL_RATIO = 1e-3, 1.3  # white noise itself is known to some 5 %


def usual(sensor, kind):
    """Typical flicker level of a chip, mg or deg/s."""
    return typical.FLICKER[typical.chip_of(sensor, kind)]


def allowance(sensor, kind, reference=None, seen=None):
    """Largest flicker level that counts as noise, mg or deg/s. reference: level of a noise
    capture; seen: level that the wandering within the rests shows, where there is none."""
    level = usual(sensor, kind)
    if reference is not None:
        return max(2.0 * reference, level)
    if seen is None:
        return TIMES_TYPICAL * level
    return float(np.clip(TIMES_SEEN * seen, TIMES_LEAST * level, TIMES_TYPICAL * level))


def level_within(parts, kind):
    """Flicker level that explains the wandering between the blocks of the rests; None without
    such blocks. Causes that change from pose to pose are not in it."""
    seen = expected = 0.0
    for part, _ in parts:
        values, noise = (part.accel, part.noise_accel) if kind == "accel" else (
            part.gyro, part.noise_gyro)
        found = wandering(part, values, noise, 1.0)
        if found:
            seen, expected = seen + found[0], expected + found[1]
    return float(np.sqrt(max(seen, 0.0) / expected)) if expected else None


class Adequacy:
    """ok; ratio: chi2 a degree of freedom; p; index: of each unit's grid; excess, excess_before:
    chi2 beyond the degrees of freedom, with and without the causes."""

    def __init__(self, data, chosen, allowed):
        columns = np.concatenate([c.columns for c in chosen] + [np.zeros(0, dtype=int)])
        prior = np.concatenate([c.prior for c in chosen] + [np.zeros(0)])
        self.index, self.parts = [], []
        total, freedom, before, size = 0.0, 0, 0.0, 0
        for unit, (quadratic, projections) in zip(data.units, data.statistics):
            chi2, index, rank = allowed_fit(unit, quadratic[:, 0], projections[:, :, 0], columns,
                                            prior, allowed)
            self.index.append(index)
            self.parts.append((chi2, unit.freedom - rank))
            total, freedom = total + chi2, freedom + unit.freedom - rank
            before, size = before + quadratic[index, 0], size + unit.freedom
        freedom = max(freedom, 1)
        self.ratio, self.p = total / freedom, float(stats.chi2.sf(total, freedom))
        self.worst = min((float(stats.chi2.sf(c, max(f, 1))) for c, f in self.parts), default=1.0)
        self.excess, self.excess_before = total - freedom, before - size
        self.ok = not (min(self.p, 0.5 * self.worst) < DOUBTFUL_P
                       and max([self.ratio] + [c / max(f, 1) for c, f in self.parts])
                       > DOUBTFUL_RATIO)


def excess_at(data, chosen, index):
    """chi2 beyond the degrees of freedom with these causes, at given points of the grids."""
    columns = np.concatenate([c.columns for c in chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in chosen] + [np.zeros(0)])
    total = 0.0
    for unit, (quadratic, projections), point in zip(data.units, data.statistics, index):
        total += quadratic[point, 0] - unit.freedom
        if len(columns):
            gram = unit.gram[point][np.ix_(columns, columns)] + np.diag(1.0 / prior ** 2)
            inner = projections[point][columns, 0]
            total -= inner @ np.linalg.solve(gram, inner) - (~unit.silent[columns]).sum()
    return float(total)


def allowed_fit(unit, quadratic, projections, columns, prior, allowed):
    """(chi2 after the fit, index of the grid, rank) at the likeliest point of the grid whose
    flicker is no more than allowed."""
    best = None
    for index, (_, level) in enumerate(unit.grid):
        if level > allowed * 1.001 and best is not None:
            continue
        chi2 = quadratic[index]
        logdet = unit.logdet[index]
        if len(columns):
            gram = unit.gram[index][np.ix_(columns, columns)] + np.diag(1.0 / prior ** 2)
            inner = projections[index][columns]
            chi2 = chi2 - inner @ np.linalg.solve(gram, inner)
            logdet = logdet + 0.5 * np.linalg.slogdet(gram)[1]
        loglik = -0.5 * chi2 - logdet
        if best is None or loglik > best[0]:
            best = loglik, float(chi2), index
    seen = columns[~unit.silent[columns]] if len(columns) else columns
    return best[1], best[2], len(seen)


def generic_gains(data, options, chosen):
    """{domain: (gain in nats, candidate)} of the generic discrepancies beside the causes."""
    gains = which.gains(data, [o for o in options if o.generic], chosen)
    found = {}
    for option, gain in gains.items():
        domain = option.effect[1:]
        if domain not in found or gain[0] > found[domain][0]:
            found[domain] = (float(gain[0]), option)
    return found


def session_gain(data, options, chosen):
    """Log evidence (nats) that something smooth in time is left in the sessions, each with its
    own coefficients: what does not repeat from session to session is a discrepancy, too."""
    mine = [o for o in options if o.effect == "~time" and o.axis is None]
    if not mine:
        return 0.0
    columns = np.concatenate([c.columns for c in chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in chosen] + [np.zeros(0)])
    more = np.concatenate([columns, mine[0].columns])
    wide = np.concatenate([prior, 0.3 * mine[0].prior])
    total = 0.0
    for unit, statistics in zip(data.units, data.statistics):
        with_time = _evidence(which.Fit(unit, statistics, more, wide), wide)
        total += with_time - _evidence(which.Fit(unit, statistics, columns, prior), prior)
    return total


def _evidence(fit, prior):
    """Log density of a unit's contrasts, coefficients normal about 0 with these sizes."""
    k = len(prior)
    theta, covariance = np.zeros((1, k)), np.diag(prior ** 2)[None]
    return float(which.predictive(fit, theta, covariance)[0])


def wandering(session, values, noise, level, ordinary=0.0):
    """(seen, expected, expected of a random walk) of the excess variance between the blocks of a
    rest, over white noise and ordinary flicker, in the unit of values squared; a p of the excess.
    Only true wandering (drift) shows there.

    values (n, 3) block means; noise (3,) of a second; level: flicker that is claimed, the random
    walk being the one that wanders as far from one rest to the next; ordinary: level that every
    part has.
    """
    same = np.flatnonzero(np.diff(session.placement) == 0)
    moved = np.flatnonzero(np.diff(session.placement) != 0)
    if len(same) < 4:
        return None
    difference = np.diff(values, axis=0)[same]
    gap = np.diff(session.t)[same]
    over = noise[None] ** 2 * (1.0 / session.seconds[same] + 1.0 / session.seconds[same + 1]
                               )[:, None] + ordinary ** 2 * _flicker(gap, gap)[:, None]
    claimed = level ** 2 * _flicker(gap, gap)
    walk = claimed
    if len(moved):
        pause = np.diff(session.t)[moved]
        block = 0.5 * (session.seconds[moved] + session.seconds[moved + 1])
        # Of two neighbouring means over g seconds a walk of rate q differs by 2/3 q g.
        rate = level ** 2 * np.mean(_flicker(pause, block) / (pause - block / 3.0))
        walk = np.minimum(claimed, rate * gap * 2.0 / 3.0)
    seen = float((difference ** 2 - over).sum())
    return (seen, 3.0 * float(claimed.sum()), 3.0 * float(walk.sum()),
            float(stats.chi2.sf(float((difference ** 2 / over).sum()), difference.size)))


def _flicker(gap, block):
    """Variance of the difference of two means over `block` seconds, their middles `gap` >= block
    apart, of unit flicker: per exponential 2 var - 2 cov, averaged over the blocks."""
    times = np.array(FURTHER_S + TIMES_S)[:, None]
    x = block[None] / times
    own = 2.0 / x * (1.0 - (1.0 - np.exp(-x)) / x)
    both = ((1.0 - np.exp(-x)) / x) ** 2 * np.exp(-(gap - block)[None] / times)
    return 2.0 * (own - both).sum(axis=0)
