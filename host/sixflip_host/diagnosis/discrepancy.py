"""What another functional form of a named effect adds to it: a discrepancy in its own variable.

A part's own form is not the library's. A named effect competes with columns of the strangers of
its variable beside its own, as wide as a share of its size, so that another form of the same
cause is neither a second name nor a stranger [Kennedy & O'Hagan, J. R. Stat. Soc. B 63 (2001)
425].
"""
from dataclasses import replace

import numpy as np

from ..experiment.way_memory import LEVELLING
from . import evidence
from .elimination import Columns
from .hypotheses import Form, domain

BESIDE = 0  # the power of a column that is not the effect's own, see terms.Design
RELATIVE = 0.5  # of an effect: how far a part's own form may be from the library's
# In motion a quarter of an effect's size, squared: as much is of another form than the library's.
# A name must gain so much of what a stranger gains beside it, and what has less than so much of
# the power of the names beside it is theirs.
MOVED = 0.06
# Of the functions of one kind, rms: one that shows less of itself has no larger coefficient for
# that, as a product of two axes where every pose is flat. Those of gravity's direction are as
# large as one another in a box that may lie anyhow, those of a temperature as it happens to move.
FAINT, FAINT_POSES, OF_POSES = 0.1, 0.7, ("orientation", "bend", "product_bend")
# What an effect, or all of a domain, is a function of: the strangers that have that variable.
VARIABLE = {"thermal_scale": ("thermal_orientation", "thermal_bend"),
            "cross_quadratic": ("orientation", "bend", "product_bend"),
            "vibration_rectification": ("shaking",),
            "temperature": ("temperature",), "time": ("time",),
            "history": ("history", "time_since_move"),
            "time_since_move": ("history", "time_since_move"),
            # of the gyro in its turns a bend's own variable is the rate
            "orientation": ("orientation", "bend", "amplitude"), "motion": ("motion",),
            "amplitude": ("amplitude",)}

# Of time everything is a function, and of a temperature's rate the temperature is the integral:
# what is another form of these effects is made of their own time constants and lags. So is a
# material's creep, of any course [Prony series], and the memory of what sticks and slips, of plays
# [Prandtl-Ishlinskii] and of what is forgotten of it in the rest.
OWN_FORMS = ("warm_up", "thermal_rate", "creep", "hysteresis")


def _variable(effect):
    return VARIABLE.get(effect) or VARIABLE.get(domain(effect), ())


def alike(form, other):
    """Whether two named effects are functions of one variable, on an axis that both have: another
    form of the one is then some of the other."""
    return _meet(form, other, set(_variable(other.effect)))


def may_be_left_by(form, other):
    """Whether a named effect may be what the form of another one leaves: it is a function of that
    one's variable, or one of both is of time, of which every temperature is a function. What a
    hysteresis of no form of the library leaves is a function of the pose as well."""
    variables = set(_variable(other.effect))
    if variables & {"time", "temperature"}:
        variables |= {"time", "temperature"}
    if other.effect == "hysteresis" and (other.discrepancy or LEVELLING in other.variant):
        variables |= set(VARIABLE["orientation"])
    return _meet(form, other, variables)


def names_of(forms, stranger):
    """[Form] of each named effect that is a function of what a stranger is, on its axis; none
    where a Form has a name."""
    found = {}
    for form in forms:
        if stranger.generic and not form.generic and len(form.shared) and (
                form.axis == stranger.axis and stranger.effect in _variable(form.effect)):
            found.setdefault(form.effect, form)
    return list(found.values())


def _meet(form, other, variables):
    return bool(variables.intersection(_variable(form.effect)) and set(form.axes) & set(
        other.axes))


def _of_variable(designs, forms, names, variant):
    """[(column, axis, number of its design)] of the designs of these names: of those that compete,
    and of what is there to stand beside them; of each the variant, of the same lag for instance,
    or else the last."""
    known, by_effect, start = {form.effect for form in forms}, {}, 0
    for number, design in enumerate(designs):
        stands = design.effect in names and (design.beside or design.effect in known)
        if stands and (not variant or by_effect.get(design.effect, ("",))[0] != variant):
            by_effect[design.effect] = design.variant, list(zip(
                range(start, start + len(design.keys)), design.axes, [number] * len(design.keys)))
        start += len(design.keys)
    return [column for _, columns in by_effect.values() for column in columns]


def _of_effect(designs, form):
    """[(column, axis, number of its design)] of a form's other variants, those that are one of
    them again with more beside it left out, and of what levels off beside what does not: that is
    for the most part no memory, but a bend."""
    pairs, start = [], 0
    for number, design in enumerate(designs):
        if design.effect == form.effect and design.variant != form.variant \
                and BESIDE not in design.powers and (
                    LEVELLING in form.variant or LEVELLING not in design.variant):
            pairs += zip(range(start, start + len(design.keys)), design.axes,
                         [number] * len(design.keys))
        start += len(design.keys)
    return pairs


