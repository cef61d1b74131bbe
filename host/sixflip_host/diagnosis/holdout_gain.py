"""Stage 6: how far the gap shrinks on what is held out, in one unit: a session, or moves.

Of the contrasts z = mu + noise of the session held out and the prediction d of the causes, whose
coefficients come from the other sessions, all figures are weighted root mean squares: before^2 =
z'Qz / tr Q, after^2 = (z - d)'Q(z - d) / tr Q and floor^2, the same of noise alone. The weights Q
are those of the fit with flicker as it usually is: a contrast that a hand scatters counts little.
The share is that of these figures (gap_figures.py): what is closed, 2 d'Qz - d'Qd, of the gap. The
variances of both follow from noise drawn at the levels that the contrasts show, each as often as
it is likely. Noise that wanders more than any part's counts as noise only where it is named: else
what a session has beyond the prediction would be taken for it. What lies between three sessions
and more counts for the share; the figures are of what is within a session.
`python -m tests.studies.robustness.shares` prints how often the intervals hold what is true.

In motion a session is held out at a time by what the others say of the sizes, or every other move
where no session shows them alone.
"""
import math
from dataclasses import dataclass, replace

import numpy as np

from ..experiment import linear_model, nominal_rows
from . import adequacy, between_sessions, gap_figures, hypotheses, moves_fit
from .gap_figures import NOTHING, Shrinkage, Sums, spread

DRAWN = 400  # of noise: their variance is known to 7 %, an interval's length to 4 %
DRAWN_FLOOR = 100  # where its mean alone is asked for: a floor of 100 contrasts to half a percent
UNTOLD = 0.1  # of an effect's power: a variance of its size of a tenth of its square
FAR = 6.63  # times their mean, that squares are in one of a hundred at most, of one size or more
RESAMPLED = 400  # of which 20 lie beyond either end of a 90 % interval
ALONG_FREEDOM = 10  # contrasts along gravity that a half of a session must have


def shrinkage(data, chosen, index, usual, wanders=False, private=None):
    """Shrinkage of all sessions, each held out in turn; index: into each unit's grid, the
    likeliest levels of noise; usual: evidence.Levels; wanders: that it is more is named; private:
    Columns that each unit may have of its own beside the chosen ones, those without a name; None:
    it is not asked whether what was held out lies further off."""
    shared = hypotheses.columns_of(chosen)
    fits = gap_figures.fits(data, shared)
    largest = usual.flicker * (math.inf if wanders else adequacy.TIMES_TYPICAL)
    metrics = gap_figures.usual_levels(data.units, index, usual.flicker)
    total, generator = NOTHING, np.random.default_rng(20190919)
    drawn = DRAWN if chosen else DRAWN_FLOOR
    for held, (unit, point, metric) in enumerate(zip(data.units, index, metrics)):
        if not unit.between:
            others = fits[:held] + fits[held + 1:] or fits
            noise = _drawn(unit, fits[held], point, largest, generator, drawn)
            total = total + _sums(unit, metric, _foretold(unit, others, shared), noise)
    beside, sessions = NOTHING, sum(not unit.between for unit in data.units)
    for own, point, others in _between(data.units, fits, index, shared):
        noise = own.draw(point, generator, drawn)
        beside = beside + _sums(own, point, _foretold(own, others, shared), noise)
    # Each session against the others: one more contrast than there are apart from each other.
    whole = total.shrinkage(bool(chosen), beside.times((sessions - 1.0) / sessions))
    return replace(whole, further=whole.further and private is not None and _nothing_closed(
        data.units, fits, metrics, shared, private, total.after - total.floor))


def _nothing_closed(units, fits, metrics, shared, private, left):
    """Whether what the others foretell closes nothing beside what each session has of its own
    either, and more is left by it (weighted squares) than the others may be off in the sizes."""
    closed = untold = 0.0
    for held, (unit, metric, own) in enumerate(zip(units, metrics, private)):
        if unit.between:
            continue
        others = fits[:held] + fits[held + 1:] or fits
        (theta,), (covariance,) = gap_figures.coefficients(others, shared)
        columns, k = unit.columns[:, np.concatenate([shared.index, own.index])], len(shared)
        products = unit.products(np.column_stack([columns, unit.z]), metric)
        untold += float((products[:k, :k] * covariance).sum())
        named = np.append(np.arange(k), len(products) - 1)
        taken = products[k:-1][:, named]
        beside = products[np.ix_(named, named)] - taken.T @ np.linalg.solve(
            products[k:-1, k:-1] + np.diag(own.prior ** -2.0), taken)
        closed += float(2.0 * theta @ beside[:-1, -1] - theta @ beside[:-1, :-1] @ theta)
    return closed < 0.0 and left > FAR * untold


def _foretold(unit, others, shared):
    """(m,) contrasts by what other gap_figures.Fits say of the shared columns."""
    if not len(shared):
        return np.zeros(len(unit.z))
    return unit.columns[:, shared.index] @ gap_figures.coefficients(others, shared)[0][0]


