"""The members of a set of hypotheses: which of them stand beside the others; and of one of the
likeliest set the axes that it does its work on, and the variants of its effect in which it would
do as well.

No part has the very form of the library, and what has no name has no known form at all. What a
large member leaves of its form must not be taken for a small one beside it, nor for noise.
"""
from dataclasses import replace

import numpy as np

from . import discrepancy, evidence, hypotheses
from .odds import PRESENT

AS_WELL = 3.0  # nats, GAP stage 4
NOISE_FORM = 0.2  # of a name's gain, that its true form may leave to noise that wanders


def pruned(model, best, cost):
    """The set (scored_sets.Scored of a scored_sets.Model) without members that cost
    (cutoffs.Cutoffs) more than they gain: beside the others a member has to gain more than a share
    of what they gain, nats, in the set without it: of two that are nearly alike each does most of
    what the other does, and neither would look large beside the other."""
    while best.forms:
        without = {form: model.scored(tuple(f for f in best.forms if f is not form))
                   for form in best.forms}
        gains = {form: best.score - fewer.score for form, fewer in without.items()}
        alone = {f: max(gains[f], _alone(model, f)) for f in best.forms}
        needed = {form: cost.nats(form) + PRESENT + max(
            [_unknown(form, f, cost) * (
                alone[f] if f.generic or form.effect == "drift"
                else max(gains[f], energies[f]) if discrepancy.may_be_left_by(form, f)
                else gains[f])
             for f in best.forms if f is not form and not _seen_within(best, form, f, cost)],
            default=0.0)
            for form, energies in ((form, _energies(fewer)) for form, fewer in without.items())}
        weakest = min(best.forms, key=lambda f: gains[f] - needed[f])
        if gains[weakest] >= needed[weakest]:
            break
        best = without[weakest]
    return best


def _seen_within(best, form, other, cost):
    """Whether a walk beside a name is there by what it does within the rests alone, where a name
    that is a function of the pose alone leaves nothing of its form."""
    if form.effect != "drift" or other.generic \
            or hypotheses.domain(other.effect) != "orientation":
        return False
    return sum(choice.within for choices in best.chosen for choice in choices
               if choice.form == form) >= cost.nats(form) + PRESENT


def _unknown(form, other, cost):
    """Share of what another member gains that a member must gain itself: noise, or what differs
    from session to session anyhow, has no form that could be another one, and noise takes up
    whatever form a stranger has beyond what is described."""
    if other.effect == "drift" or other.free:
        return 0.0
    if form.effect == "drift":
        return 1.0 if other.generic else NOISE_FORM
    return cost.beside if other.generic else cost.form


def _alone(model, form):
    """Nats that a form gains by itself."""
    return model.scored((form,)).score - model.scored(()).score


def _energies(scored):
    """{Form: nats lost without it at the levels of noise found, by its coefficients and their
    covariance [Wald, Trans. AMS 54 (1943) 426]}. Without it more noise would be taken for usual,
    so what it gains grows as a logarithm of its size only, and what its form leaves with the
    square."""
    shared = scored.shared
    if not len(shared):
        return dict.fromkeys(scored.forms, 0.0)
    theta, covariance = (v[0] for v in evidence.coefficients(scored.fits, shared))
    energies = {}
    for form in scored.forms:
        mine = np.flatnonzero(np.isin(shared.index, form.columns))
        block = covariance[np.ix_(mine, mine)]
        energies[form] = 0.5 * float(theta[mine] @ np.linalg.solve(block, theta[mine])) \
            if len(mine) else 0.0
    return energies


def in_full(model, forms, posterior, cause):
    """An aliases.Cause of a Posterior's best set with the letters of its axes and its variants."""
    told = _told_axes(model, forms, posterior, cause)
    return replace(cause, letters=tuple("xyz"[axis] for axis in sorted(told)),
                   variants=_variants(model, forms, posterior, cause))


def _told_axes(model, forms, posterior, cause):
    """The set of axes (0..2) that every name of a cause's class has that tells one: quadratic on
    x and the products of x with y and z on those, which cannot be told apart, have none."""
    form = cause.chosen[0]
    others = _without(model, posterior, form)
    told = _needed_axes(model, forms, posterior, others, [form]) & set(form.axes)
    for name in cause.members:
        theirs = _needed_axes(model, forms, posterior, others, [
            f for f in forms if f.effect == name and f.axes and not f.choices])
        told = told & theirs if theirs else told
    return told


