"""How much names take up of causes that have none: strangers simulated in the very protocol.

Into contrasts without an effect something nameless is put, of a form that no nameless hypothesis
has either. What it leaves over beside the likeliest of those is taken up by names, and some of it
a name explains better still: so alike that no likelihood tells them apart.
"""
from dataclasses import dataclass

import numpy as np

from .. import progress
from . import forms_at_once
from .elimination import NONE, Columns

STRANGERS = 3  # simulated for each nameless hypothesis
STRANGE_CHI2 = 1000.0  # of a simulated stranger: what causes of a typical size come to
FAINT_NATS = 4.0  # of what is nameless: of less no share is told
SURE = 0.9  # share of the strangers beside which no name may be taken in
MIMICKED = 0.2  # where none are simulated: of those in a recommended capture it is 0.1 to 0.3
LEAST_SHARE, MOST_SHARE = 0.02, 0.5  # a form is never known better; beyond half it is no part


@dataclass(frozen=True)
class Mimicry:
    """alike: of each stranger simulated, what the best name gains over what the best of all that
    is nameless does; left: of those that are strangers, what the best name gains beside that over
    what that gains."""

    alike: tuple = ()
    left: tuple = ()

    def whole(self, share=1.0):
        """Share of the strangers of which a name would explain so much; of all of it where it
        explains it better than all that is nameless."""
        return _share_of(self.alike, share) if self.alike else MIMICKED ** share

    def beside(self, share):
        """Share of the strangers of which a name would explain so much beside what is nameless,
        times what that does."""
        return _share_of(self.left, share) if self.left else MIMICKED

    def least(self):
        """Share of what a stranger gains that a name must gain beside it."""
        return float(np.clip(np.quantile(self.left or [0.0], SURE), LEAST_SHARE, MOST_SHARE))


def _share_of(simulated_ones, least):
    """Share of them that are as large, by Laplace's rule of succession."""
    return (sum(gain >= least for gain in simulated_ones) + 1.0) / (len(simulated_ones) + 2.0)


def simulated(units, forms, levels, points):
    """Mimicry of strangers of another form, at one point of each unit's grid."""
    nameless = [f for f in forms if f.generic and f.axis is None and len(f.shared)]
    named = [f for f in forms if not f.generic and f.axis is None and len(f.shared)]
    if not nameless or not named:
        return Mimicry()
    generator = np.random.default_rng(20190920)
    data = _strange(units, nameless, points, generator)
    every = [u.statistics(z, u.coarse) for u, z in zip(units, data)]
    prior = [levels.prior(u, ()) for u in units]

    def scores(columns, statistics=every):
        near = [likely(u, sums, level, u.coarse)
                for u, sums, level in zip(units, statistics, prior)]
        return forms_at_once.scores(units, statistics, columns, prior, near)
    nothing = scores([NONE])[0]
    gains = scores([f.shared for f in nameless]) - nothing
    best, shares = gains.argmax(axis=0), []
    names = scores([f.shared for f in named]).max(axis=0) - nothing
    likeness = names / np.maximum(gains.max(axis=0), FAINT_NATS)
    strange = names < gains.max(axis=0)  # what a name explains better is no stranger
    for place in progress.steps(np.unique(best[strange]), "what strangers leave to names"):
        which = np.flatnonzero((best == place) & strange)
        alone = gains[place, which]
        mine = [(quadratic[:, which], inner[:, :, which]) for quadratic, inner in every]
        both = [_together(nameless[place].shared, f.shared) for f in named]
        beside = scores(both, mine).max(axis=0) - nothing[which] - alone
        shares += (np.maximum(beside, 0.0) / np.maximum(alone, FAINT_NATS)).tolist()
    return Mimicry(*(tuple(np.round(np.sort(values), 3).tolist())
                     for values in (likeness, shares)))


def _together(first, other):
    """Columns of both, each once."""
    new = ~np.isin(other.index, first.index)
    return first + Columns(other.index[new], other.prior[new])


def _strange(units, nameless, points, generator):
    """[contrasts (m, R)] of each unit: noise, and in every data set a combination of the columns
    of one nameless hypothesis on one axis, bent flat at both ends, the same in all sessions."""
    every = [[] for _ in units]
    for form in nameless:
        for number in range(STRANGERS):
            mine = form.columns[np.array(form.axes) == number % 3]
            if not len(mine):
                continue
            mix = generator.standard_normal(len(mine))
            raw = [np.zeros(0) if u.between else u.raw(mine) @ mix for u in units]
            width = np.sqrt(np.mean(np.concatenate(raw) ** 2)) + 1e-12
            moved = [np.zeros(len(u.z)) if u.between else u.contrasts(np.tanh(x / width))
                     for u, x in zip(units, raw)]
            chi2 = sum(u.chi2(m, k) for u, m, k in zip(units, moved, points))
            size = np.sqrt(STRANGE_CHI2 / max(chi2, 1e-9))
            for drawn, unit, m, k in zip(every, units, moved, points):
                drawn.append(size * m + unit.draw(k, generator, 1)[:, 0])
    return [np.stack(drawn, axis=1) for drawn in every]


def likely(unit, statistics, level, points):
    """Points of a unit's grid, of these, that any of the data sets is likely at."""
    return unit.tried(level[:, None] - 0.5 * statistics[0] - unit.logdet[:, None], points)
