"""What else one member of the likeliest set could be: on which axes it does its work, on which
others and in which other variants of its effect it would do as well.
"""
from dataclasses import replace

import numpy as np

from . import evidence, hypotheses

AS_WELL = 3.0  # nats, GAP stage 4


def in_full(model, forms, found, cause):
    """An aliases.Cause of a Posterior's best set with other_axes and variants."""
    return replace(cause, other_axes=_rival_axes(model, forms, found, cause.chosen[0]),
                   variants=_variants(model, forms, found, cause))


def _rival_axes(model, forms, found, form):
    """Axes (0..2) on which the same effect would do as well as on the one it was found on: where
    a pose's attitude is free, x: f_y f_z and y: f_x f_z add the same along gravity."""
    if form.axis is None:
        return ()
    others = _without(model, found, form)
    return tuple(one.axis for one in forms if one.effect == form.effect
                 and (one.variant, one.record) == (form.variant, form.record)
                 and one.axis not in (None, form.axis)
                 and model.extended(others, one).score > found.best.score - AS_WELL)


def axes_of(model, found, form):
    """[(axis 0..2, nats)] of a member of the best set: the axes that it does its work on, each
    by what it gains there alone; [] of a level of noise."""
    others = _without(model, found, form)
    gains = {}
    for axis in range(3):
        part = hypotheses.on_axis(form, axis) if form.axes else None
        if part is not None:
            gains[axis] = model.extended(others, part).score - others.score
    most = max(gains.values(), default=0.0)
    share = found.cost.beside if form.generic else found.cost.form
    return [(axis, gain) for axis, gain in gains.items()
            if gain == most or gain > found.cost.nats(form) + share * most]


def _variants(model, forms, found, cause):
    """((probability, Cause), ...): a cause in the variants of its effect that are as likely to
    within AS_WELL (a lag, a time constant), its own first: which of them it is makes a size as
    uncertain as noise does."""
    form, others = cause.chosen[0], _without(model, found, cause.chosen[0])
    told = [(found.best.score, cause)]
    for one in forms:
        if one.effect != form.effect or one.variant == form.variant or (
                one.keys, one.record) != (form.keys[:len(one.keys)], form.record):
            continue
        scored = model.extended(others, one)
        if scored.score > found.best.score - AS_WELL:
            told.append((scored.score, _sized_as(cause, one, scored)))
    weights = np.exp(np.array([score for score, _ in told]) - found.best.score)
    return tuple((float(w), one) for w, (_, one) in zip(weights / weights.sum(), told))


def _sized_as(cause, form, scored):
    """A cause whose own form is another one, with its coefficients in a Scored set with that."""
    chosen, columns = (form, *cause.chosen[1:]), scored.shared.index
    theta, covariance = (v[0] for v in evidence.coefficients(scored.fits, scored.shared))
    place = [int(np.flatnonzero(columns == c)[0]) for one in chosen for c in one.columns]
    return replace(cause, chosen=chosen, theta=theta[place],
                   covariance=covariance[np.ix_(place, place)])


def _without(model, found, form):
    """Scored of the likeliest set without a member."""
    return model.scored(tuple(f for f in found.best.forms if f is not form))
