"""What was found in one sensor at rest, or in its turns, and what can be asked of it."""
from dataclasses import dataclass, replace

import numpy as np

from . import adequacy, coefficient_fits, evidence, holdout_gain, posterior, scored_sets


@dataclass(frozen=True)
class Drift:
    """Noise that wanders more than it usually does: flicker level with its 90 % interval, score
    (nats) and share of the excess over the usual noise that goes with it."""

    level: float
    low: float
    high: float
    score: float
    share: float


@dataclass(frozen=True, eq=False)
class SensorGap:
    """What rest_model.RestModel.fit found. parts: [(Session, NominalSensor)]; units, data;
    options (all Forms), forms (those that compete), noise (evidence.Levels), cost
    (cutoffs.Cutoffs); found (Posterior), chosen (its named Forms), strangers (its nameless ones),
    causes, adequacy, shrinkage; unexplained: bool; added: {domain: nats} of the strangers,
    strange_axes: {effect: axes}; drift: Drift or None; crooked: box_tilt_test.Crooked or None
    of each session, none of it where something bends the reading."""

    model: object
    parts: list
    units: list
    data: object
    options: list
    forms: list
    noise: evidence.Levels
    cost: object
    found: posterior.Posterior
    chosen: list
    strangers: list
    causes: list
    adequacy: adequacy.Adequacy
    added: dict
    strange_axes: dict
    drift: Drift | None
    unexplained: bool
    crooked: list
    shrinkage: object = None

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
    def sessions(self):
        return [session for session, _ in self.parts]

    @property
    def same_session(self):
        return len(self.parts) == 1

    @property
    def wanders(self):
        """Whether noise that wanders more than it usually does is among what was found."""
        return "drift" in self.found.best.names

    def unit(self, part, nominal, certified, wanted=None):
        """linear_model.Unit of a session, or of a part of one, as the model makes it."""
        return self.model.unit(part, nominal, certified, wanted)

    def levels(self, data=None):
        """Index into each unit's grid: levels that the data shows with all that was found."""
        if data is None or data is self.data:
            return list(self.adequacy.index)
        fits = coefficient_fits.fits(data, np.zeros(0, dtype=int), np.zeros(0))
        return [int(f.index[0]) for f in fits]

    def halved_levels(self, data):
        """Index into the grid of each half's unit: the whole session's levels."""
        level = self.units[0].grid[self.adequacy.index[0]]
        return [u.grid.index(level) if level in u.grid else 0 for u in data.units]

    def with_effect(self, name):
        """The same with an effect among the chosen ones, whether it passes the threshold or
        not; itself where it is there already, or no form of it competes."""
        mine = [o for o in self.options if o.effect == name]
        if name in {c.effect for c in self.chosen} or not mine:
            return self
        model = scored_sets.Model(self.units, self.data.statistics, self.noise)
        best = max(mine, key=lambda form: model.scored((*self.found.best.forms, form)).score)
        chosen = [*self.chosen, best]
        return replace(self, chosen=chosen, shrinkage=holdout_gain.of(
            self.data, chosen, self.adequacy.index, self.noise, self.wanders))
