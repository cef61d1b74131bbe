"""The hypotheses that compete: the library's effects, strangers, levels of noise.

Each has forms (a lag, a time constant, one axis or all) of which the best speaks for it.
"""
from dataclasses import dataclass, replace

import numpy as np

from ..experiment import terms
from . import evidence, strangers
from .evidence import NONE, Columns

TYPICAL = 0.2  # of a design's prior, which is ten times the typical size: twice typical
WIDTHS = (0.2, 1.0)  # of the strangers' scale, tried for what is a session's own
# A random walk's width, of the strangers' scale: from a chip's own flicker (0.3 to 0.45 mg, GAP)
# to three times the largest effects of the library. Halfway between two of them a prior is off
# by 1.8, which costs half a nat a coefficient at most: ln r + (1 / r^2 - 1) / 2.
WALKS = (0.1, 0.3, 1.0, 3.0)
ONE_AXIS = "one axis"  # variant of the drift that one axis has
FREE = {"drift": ("flicker", "time"), "session": ("switch_on", "session")}


@dataclass(frozen=True, eq=False)
class Form:
    """One way in which a hypothesis can be: shared Columns; choices, a tuple of Columns of which
    each session takes one for its own (index: all columns that are in them); free, names of
    levels that may be anything. effect, variant, axis, keys, axes, powers, record, columns and
    prior are those of the design behind it; discrepancy: columns of the strangers of its own
    variable are beside those, with the power BESIDE; of_fleet: the prior is a population's;
    instead: the effect in whose place alone it is tried."""

    effect: str
    variant: str = ""
    axis: object = None
    keys: tuple = ()
    axes: tuple = ()
    shared: Columns = NONE
    choices: tuple = ()
    free: frozenset = frozenset()
    index: tuple = ()
    powers: tuple = ()
    record: bool = False
    discrepancy: bool = False
    of_fleet: bool = False
    instead: str = ""

    @property
    def generic(self):
        return terms.is_stranger(self.effect)

    @property
    def columns(self):
        return self.shared.index

    @property
    def prior(self):
        return self.shared.prior

    @property
    def identity(self):
        """What tells it from all other forms of the same units."""
        return self.effect, self.variant, self.axis, self.record, self.discrepancy

    def __hash__(self):
        return hash(self.identity)

    def __eq__(self, other):
        return self.identity == other.identity


def domain(effect):
    """Where a hypothesis shows itself."""
    if effect in FREE:
        return FREE[effect][1]
    return strangers.domain(effect) if terms.is_stranger(effect) else terms.DOMAIN[effect]


def of(units, without=(), drift=True):
    """list of Form; those silent in all units are left out."""
    found, start = [], 0
    for design in units[0].designs:
        columns = np.arange(start, start + len(design.keys))
        start += len(design.keys)
        if design.effect in without or design.beside:
            continue
        if design.variant == strangers.COURSE:
            found += [_course(design, columns, variant)
                      for variant in strangers.COURSES[design.effect]]
            continue
        if design.choices:
            found.append(_private(design, columns))
            if design.effect == "drift" and not units[0].apart:
                found.append(_one_axis(design, columns))
            continue
        for axis in (None, 0, 1, 2):
            mine = [i for i, a in enumerate(design.axes) if axis is None or a == axis]
            if not mine or axis is not None and len(mine) == len(columns):
                continue
            index = columns[mine]
            if all(u.silent[index].all() for u in units):
                continue
            found.append(Form(design.effect, design.variant, axis,
                              tuple(design.keys[i] for i in mine),
                              tuple(design.axes[i] for i in mine),
                              Columns(index, (1.0 if design.generic else TYPICAL)
                                      * design.prior[mine]),
                              powers=tuple(design.powers[i] for i in mine),
                              record=design.record))
    for name, (level, _) in FREE.items():
        if drift and name not in without:
            found.append(Form(name, free=frozenset([level])))
    return found


def by_fleet(forms, sensor, prior):
    """The forms with the standard deviations of a FleetPrior where it has them; None: as they
    are. Bends beside a slope keep their own."""
    if prior is None:
        return forms
    found = []
    for form in forms:
        told = [None if power != 1 else prior.deviation(sensor, form.effect, key, usual)
                for key, power, usual in zip(form.keys, form.powers, form.shared.prior)]
        if form.generic or not any(told):
            found.append(form)
            continue
        own = np.array([usual if one is None else one
                        for one, usual in zip(told, form.shared.prior)])
        found.append(replace(form, shared=Columns(form.shared.index, own), of_fleet=True))
    return found


def _course(design, columns, variant):
    """A course in time that is a session's own, on all axes or on one, as wide as a drift."""
    term = np.array([int(key[1:]) for key in design.keys])
    size, axes = strangers.roughness(variant)[term], np.array(design.axes)
    choices = tuple(Columns(columns[mine], width * size[mine] * design.prior[mine])
                    for mine in [axes >= 0, *(axes == axis for axis in range(3))]
                    for width in WALKS)
    return Form(design.effect, variant, None, design.keys, design.axes, NONE, choices,
                index=tuple(columns.tolist()),
                instead="" if variant == strangers.ASKED_OF_ALL else "drift")


def _one_axis(design, columns):
    """A walk on one axis alone, a session's own: of three axes one may be worse."""
    choices = tuple(Columns(columns[mine], width * design.prior[mine])
                    for axis in range(3) for width in WALKS
                    for mine in [np.flatnonzero(np.array(design.axes) == axis)])
    return Form("drift", ONE_AXIS, None, design.keys, design.axes, NONE, choices,
                index=tuple(columns.tolist()))


def on_axis(form, axis):
    """The part of a form that is on one axis, or None."""
    index = dict(zip(form.index, form.axes)) if form.choices else None
    if index is None:
        keep = [i for i, a in enumerate(form.axes) if a == axis]
        if not keep:
            return None
        return Form(form.effect, form.variant, "only " + "xyz"[axis],
                    tuple(form.keys[i] for i in keep), (axis,) * len(keep),
                    Columns(form.shared.index[keep], form.shared.prior[keep]),
                    powers=tuple(form.powers[i] for i in keep))
    choices = tuple(Columns(one.index[mine], one.prior[mine]) for one in form.choices
                    for mine in [np.array([index[i] == axis for i in one.index])])
    return Form(form.effect, form.variant, "only " + "xyz"[axis], choices=choices)


def _private(design, columns):
    widths = WIDTHS if design.generic else WALKS
    choices = tuple(Columns(columns[list(one)], width * design.prior[list(one)])
                    for one in design.choices for width in widths)
    return Form(design.effect, design.variant, None, design.keys, design.axes, NONE, choices,
                index=tuple(columns.tolist()))


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
    known, found, start = {form.effect for form in forms}, {}, 0
    for design in designs:
        stands = design.effect in names and (design.beside or design.effect in known)
        if stands and (not variant or found.get(design.effect, ("",))[0] != variant):
            found[design.effect] = design.variant, list(zip(
                range(start, start + len(design.keys)), design.axes))
        start += len(design.keys)
    return [pair for _, pairs in found.values() for pair in pairs]


def _of_effect(designs, form):
    """[(column, axis)] of a form's other variants."""
    found, start = [], 0
    for design in designs:
        if design.effect == form.effect and design.variant != form.variant:
            found += zip(range(start, start + len(design.keys)), design.axes)
        start += len(design.keys)
    return found


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
