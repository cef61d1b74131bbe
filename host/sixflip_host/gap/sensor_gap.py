"""Stages 1 and 3 to 6 for one sensor: accelerometer or gyro, over the rests of all sessions."""
import numpy as np

from sixflip_sim.effects.library import EFFECTS

from .. import progress
from . import (
    adequacy,
    between,
    classes,
    crooked,
    crooked_box,
    cutoffs,
    evidence,
    hypotheses,
    nominal_fit,
    posterior,
    regressors,
    shrinkage,
    sizes,
    strangers,
    wandering,
    which,
)

ALONG_FREEDOM = 10  # contrasts along gravity that a half of a session must have
DOUBT = 0.5  # probability of a stranger in a cause's place, above which it is not explained


class SensorGap:
    """units, data, options (Forms), noise (evidence.Levels), found (Posterior), chosen (named
    Forms), strangers (nameless ones), causes, adequacy, shrinkage; unexplained: bool; added:
    {domain: nats} of the strangers; drift: (level, low, high, nats) or None."""

    drifts = True  # whether noise may wander

    def __init__(self, kind, sessions, nominal, settings):
        self.kind, self.sessions, self.nominal = kind, sessions, nominal
        self.settings = settings
        progress.doing("effects of the %s" % ("gyro" if kind == "gyro" else "accelerometer"))
        self.chip = sessions[0].capture.meta["sensor"]
        self.parts = [(s, m) for s, m in zip(sessions, nominal)]
        parts = self.parts
        regressors.agree(sessions)
        self.units = [self.unit(part, model, settings.certified) for part, model in parts]
        self.units += self._between()
        self.crooked = [crooked.of(s, m) for s, m in self.parts] if kind == "accel" else []
        self.data = which.Data(self.units)
        self.options = hypotheses.of(self.units, settings.without, self.drifts)
        self.noise = self._levels()
        # A square beside a slope is for the board's record; here a discrepancy stands for it.
        self.forms = [f for f in self.options if not f.variant.endswith("+")]
        self.cost = cutoffs.of(self.units, self.forms, self.noise)
        self._judge()

    def _levels(self):
        return adequacy.levels(self.chip, self.kind, self.settings.reference.get(self.kind))

    def unit(self, part, model, certified):
        """Unit of one session; certified: the box is no nuisance."""
        reference = self.settings.reference_c
        designs = regressors.library(part, model.up, self.kind, reference, self.chip)
        if self.kind == "accel":
            designs.append(regressors.of_terms("box_tilt", "accel", part.moment(model.up), part.n,
                                               chip=self.chip))
        designs += strangers.designs(part, model.up, self.kind)
        if self.settings.certified:
            designs = [d for d in designs if d.effect != "box_tilt"]
        unit = nominal_fit.unit_of(self.kind, part, model, designs, certified)
        unit.within = self._within(part)
        self._take_off(unit)
        return unit

    def _within(self, part):
        """{(effect, number of its choice): nats}: what the rests say of walks of each width."""
        nats = np.array([wandering.within_rests(
            part, self.kind, width * strangers.SCALE[self.kind],
            adequacy.usual(self.chip, self.kind)) for width in hypotheses.WALKS])
        found = {("drift", k): float(row.sum()) for k, row in enumerate(nats)}
        found.update({("~walk", k): float(v) for k, v in enumerate(nats.T.ravel())})
        return found

    def _between(self):
        """[Unit of what lies between the sessions], [] where there is nothing between."""
        found = between.unit(self.kind, [u.rows for u in self.units],
                             [m for _, m in self.parts], [u.designs for u in self.units])
        if found is None:
            return []
        self._take_off(found)
        return [found]

    def _take_off(self, unit):
        """Take off the contrasts what the simulator compared with predicts already."""
        known = self.settings.simulated.get(self.kind, ())
        every = [(d.effect, d.variant, key) for d in unit.designs for key in d.keys]
        sizes = np.zeros(len(every))
        for effect, variant, key, size in known:
            if (effect, variant, key) in every:
                sizes[every.index((effect, variant, key))] += size
        if sizes.any():
            unit.z = unit.z - unit.columns @ sizes
            if getattr(unit, "rows", None) is not None:
                unit.rows.y = unit.rows.y - unit.raw(np.arange(len(every))) @ sizes

    def levels(self, data=None):
        """Index into each unit's grid: levels that the data shows with all that was found."""
        if data is None or data is self.data:
            return list(self.adequacy.index)
        fits = which.fits(data, np.zeros(0, dtype=int), np.zeros(0))
        return [int(f.index[0]) for f in fits]

    def _judge(self):
        """Posterior, adequacy, causes, shares, the crooked box, shrinkage."""
        model = posterior.Model(self.units, self.data.statistics, self.noise)
        self.found = posterior.search(model, self.forms, self.cost)
        best = self.found.best
        self.chosen = [f for f in best.forms if not f.generic and len(f.shared)]
        self.strangers = [f for f in best.forms if f.generic]
        self.causes = classes.causes(self.found, self.units, self.forms)
        for cause in self.causes:
            cause.other_axes = posterior.rival_axes(model, self.forms, self.found,
                                                    cause.chosen[0])
        self.adequacy = adequacy.of(self.units, self.data.statistics, best)
        self.added = posterior.domains_left(self.found)
        self.strange_axes = {f.effect: posterior.axes_of(model, self.found, f)
                             for f in self.strangers}
        self.drift = self._drift()
        if self.adequacy.odd and "drift" in best.names:
            self.added["time"] = self.found.gains["drift"]
        doubted = any(self.found.stranger_share(c.effect) > DOUBT for c in self.causes)
        self.unexplained = not self.adequacy.ok or bool(self.strangers) or doubted
        self._shares()
        if self.kind == "accel" and not self.settings.certified \
                and "box_tilt" not in self.settings.without and crooked_box.possible(self):
            box, self.box_data = crooked_box.found(self)
            self._fill(box)
            self.causes += [c for c in box if max(map(abs, c.value.values()), default=0.0)
                            >= crooked_box.LEAST_DEG]
        if crooked_box.bent(self.causes):
            self.crooked = []  # a nonlinearity leans the faces as well
        self.shrinkage = self._shrink()

    def _drift(self):
        """(flicker level, low, high, nats) where a drift is in the likeliest set, 90 % interval
        by the profile of the likelihood, or None; what jumps or is on one axis alone is no
        noise, and has no name."""
        best = self.found.best
        if "drift" not in best.names or self.adequacy.odd:
            return None
        free = frozenset(["flicker"])
        course = 0.0
        for unit, statistics in zip(self.units, self.data.statistics):
            if not unit.between:
                course = course + evidence.by_flicker(unit, statistics, best.shared,
                                                      self.noise.prior(unit, free))
        levels = sorted({b for _, b in self.units[0].grid})
        return (*evidence.profile(levels, course), self.found.gains["drift"])

    @property
    def same_session(self):
        return len(self.parts) == 1

    def _shrink(self):
        """On the sessions held out; with one session its halves, where they can be had."""
        if not self.same_session:
            return shrinkage.of(self.data, self.chosen, self.adequacy.index)
        parts = halves(self.kind, *self.parts[0], self.settings.certified)
        if not parts or not self.chosen:
            return shrinkage.of(self.data, self.chosen, self.adequacy.index)
        data = which.Data([self.unit(p, m, self.settings.certified) for p, m in parts])
        index = self.halved_levels(data)
        return shrinkage.of(data, self.chosen, index)

    def halved_levels(self, data):
        """Index into the grid of each half's unit: the whole session's levels."""
        level = self.units[0].grid[self.adequacy.index[0]]
        return [u.grid.index(level) if level in u.grid else 0 for u in data.units]

    def _shares(self):
        """Each cause's share of the excess: what is lost without it."""
        index = self.adequacy.index
        data = self.data.units, self.data.statistics
        total = max(adequacy.excess_at(*data, [], index), 1e-9)
        now = adequacy.excess_at(*data, self.chosen, index)
        for cause in self.causes:
            rest = [c for c in self.chosen if c not in cause.chosen]
            lost = adequacy.excess_at(*data, rest, index) - now
            cause.share = float(np.clip(lost / max(total, lost, 1e-9), 0.0, 1.0))
        self._fill(self.causes)

    def _fill(self, causes):
        """Domain, unit, sizes and axes of causes."""
        for cause in causes:
            cause.domain = regressors.DOMAIN[cause.effect]
            cause.unit = EFFECTS[cause.effect].units[self.kind]
            data = self.box_data if cause.effect == "box_tilt" else self.data
            sizes.fill(cause, data, self.levels(data), self.chip, self.kind)


def halves(kind, session, model, certified):
    """The two halves of a session as [(part, model)], [] where they are too small."""
    half = session.placements() // 2
    parts = [session.part(range(half)), session.part(range(half, session.placements()))]
    if min(len(np.unique(p.placement)) for p in parts) < 6:
        return []
    if kind == "accel" and min(along(p, model, certified) for p in parts) < ALONG_FREEDOM:
        return []
    return [(p, model) for p in parts]


def along(part, model, certified):
    """Contrasts that no lateral position of a placement can touch."""
    nuisance = nominal_fit.accel_nuisance(part, model, certified)
    lateral = nominal_fit.placement_columns(part)
    return 3 * part.n - np.linalg.matrix_rank(np.hstack([nuisance, lateral]), tol=1e-8)
