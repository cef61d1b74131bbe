"""What was found in one sensor at rest, or in its turns, and what can be asked of it."""
import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..experiment import attitude_fit
from . import (
    adequacy,
    effect_estimates,
    evidence,
    gap_figures,
    holdout_gain,
    hypotheses,
    members,
    odds,
    posterior,
    scored_sets,
    wandering,
)
from .elimination import NONE

LASTING = ("time", "temperature")  # domains of what changes more slowly than a move takes
DOUBT = 0.5  # probability of something nameless, above which a cause is none that is named


@dataclass(frozen=True, eq=False)
class SensorGap:
    """What rest_model.RestModel.fit found. parts: [(Session, NominalSensor)]; units, data; options
    (all Forms), forms (those that compete), noise (evidence.Levels), cost (cutoffs.Cutoffs);
    posterior (Posterior), chosen (its named Forms), strangers (the others: those without a name,
    and those that explain so little beside them that they are likelier a part of what has none),
    causes, adequacy, shrinkage; unexplained: bool; strange_axes: {effect: axes} of the strangers;
    drift: wandering.Drift or None; crooked: box_tilt_test.Crooked or None of each session, none of
    it where something bends the reading."""

    model: object
    parts: list
    units: list
    data: object
    options: list
    forms: list
    noise: evidence.Levels
    cost: object
    posterior: posterior.Posterior
    chosen: list
    strangers: list
    causes: list
    adequacy: adequacy.Adequacy
    strange_axes: dict
    drift: wandering.Drift | None
    unexplained: bool
    crooked: list
    shrinkage: object = None

    def of_name(self, probability, names, share, outside):
        """odds.of_name of a cause of these names that explains this share of the excess. Beside
        something nameless it may be a part of that, the likelier the less it explains: of all
        that is there, where more than that is not even described, or what is left is no noise;
        else of what that gains. By itself it is all there is, and what shows in samples or moves
        is no part of what the rests show."""
        gains = self.posterior.gains
        mine = max((gains[name] for name in names if name in gains), default=0.0)
        if not self.unexplained or share is None or not mine:
            return odds.of_name(probability, self.cost.mimicry.whole(), outside)
        strange = max((gains[f.effect] for f in self.strangers if f.effect in gains), default=0.0)
        left = self.adequacy.excess / max(self.adequacy.excess_before, 1e-9)
        undescribed = left > share or not strange or not self.adequacy.ok
        mimicked = self.cost.mimicry.whole(share) if undescribed \
            else self.cost.mimicry.beside(mine / strange)
        return odds.of_name(probability, mimicked, outside, odds.BESIDE)

    @property
    def kind(self):
        return self.model.kind

    @property
    def settings(self):
        return self.model.settings

    @property
    def chip(self):
        return self.model.chip

    @property
    def lasting(self):
        """Whether all that was found changes more slowly than a move takes, and is all there is:
        with a name or not, upright() has nothing of it."""
        return self.adequacy.ok and all(hypotheses.domain(form.effect) in LASTING
                                        for form in self.posterior.best.forms)

    @property
    def sessions(self):
        return [session for session, _ in self.parts]

    @property
    def same_session(self):
        return len(self.parts) == 1

    @cached_property
    def fits(self):
        """[gap_figures.Fit] of the chosen Forms' columns in each unit."""
        return gap_figures.fits(self.data, self.shared)

    @property
    def shared(self):
        """elimination.Columns of the chosen Forms."""
        return hypotheses.columns_of(self.chosen)

    def upright(self):
        """[(Session, NominalSensor)] of the accelerometer without what was found in it, with a
        name or not: what an axis reads too much leans the box as far as it knows. What goes with
        time is taken off the samples between the rests as well."""
        best, parts = self.posterior.best, []
        lasting = hypotheses.columns_of([form for form in best.forms if hypotheses.domain(
            form.effect) in LASTING]).index
        for (session, sensor), unit, point, own in zip(self.parts, self.units, self.adequacy.index,
                                                       best.private):
            columns = best.shared + own
            known = unit.gram.at(point, columns.index) + np.diag(columns.prior ** -2.0)
            sizes = np.linalg.solve(known, unit.inner[point][columns.index])
            of_each = unit.raw(columns.index) * sizes
            measured = np.linalg.inv(sensor.matrix).T
            added, lasts = ((of_each[:, some].sum(axis=1)).reshape(-1, 3) @ measured for some in (
                slice(None), np.isin(columns.index, lasting)))
            nominal = attitude_fit.fit(session, added)
            if lasts.any():
                read, lsb = copy.copy(session.capture), session.capture.meta["accel_lsb_per_g"]
                read.accel = read.accel - 1e-3 * lsb * np.stack(
                    [np.interp(session.t_s, session.t, column) for column in lasts.T], 1)
                session = session.reading(read)
            parts.append((session, nominal))
        return parts

    def coefficients(self, held=None):
        """(k,) of the chosen Forms' columns, by all units or by those but one that is held out."""
        others = self.fits if held is None else self.fits[:held] + self.fits[held + 1:]
        return gap_figures.coefficients(others or self.fits, self.shared)[0][0]

    @property
    def wanders(self):
        """Whether noise that wanders more than it usually does is among what was found."""
        return "drift" in self.posterior.best.names

    def unit(self, part, nominal, certified, wanted=None):
        """linear_model.Unit of a session, or of a part of one, as the model makes it."""
        return self.model.unit(part, nominal, certified, wanted)

    def levels(self, data=None):
        """Index into each unit's grid: levels that the data shows with all that was found."""
        if data is None or data is self.data:
            return list(self.adequacy.index)
        fits = gap_figures.fits(data, NONE)
        return [int(f.index[0]) for f in fits]

    def halved_levels(self, data):
        """Index into the grid of each half's unit: the whole session's levels."""
        level = self.units[0].grid[self.adequacy.index[0]]
        return [u.grid.index(level) if level in u.grid else 0 for u in data.units]

    def sized(self, causes, data):
        """The causes that were found in this data with their sizes and shares of the excess."""
        index, sized = self.levels(data), []
        every = [*self.chosen, *(f for cause in causes for f in cause.chosen
                                 if f not in self.chosen)]
        for cause in causes:
            rest = [form for form in every if form not in cause.chosen]
            share = gap_figures.excess_share(data.units, data.statistics, index, (rest, index),
                                             (every, index))
            sized.append(effect_estimates.sized(cause, data, index, self.chip, self.kind, share))
        return sized

    def without_parts(self, model):
        """The gap without those causes that are likelier a part of something nameless beside
        them: what they were found to be stands among the strangers. model: scored_sets.Model."""
        def a_part(probability, names, share):
            return self.of_name(probability, names, share, 1.0) <= DOUBT
        parts = [c for c in self.causes
                 if a_part(sum(c.probabilities.values()), c.names, c.share)]
        forms = [form for cause in parts for form in cause.chosen]
        drift = self.drift
        if drift and a_part(self.posterior.places["drift"]["drift"], ["drift"], drift.share):
            drift = None
            forms += [form for form in self.posterior.best.forms if form.effect == "drift"]
        return self._nameless(model, forms, drift=drift, causes=[
            c for c in self.causes if c not in parts]) if forms else self

    def refuted(self, model):
        """The gap without its causes where what the other sessions say of them lies further off
        from a session held out than nothing does: they are none of the sensor's."""
        if not self.shrinkage.further:
            return self
        return self._nameless(model, self.chosen, causes=[])

    def _nameless(self, model, forms, **others):
        return replace(self, chosen=[form for form in self.chosen if form not in forms],
                       strangers=[*self.strangers, *forms], unexplained=True,
                       strange_axes={**self.strange_axes, **{
                           f.effect: members.axes_of(model, self.posterior, f)
                           for f in forms}}, **others)

    def with_effect(self, name):
        """The same with an effect among the chosen ones, whether it passes the threshold or
        not; itself where it is there already, or no form of it competes."""
        mine = [o for o in self.options if o.effect == name]
        if name in {c.effect for c in self.chosen} or not mine:
            return self
        model = scored_sets.Model(self.units, self.data.statistics, self.noise)
        best = max(mine, key=lambda form: model.scored((*self.posterior.best.forms, form)).score)
        chosen = [*self.chosen, best]
        return replace(self, chosen=chosen, shrinkage=holdout_gain.shrinkage(
            self.data, chosen, self.adequacy.index, self.noise, self.wanders))
