"""The hypotheses that compete: the library's effects, strangers, levels of noise.

Each has forms (a lag, a time constant, one axis or all) of which the best speaks for it.
"""
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..experiment import terms
from . import session_strangers, strangers
from .elimination import NONE, Columns

TYPICAL = 0.2  # of a design's prior, which is ten times the typical size: twice typical
WIDTHS = (0.2, 1.0)  # of the strangers' scale, tried for what is a session's own
PARTS = ((0, 1, 2), (0,), (1,), (2,))  # and the axes that have it
# A random walk's width, of the strangers' scale: from a chip's own flicker (0.3 to 0.45 mg, GAP)
# to ten times the largest effects of the library. Halfway between two of them a prior is off
# by 1.8, which costs half a nat a coefficient at most: ln r + (1 / r^2 - 1) / 2.
WALKS = (0.1, 0.3, 1.0, 3.0, 10.0)
# Chance that a session has nothing of what is its own in the others. What is in all of them pays
# a fifth of a nat a session for it; what is in one only, 1.6 in each other one, in place of a
# choice of when it was, which is 5.
ABSENT = 0.2
ONE_AXIS = "one axis"  # variant of the drift that one axis has
FREE = {"drift": ("flicker", "time"), "session": ("switch_on", "session")}


@dataclass(frozen=True, eq=False)
class Form:
    """One way in which a hypothesis can be: shared Columns; choices, a tuple of Columns of which
    each session takes one for its own (index: all columns that are in them; one of no column where
    a session may have nothing of it); free, names of levels that may be anything. effect, variant,
    axis, keys, axes, powers, record, shape, columns and prior are those of the design behind it;
    discrepancy: columns of the strangers of its own variable are beside those, with the power
    BESIDE; of_fleet: the prior is a population's; instead: the effect in whose place alone it is
    tried; of_whole: the chances of the form that it is a part of, if it is one."""

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
    shape: tuple = ()
    discrepancy: bool = False
    of_fleet: bool = False
    instead: str = ""
    of_whole: tuple = ()

    @property
    def generic(self):
        return terms.is_stranger(self.effect)

    @property
    def columns(self):
        return self.shared.index

    @property
    def prior(self):
        return self.shared.prior

    @cached_property
    def chances(self):
        """(choices,) nats: the logarithm of the prior of each choice. Those of columns are alike;
        of what may be in some sessions only, a session has nothing in ABSENT of the cases."""
        if self.of_whole:
            return np.array(self.of_whole)
        absent = np.array([not len(choice) for choice in self.choices])
        if not absent.any():
            return np.full(len(absent), -np.log(len(absent)))
        return np.log(np.where(absent, ABSENT, (1.0 - ABSENT) / max((~absent).sum(), 1)))

    @property
    def identity(self):
        """What tells it from all other forms of the same units."""
        return self.effect, self.variant, self.axis, self.record, self.discrepancy

    def __hash__(self):
        return hash(self.identity)

    def __eq__(self, other):
        return self.identity == other.identity


def columns_of(forms):
    """Columns, those that the sessions share, of several Forms one after the other."""
    return sum((form.shared for form in forms), NONE)


def distinct_columns(forms):
    """The same, each column once."""
    priors = {}
    for form in forms:
        for index, prior in zip(form.shared.index.tolist(), form.shared.prior.tolist()):
            priors.setdefault(index, prior)
    return Columns(np.array(list(priors), int), np.array(list(priors.values()), float))


def domain(effect):
    """Where a hypothesis shows itself."""
    if effect in FREE:
        return FREE[effect][1]
    return strangers.domain(effect) if terms.is_stranger(effect) else terms.DOMAIN[effect]


