"""How far the gap in motion shrinks on moves that are held out: a session at a time by what the
others say of the sizes, or every other move where no session shows them alone.
"""
from dataclasses import dataclass

import numpy as np

from . import holdout_gain, moves_fit

UNTOLD = 0.1  # of an effect's power: a variance of its size of a tenth of its square
RESAMPLED = 400  # of which 20 lie beyond either end of a 90 % interval


@dataclass(frozen=True, eq=False)
class Held:
    """What the sizes found do on the moves held out: shrinkage; by_others {fold: sizes (4,)} that
    the other folds say; folds (moves,); alone: each session could be held out."""

    shrinkage: holdout_gain.Shrinkage
    by_others: dict
    folds: np.ndarray
    alone: bool


def held_moves(gap, named, spread):
    """Held: before, after, floor as rms has them; each fold by what the others say of the sizes.
    The interval is that of the sizes themselves."""
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
        return Held(holdout_gain.Shrinkage(*rms, None, None), by_others, folds, alone)
    low, high = np.quantile(1.0 - after / before, [0.05, 0.95])
    return Held(holdout_gain.Shrinkage(*rms, 1.0 - other / own, (float(low), float(high))),
                by_others, folds, alone)


def _apart(gap, columns, folds, named):
    """True when all folds but one tell the sizes well enough for that one."""
    for f in np.unique(folds):
        power = gap.fit.gram[folds == f, :4, :4].sum(axis=0)
        spread = gap.fit.sizes(columns, folds != f)[1] * named * named[:, None]
        if (power * spread).sum() > UNTOLD * (gap.sizes @ power @ gap.sizes):
            return False
    return True


def share(gap, held, name):
    """Share of the explainable gap that one of the effects found closes on what is held out, or
    None where that is too small to measure."""
    if held.shrinkage.share is None:
        return None
    power = gap.fit.gram[:, :4, :4].sum(axis=0)
    without = gap.sizes * ~np.isin(np.arange(4), moves_fit.EFFECTS[name])
    whole, rest = (float(v @ power @ v) for v in (gap.sizes, without))
    return float(np.clip(held.shrinkage.share * (1.0 - rest / whole), 0.0, 1.0))