def _between(units, fits, index, shared):
    """What each of three sessions and more has beside the others: (Unit, point of its grid, Fits
    of the others within and among themselves). It is independent of what is left within it
    (Gauss-Markov), and of the others where the errors of all are alike."""
    within = [fit for unit, fit in zip(units, fits) if not unit.between]
    between = [(unit, point) for unit, point in zip(units, index) if unit.between]
    for session in range(len(within) if len(within) > 2 else 0):
        apart = [(*between_sessions.held_out(unit, session), point) for unit, point in between]
        others = within[:session] + within[session + 1:] + [
            gap_figures.fit(rest, rest.statistics(), shared) for _, rest, _ in apart]
        for own, _, point in apart:
            yield own, point, others


def _drawn(unit, fit, point, largest, generator, drawn):
    """(m, drawn) noise with the levels around a point of the grid, each as often as it is likely;
    none with more flicker than the largest."""
    points = unit.around(point)
    nats = fit.course[points, 0]
    likely = np.exp(nats - nats.max())
    numbers = generator.multinomial(drawn, likely / likely.sum())
    levels = gap_figures.usual_levels([unit] * len(points), points, largest)
    return np.hstack([unit.draw(level, generator, number)
                      for level, number in zip(levels, numbers) if number])


def _sums(unit, metric, foretold, noise):
    """Sums of one session, weighted as at a point of its grid."""
    products = unit.products(np.column_stack([unit.z, foretold, noise]), metric)
    squares = np.diagonal(products)
    before, own, alone = squares[0], squares[1], squares[2:]
    with_z, with_d = products[0, 2:], products[1, 2:]
    return Sums(float(before), float(before - 2.0 * products[0, 1] + own), float(alone.mean()),
                unit.weight(metric), spread(
                    float(alone.var()), float((with_z ** 2).mean()),
                    float((with_z * with_d).mean()), float((with_d ** 2).mean())))


@dataclass(frozen=True, eq=False)
class HeldMoves:
    """What the sizes found do on the moves held out: shrinkage; by_others {fold: sizes (4,)} that
    the other folds say; folds (moves,); alone: each session could be held out."""

    shrinkage: Shrinkage
    by_others: dict
    folds: np.ndarray
    alone: bool


def held_moves(gap, named, spread):
    """HeldMoves of a MotionGap: before, after, floor as rms has them; each fold by what the others
    say of the sizes. The interval is that of the sizes themselves."""
    columns, fit, sizes = gap.columns(), gap.fit, gap.sizes
    folds, alone = fit.folds, True
    if not _apart(gap, columns, folds, named):
        folds, alone = np.arange(len(fit.moves)) % moves_fit.SINGLE_FOLDS, False
    drawn = np.random.default_rng(2).multivariate_normal(sizes, spread, RESAMPLED,
                                                         check_valid="ignore")
    before, after = np.zeros(RESAMPLED), np.zeros(RESAMPLED)
    own = other = 0.0
    by_others = {}
    for f in np.unique(folds):
        power = fit.gram[folds == f, :4, :4].sum(axis=0)
        theirs = by_others[f] = fit.sizes(columns, folds != f)[0] * named
        before += np.einsum("ra,ab,rb->r", drawn, power, drawn)
        after += np.einsum("ra,ab,rb->r", drawn - theirs, power, drawn - theirs)
        noise = float((power * spread).sum())
        own += sizes @ power @ sizes - noise
        other += (sizes - theirs) @ power @ (sizes - theirs) + noise
    floor = gap.floor()
    total = sum(float(p.sum()) for p in fit.precision)
    rms = [float(np.sqrt(floor ** 2 + max(v, 0.0) / total)) for v in (own, other)] + [floor]
    if own <= 0.0:
        return HeldMoves(Shrinkage(*rms, None, None), by_others, folds, alone)
    low, high = np.quantile(1.0 - after / before, [0.05, 0.95])
    return HeldMoves(Shrinkage(*rms, 1.0 - other / own, (float(low), float(high))),
                by_others, folds, alone)


def _apart(gap, columns, folds, named):
    """True when all folds but one tell the sizes well enough for that one."""
    for f in np.unique(folds):
        power = gap.fit.gram[folds == f, :4, :4].sum(axis=0)
        spread = gap.fit.sizes(columns, folds != f)[1] * named * named[:, None]
        if (power * spread).sum() > UNTOLD * (gap.sizes @ power @ gap.sizes):
            return False
    return True


def share_of_effect(gap, held, name):
    """Share of the explainable gap that one of the effects found closes on what is held out, or
    None where that is too small to measure."""
    if held.shrinkage.share is None:
        return None
    power = gap.fit.gram[:, :4, :4].sum(axis=0)
    without = gap.sizes * ~np.isin(np.arange(4), moves_fit.EFFECTS[name])
    whole, rest = (float(v @ power @ v) for v in (gap.sizes, without))
    return float(np.clip(held.shrinkage.share * (1.0 - rest / whole), 0.0, 1.0))


def halves(kind, session, model, certified):
    """The two halves of a session as [(part, model)], [] where they are too small."""
    half = session.placements() // 2
    parts = [session.part(range(half)), session.part(range(half, session.placements()))]
    if min(len(np.unique(p.placement)) for p in parts) < 6:
        return []
    if kind == "accel" and min(along(p, model, certified) for p in parts) < ALONG_FREEDOM:
        return []
    return [(p, model) for p in parts]


def along(part, model, certified):
    """Contrasts that no lateral position of a placement can touch."""
    rows = nominal_rows.rows("accel", part, model, certified)
    return linear_model.unit(rows.loosened(), []).freedom