def _needed_axes(model, forms, posterior, others, alike):
    """The set of axes (0..2) without which the best of Forms of one effect, on all axes, is
    likelier no more: where a pose's attitude is free, x: f_y f_z and y: f_z f_x add the same along
    gravity, and neither is needed. Of a form that is not the library's more is left to the other
    axes, whose readings it is no function of, but which are free to be what makes up for it."""
    if not alike:
        return set()
    best = max(alike, key=lambda form: model.extended(others, form).score)
    full = _on_all_axes(model, forms, others, best)
    score = model.extended(others, full).score
    loss = {}
    for axis in set(full.axes):
        fewer = hypotheses.on_axes(full, set(full.axes) - {axis})
        loss[axis] = score - (others if fewer is None else model.extended(others, fewer)).score
    most = max(loss.values(), default=0.0)
    share = max(posterior.cost.form, discrepancy.MOVED if best.discrepancy else 0.0)
    least = AS_WELL + share * max(most, 0.0)
    return {axis for axis in loss if loss[axis] > least} or (
        {max(loss, key=loss.get)} if model.units[0].apart else set())


def _on_all_axes(model, forms, others, form):
    """The Form of the same effect and variant on all axes, with a discrepancy where it has one;
    itself where there is no other."""
    for other in forms:
        if other.axis is None and form.axis is not None and (
                other.effect, other.variant, other.record) == (
                form.effect, form.variant, form.record):
            wider = discrepancy.with_discrepancy(model, forms, model.extended(others, other), other
                                                 ) if form.discrepancy else None
            return wider or other
    return form


def axes_of(model, posterior, form):
    """[(axis 0..2, nats)] of a member of the best set: the axes that it does its work on, each
    by what it gains there alone; [] of a level of noise."""
    others = _without(model, posterior, form)
    gains = {}
    for axis in range(3):
        part = hypotheses.on_axes(form, {axis}) if form.axes else None
        if part is not None:
            gains[axis] = model.extended(others, part).score - others.score
    most = max(gains.values(), default=0.0)
    share = posterior.cost.beside if form.generic else posterior.cost.form
    return [(axis, gain) for axis, gain in gains.items()
            if gain == most or gain > posterior.cost.nats(form) + share * most]


def _variants(model, forms, posterior, cause):
    """((probability, Cause), ...): a cause in the variants of its effect that are as likely to
    within AS_WELL (a lag, a time constant, another axis), its own first: which of them it is
    makes a size as uncertain as noise does."""
    form, others = cause.chosen[0], _without(model, posterior, cause.chosen[0])
    told = [(posterior.best.score, cause)]
    for other in forms:
        if other.effect != form.effect or other.record != form.record or not _varies(form, other):
            continue
        scored = model.extended(others, other)
        if scored.score > posterior.best.score - AS_WELL:
            told.append((scored.score, _sized_as(cause, other, scored)))
    weights = np.exp(np.array([score for score, _ in told]) - posterior.best.score)
    return tuple((float(w), variant) for w, (_, variant) in zip(weights / weights.sum(), told))


def _varies(form, other):
    """Whether another form of an effect is a variant of one: the same coefficients in another
    variant, or the same variant on another axis."""
    if other.variant != form.variant:
        return other.keys == form.keys[:len(other.keys)]
    return None not in (form.axis, other.axis) and other.axis != form.axis


def _sized_as(cause, form, scored):
    """A cause whose own form is another one, with its coefficients in a Scored set with that."""
    chosen, columns = (form, *cause.chosen[1:]), scored.shared.index
    theta, covariance = (v[0] for v in evidence.coefficients(scored.fits, scored.shared))
    place = [int(np.flatnonzero(columns == c)[0]) for part in chosen for c in part.columns]
    return replace(cause, chosen=chosen, theta=theta[place],
                   covariance=covariance[np.ix_(place, place)])


def _without(model, posterior, form):
    """Scored of the likeliest set without a member."""
    return model.scored(tuple(f for f in posterior.best.forms if f is not form))