def forms_of(units, without=(), drift=True):
    """list of Form; those silent in all units are left out."""
    forms, start = [], 0
    for design in units[0].designs:
        columns = np.arange(start, start + len(design.keys))
        start += len(design.keys)
        if design.effect in without or design.beside:
            continue
        if design.variant == session_strangers.COURSE:
            forms += [_course(design, columns, variant)
                      for variant in session_strangers.COURSES[design.effect]]
            continue
        if design.choices:
            forms.append(_private(design, columns, units[0].apart))
            if design.effect == "drift" and not units[0].apart:
                forms.append(_one_axis(design, columns))
            continue
        for axis in (None, 0, 1, 2):
            mine = [i for i, a in enumerate(design.axes) if axis is None or a == axis]
            if not mine or axis is not None and len(mine) == len(columns):
                continue
            index = columns[mine]
            if all(u.silent[index].all() for u in units):
                continue
            forms.append(Form(design.effect, design.variant, axis,
                              tuple(design.keys[i] for i in mine),
                              tuple(design.axes[i] for i in mine),
                              Columns(index, (1.0 if design.generic else TYPICAL)
                                      * design.prior[mine]),
                              powers=tuple(design.powers[i] for i in mine),
                              record=design.record, shape=design.shape))
    for name, (level, _) in FREE.items():
        if drift and name not in without:
            forms.append(Form(name, free=frozenset([level])))
    return forms


def by_fleet(forms, sensor, prior):
    """The forms with the standard deviations of a FleetPrior where it has them; None: as they
    are. Bends beside a slope keep their own."""
    if prior is None:
        return forms
    replaced = []
    for form in forms:
        told = [None if power != 1 else prior.deviation(sensor, form.effect, key, usual)
                for key, power, usual in zip(form.keys, form.powers, form.shared.prior)]
        if form.generic or not any(told):
            replaced.append(form)
            continue
        own = np.array([usual if deviation is None else deviation
                        for deviation, usual in zip(told, form.shared.prior)])
        replaced.append(replace(form, shared=Columns(form.shared.index, own), of_fleet=True))
    return replaced


def _course(design, columns, variant):
    """A course in time that is a session's own, on all axes or on one, as wide as a drift."""
    term = np.array([int(key[1:]) for key in design.keys])
    size, axes = session_strangers.roughness(variant)[term], np.array(design.axes)
    choices = tuple(Columns(columns[mine], width * size[mine] * design.prior[mine])
                    for mine in [axes >= 0, *(axes == axis for axis in range(3))]
                    for width in WALKS) + (NONE,)
    return Form(design.effect, variant, None, design.keys, design.axes, NONE, choices,
                index=tuple(columns.tolist()),
                instead="" if variant == session_strangers.ASKED_OF_ALL else "drift")


def _one_axis(design, columns):
    """A walk on one axis alone, a session's own: of three axes one may be worse."""
    choices = tuple(Columns(columns[mine], width * design.prior[mine])
                    for axis in range(3) for width in WALKS
                    for mine in [np.flatnonzero(np.array(design.axes) == axis)])
    return Form("drift", ONE_AXIS, None, design.keys, design.axes, NONE, choices,
                index=tuple(columns.tolist()))


def on_axes(form, axes):
    """The part of a form that is on a set of axes (0..2), or None."""
    name = "only " + "".join("xyz"[axis] for axis in sorted(axes))
    if form.choices:
        axis_of = dict(zip(form.index, form.axes))
        choices = tuple(Columns(choice.index[mine], choice.prior[mine]) for choice in form.choices
                        for mine in [np.array([axis_of[i] in axes for i in choice.index], bool)])
        return Form(form.effect, form.variant, name, choices=choices,
                    of_whole=tuple(form.chances.tolist()))
    keep = [i for i, axis in enumerate(form.axes) if axis in axes]
    if not keep:
        return None
    return Form(form.effect, form.variant, name, tuple(form.keys[i] for i in keep),
                tuple(form.axes[i] for i in keep),
                Columns(form.shared.index[keep], form.shared.prior[keep]),
                powers=tuple(form.powers[i] for i in keep), shape=form.shape,
                discrepancy=form.discrepancy)


def _private(design, columns, apart):
    """What is a session's own, as wide as one of its widths; a stranger on all axes or on one;
    apart: the units are axes."""
    axes = np.array(design.axes)
    widths, parts = (WIDTHS, PARTS) if design.generic else (WALKS, PARTS[:1])
    choices = tuple(Columns(columns[mine], width * design.prior[mine])
                    for choice in map(np.array, design.choices)
                    for part in (PARTS[:1] if apart else parts)
                    for mine in [choice[np.isin(axes[choice], part)]] for width in widths)
    if design.generic:
        choices += (NONE,)
    return Form(design.effect, design.variant, None, design.keys, design.axes, NONE, choices,
                index=tuple(columns.tolist()))
