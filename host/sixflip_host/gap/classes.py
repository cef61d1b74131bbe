"""Stage 4: never a name inside an unresolved class.

Two effects are one class when one reproduces more than 0.9 of the other (alias index, in the
metric of the noise, nominal model and the other causes projected out; averaged over coefficients,
or of the very sizes found), when their scores are
less than 3 nats apart, or when what tells them apart is less than 3 standard deviations. One
session that tells them apart by itself is enough: the others must not dilute it. What lies
between sessions counts as much in the alias index as all that lies within them: there are few
such contrasts, but no error in the form of an effect can turn them round.
"""
import math

import numpy as np

from . import selection, which
from .regressors import DOMAIN

SAME, NATS, SIGMAS = 0.9, 3.0, 3.0


class Cause:
    """One effect found: chosen (Candidates), members ({effect: why it cannot be told}),
    score (nats), theta, sigma, covariance (over keys), keys, axes, share, plausible;
    other_axes: those that cannot be told from the axes chosen."""

    def __init__(self, effect, chosen, score):
        self.effect, self.chosen, self.score = effect, chosen, score
        self.members, self.share, self.plausible = {}, None, True
        self.other_axes = []
        self.domain = None

    @property
    def names(self):
        return [self.effect] + sorted(self.members)


def pooled(data, chosen):
    """([gram (K, K) within sessions, between them], [gram of each session], theta (k,), V (k, k),
    columns) with the chosen effects in."""
    columns = np.concatenate([c.columns for c in chosen])
    prior = np.concatenate([c.prior for c in chosen])
    found = which.fits(data, columns, prior)
    theta, covariance = which.coefficients(found, prior)
    grams, each = [0.0, 0.0], []  # within sessions, between them
    for unit, fit in zip(data.units, found):
        gram = unit.gram[fit.index[0]]
        grams[unit.between] = grams[unit.between] + gram
        each += [] if unit.between else [gram]
    return grams, each, theta[0], covariance[0], columns


def causes(data, options, chosen):
    """list of Cause, largest score first, with the members of their classes."""
    if not chosen:
        return []
    grams, each, theta, covariance, columns = pooled(data, chosen)
    out = []
    for name in dict.fromkeys(c.effect for c in chosen):
        mine = [c for c in chosen if c.effect == name]
        others = [c for c in chosen if c.effect != name]
        total = np.concatenate([c.columns for c in mine])
        base = which.score(data, *_joined(others)) if others else data.base
        cause = Cause(name, mine, float((which.score(data, *_joined(chosen)) - base)[0]))
        where = np.isin(columns, total)
        cause.keys = [k for c in mine for k in c.keys]
        cause.axes = [a for c in mine for a in c.axes]
        cause.theta = np.concatenate([theta[_places(columns, c.columns)] for c in mine])
        sigma = np.sqrt(np.diag(covariance))
        cause.sigma = np.concatenate([sigma[_places(columns, c.columns)] for c in mine])
        own = np.concatenate([_places(columns, c.columns) for c in mine])
        cause.covariance = covariance[np.ix_(own, own)]
        out.append(cause)
        _rivals(cause, data, options, others, (grams, each), columns[~where])
        cause.other_axes = _other_axes(cause, data, options, others)
    out.sort(key=lambda c: -c.score)
    return [c for k, c in enumerate(out) if not any(_form_of(c, b) for b in out[:k])]


FORM = 0.08  # of an effect's score that its true form may be off by
KIN = ({"temperature", "time"}, {"history", "time_since_move"})


def related(one, other):
    """Whether two domains are one variable, or two that go together."""
    return one == other or any({one, other} <= kin for kin in KIN)


def _form_of(cause, larger):
    """True for what only corrects the form of a far larger cause on the same axes, in the same
    variable: no library has the very curve of a part."""
    return related(DOMAIN[cause.effect], DOMAIN[larger.effect]) \
        and set(cause.axes) <= set(larger.axes) and cause.score < FORM * larger.score


def _joined(chosen):
    return (np.concatenate([c.columns for c in chosen]),
            np.concatenate([c.prior for c in chosen]))


def _places(columns, wanted):
    return [int(np.flatnonzero(columns == w)[0]) for w in wanted]


