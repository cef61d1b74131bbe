"""What another functional form of a named effect adds to it: a discrepancy in its own variable.

A part's own form is not the library's. A named effect competes with columns of the strangers of
its variable beside its own, as wide as a share of its size, so that another form of the same
cause is neither a second name nor a stranger [Kennedy & O'Hagan, J. R. Stat. Soc. B 63 (2001)
425].
"""
from dataclasses import replace

import numpy as np

from . import evidence
from .elimination import Columns
from .hypotheses import domain

BESIDE = 0  # the power of a column that belongs to a stranger, see terms.Design
RELATIVE = 0.5  # of an effect: how far a part's own form may be from the library's
# What an effect, or all of a domain, is a function of: the strangers that have that variable.
VARIABLE = {"thermal_scale": ("thermal_orientation",), "vibration_rectification": ("shaking",),
            "temperature": ("temperature",), "time": ("time",),
            "history": ("history", "time_since_move"),
            "time_since_move": ("history", "time_since_move"),
            # of the gyro in its turns a bend's own variable is the rate
            "orientation": ("orientation", "bend", "amplitude"), "motion": ("motion",),
            "amplitude": ("amplitude",)}


# Of time everything is a function, and of a temperature's rate the temperature is the integral:
# what is another form of these effects is made of their own time constants and lags. So is a
# material's creep, of any course [Prony series], and the memory of what sticks and slips, of plays
# [Prandtl-Ishlinskii].
OWN_FORMS = ("warm_up", "thermal_rate", "creep", "hysteresis")


def _variable(effect):
    return VARIABLE.get(effect) or VARIABLE.get(domain(effect), ())


def alike(form, other):
    """Whether two named effects are functions of one variable, on an axis that both have: another
    form of the one is then some of the other."""
    return _meet(form, other, set(_variable(other.effect)))


def may_be_left_by(form, other):
    """Whether a named effect may be what the form of another one leaves: it is a function of that
    one's variable, or of time, of which every temperature is a function."""
    variables = set(_variable(other.effect))
    return _meet(form, other, variables | ({"time"} if "temperature" in variables else set()))


def _meet(form, other, variables):
    return bool(variables.intersection(_variable(form.effect)) and set(form.axes) & set(
        other.axes))


def _of_variable(designs, forms, names, variant):
    """[(column, axis)] of the designs of these names: of those that compete, and of what is there
    to stand beside them; of each the variant, of the same lag for instance, or else the last."""
    known, by_effect, start = {form.effect for form in forms}, {}, 0
    for design in designs:
        stands = design.effect in names and (design.beside or design.effect in known)
        if stands and (not variant or by_effect.get(design.effect, ("",))[0] != variant):
            by_effect[design.effect] = design.variant, list(zip(
                range(start, start + len(design.keys)), design.axes))
        start += len(design.keys)
    return [pair for _, pairs in by_effect.values() for pair in pairs]


def _of_effect(designs, form):
    """[(column, axis)] of a form's other variants."""
    pairs, start = [], 0
    for design in designs:
        if design.effect == form.effect and design.variant != form.variant:
            pairs += zip(range(start, start + len(design.keys)), design.axes)
        start += len(design.keys)
    return pairs


def with_discrepancy(model, forms, scored, form):
    """The form with a discrepancy in its own variable beside it, whose standard deviation is
    RELATIVE of the size that the form has in a Scored set; None where there is none."""
    if form.generic or not len(form.shared) or form.discrepancy:
        return None
    designs, variables = model.units[0].designs, _variable(form.effect)
    free = _of_effect(designs, form) if form.effect in OWN_FORMS else _of_variable(
        designs, forms, variables, form.variant)
    shared = scored.shared
    theta = evidence.coefficients(scored.fits, shared)[0][0]
    rms = np.sqrt(np.mean([u.energy for u in model.units if not u.between], axis=0))
    size = np.zeros(3)
    for column, axis in zip(form.shared.index, form.axes):
        place = np.flatnonzero(shared.index == column)[0]
        size[axis] = np.hypot(size[axis], theta[place] * rms[column])
    columns, prior, axes = [], [], []
    for column, axis in free:
        if size[axis] > 0.0 and rms[column] > 0.0 and column not in form.shared.index:
            columns.append(column)
            axes.append(axis)
            prior.append(RELATIVE * size[axis] / rms[column])
    if not columns:
        return None
    prior = np.array(prior) / np.sqrt(np.bincount(axes, minlength=3)[axes])
    return replace(form, keys=form.keys + tuple("xyz"[a] for a in axes),
                   axes=form.axes + tuple(axes), powers=form.powers + (BESIDE,) * len(axes),
                   shared=form.shared + Columns(np.array(columns), prior), discrepancy=True)


def outgrows(scored, form):
    """Whether the discrepancy beside a form of a Scored set shows more than the form itself does:
    then the form is a part of something else. What stands beside those of OWN_FORMS is the effect
    itself."""
    if form.effect in OWN_FORMS:
        return False
    theta = evidence.coefficients(scored.fits, scored.shared)[0][0]
    gram = sum(fit.gram[0] for fit in scored.fits)
    beside = np.array(form.powers) == BESIDE
    own, other = (np.isin(scored.shared.index, form.columns[part]) for part in (~beside, beside))
    return _shown(theta[other], gram[np.ix_(other, other)]) > _shown(
        theta[own], gram[np.ix_(own, own)])


def _shown(theta, gram):
    """chi2 of what coefficients add."""
    return float(theta @ gram @ theta)