def with_discrepancy(model, forms, scored, form):
    """The form with a discrepancy in its own variable beside it, whose standard deviation is
    RELATIVE of the size that the form has in a Scored set, of what shows of both; None where there
    is none. Of a form that calibration takes up, half of what it is would be any size of what is
    left: a name for whatever is a function of the same variable."""
    if form.generic or not len(form.shared) or form.discrepancy:
        return None
    designs, variables = model.units[0].designs, _variables(form)
    free = _of_effect(designs, form) if form.effect in OWN_FORMS else _of_variable(
        designs, forms, variables, form.variant)
    shared, own = scored.shared, form.shared.index
    theta = evidence.coefficients(scored.fits, shared)[0][0]
    shown = _shown(model.units, scored.fits, np.array([*own, *(c for c, *_ in free)], dtype=int))
    size, largest = np.zeros(3), {}
    for column, axis, power, squares in zip(own, form.axes, form.powers, shown):
        if power == BESIDE:
            continue
        place = np.flatnonzero(shared.index == column)[0]
        size[axis] = np.hypot(size[axis], theta[place] * np.sqrt(squares))
    for (_, *kind), squares in zip(free, shown[len(own):]):
        largest[tuple(kind)] = max(largest.get(tuple(kind), 0.0), squares)
    columns, prior, axes, weights = [], [], [], []
    for (column, axis, number), squares in zip(free, shown[len(own):]):
        if size[axis] > 0.0 and squares > 0.0 and column not in own:
            columns.append(column)
            axes.append(axis)
            # Of columns that each session has one of its own of, one is there at a time.
            weights.append(len(set(designs[number].keys)) / len(designs[number].keys))
            faint = FAINT_POSES if designs[number].effect in OF_POSES else FAINT
            shows = max(squares, faint ** 2 * largest[axis, number])
            prior.append(RELATIVE * size[axis] / np.sqrt(shows))
    if not columns:
        return None
    prior = np.array(prior) / np.sqrt(np.bincount(axes, weights, 3)[axes])
    return replace(form, keys=form.keys + tuple("xyz"[a] for a in axes),
                   axes=form.axes + tuple(axes), powers=form.powers + (BESIDE,) * len(axes),
                   shared=form.shared + Columns(np.array(columns), prior), discrepancy=True)


def alone(model, forms, form):
    """The stranger that a name may be no more than, as wide as strangers are: the bend of an axis
    in the place of a memory that levels off; in that of a product with a discrepancy, all that
    this is made of. None in any other's: whatever bends an axis has the names of bends, and what a
    memory levels off as is a cubic in any form, where that competes."""
    if LEVELLING in form.variant:
        names = ("bend",)
    elif form.discrepancy and form.effect == "cross_quadratic":
        names = _variables(form)
    else:
        return None
    found, column = [], 0
    for design in model.units[0].designs:
        for key, axis, width in zip(design.keys, design.axes, design.prior):
            if design.effect in names and axis in form.axes:
                found.append((key, axis, column, width))
            column += 1
    if not found:
        return None
    keys, axes, index, prior = zip(*found)
    stranger = Form(names[0], "instead of " + form.effect, form.axis, keys, axes,
                    Columns(np.array(index), np.array(prior)), powers=(1,) * len(keys))
    for name in forms:
        if names == ("bend",) and (name.effect, name.variant, name.axis) == (
                "cubic", "", form.axis):
            return replace(name, variant="in any form", keys=name.keys + keys,
                           axes=name.axes + axes, shared=name.shared + stranger.shared,
                           powers=name.powers + (BESIDE,) * len(keys), discrepancy=True)
    return stranger


def _variables(form):
    """Names of the strangers that a form's discrepancy is made of. Products on three axes take off
    each other what the poses are free to be, so that each may be large, and what bends them
    anything."""
    return tuple(name for name in _variable(form.effect)
                 if form.axis is not None or name != "product_bend")


def _shown(units, fits, columns):
    """(k,) chi2 that a unit of each of some columns adds, at the levels of the Fits."""
    return sum(unit.gram.at(int(fit.index[0]), columns).diagonal()
               for unit, fit in zip(units, fits) if not unit.between)


def in_motion(fit, posterior):
    """The Posterior of a moves_fit.MovesFit without the strangers that are of another form of the
    names beside them: a head that turns within a tenth of a second pulls by 1 g at 18 cm, and a
    rate that is smoothed, or a scale that is a percent off, makes of that what no name has."""
    forms = posterior.best.forms
    columns = np.concatenate([fit.nuisance, *(f.columns for f in forms)]).astype(int)
    sizes = np.zeros(len(fit.prior))
    sizes[columns] = fit.solved(columns)

    def power(some):
        own = np.concatenate([np.zeros(0), *(f.columns for f in some)]).astype(int)
        return fit.rms([m.columns[:, :, own] @ sizes[own] for m in fit.moves]) ** 2
    theirs = MOVED * power([f for f in forms if not f.generic])
    kept = tuple(f for f in forms if not f.generic or power([f]) >= theirs)
    return replace(posterior, best=replace(posterior.best, forms=kept))