def balanced(grams, mine):
    """Both grams together, the energy of `mine` between sessions as large as within them."""
    within, between = (np.trace(np.atleast_2d(g)[np.ix_(mine, mine)]) if np.ndim(g) else 0.0
                       for g in grams)
    return grams[0] + grams[1] * (within / between if between > 0.0 else 1.0)


def _rivals(cause, data, options, others, grams, other_columns):
    """Fill cause.members with every other effect that cannot be told from it."""
    mine = np.concatenate([c.columns for c in cause.chosen])
    grams, each = grams
    gram, even = grams[0] + grams[1], balanced(grams, mine)
    taken = {c.effect for c in others}
    for name in dict.fromkeys(o.effect for o in options):
        if name == cause.effect or name in taken:
            continue
        _, gain = selection.of_effect(data, options, name, others)
        if cause.score - gain < NATS:
            cause.members[name] = "score"
            continue
        variants = [o for o in options if o.effect == name and o.axis is None
                    and not o.variant.endswith("+")]
        spaces = [o.columns for o in variants]
        left = reproduced(even, mine, cause.theta, spaces, other_columns)
        if left is None:
            continue
        index = left[0]
        apart = reproduced(gram, mine, cause.theta, spaces, other_columns)[1]
        if index > SAME and not any(_told(g, mine, cause.theta, spaces, other_columns)
                                    for g in each if len(each) > 1):
            cause.members[name] = "alias index %.2f" % index
        elif apart < SIGMAS:
            cause.members[name] = "%.1f standard deviations apart" % apart


def _told(gram, mine, theta, spaces, others):
    """Whether one session's gram alone tells an effect from another's variants."""
    found = reproduced(gram, mine, theta, spaces, others)
    return found is not None and found[0] <= SAME and found[1] >= SIGMAS


def _other_axes(cause, data, options, others):
    """Axes (0..2) on which the same effect would do as well: where a pose's attitude is free,
    x: f_y f_z and y: f_x f_z add the same along gravity."""
    if len(cause.chosen) != 1 or cause.chosen[0].axis is None:
        return []
    mine = cause.chosen[0]
    same = [o for o in options if o.effect == cause.effect and o.axis not in (None, mine.axis)]
    gains = which.gains(data, same, others)
    return sorted({o.axis for o, gain in gains.items() if gain[0] > cause.score - NATS})


def reproduced(gram, mine, theta, alternatives, others):
    """(largest alias index, least distance in standard deviations) over the alternatives; the
    index is averaged over the coefficients `mine`, or of these very ones where that is more."""
    best = None
    for columns in alternatives:
        space = np.concatenate([columns, others]).astype(int)
        inner = gram[np.ix_(mine, mine)]
        after_others = _left(gram, mine, others.astype(int), inner)
        left = _left(gram, mine, space, inner)
        norms = np.diag(after_others)
        good = norms > 1e-9 * np.maximum(np.diag(inner), 1e-300)
        if not good.any():
            continue
        index = 1.0 - float(np.mean(np.diag(left)[good] / norms[good]))
        rest, whole = (max(float(theta @ g @ theta), 0.0) for g in (left, after_others))
        if whole > 0.0:
            index = max(index, 1.0 - rest / whole)
        apart = math.sqrt(rest)
        best = (max(index, best[0]), min(apart, best[1])) if best else (index, apart)
    return best


def _left(gram, mine, space, inner):
    """Gram matrix of `mine` after the columns `space` have been projected out."""
    if not len(space):
        return inner
    block = gram[np.ix_(space, space)]
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
    block = block / scale / scale[:, None] + 1e-9 * np.eye(len(space))
    cross = gram[np.ix_(space, mine)] / scale[:, None]
    return inner - cross.T @ np.linalg.solve(block, cross)


def alias_table(gram, options):
    """(names, index): A(row | column) of the first plain variants, for the report."""
    first = {}
    for o in options:
        if o.axis is None and not o.generic and not o.variant.endswith("+"):
            first.setdefault(o.effect, o)
    names = list(first)
    table = np.eye(len(names))
    for i, a in enumerate(names):
        for j, b in enumerate(names):
            if i != j:
                found = reproduced(gram, first[a].columns, np.zeros(len(first[a].columns)),
                                   [first[b].columns], np.zeros(0))
                table[i, j] = found[0] if found else np.nan
    return names, table
