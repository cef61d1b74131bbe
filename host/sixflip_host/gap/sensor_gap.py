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
    drifting,
    nominal_fit,
    regressors,
    selection,
    shrinkage,
    sizes,
    thresholds,
    which,
)

ALONG_FREEDOM = 10  # contrasts along gravity that a half of a session must have
KEPT_SHARE = 0.6  # of the excess, below which a name is no explanation where noise does not fit
BEND = 0.03  # of a cause's score, that the form of the part's own curve may add
TURNS_UP = 0.2  # of a cause's score, below which what is implausible only bends it
SHARED = 0.5  # of the excess, that two causes lose less than in all when either is left out
LEFT = 0.25  # of a cause's score, that something nameless in its domain may still gain
MOST_OF_ONE = 2  # causes that one session, held out against itself, can be believed to show
STAND_IN = 0.8  # of the gain of several names
OWN_SHARE = 0.5  # of a bent effect that must be the effect itself
SESSION_NATS = 8.0  # log evidence at which what is left varies in time beyond doubt


class SensorGap:
    """units, data, options, thresholds, chosen, causes, adequacy, shrinkage; unexplained: bool;
    added: {domain: nats} of generic discrepancies beyond the causes; drift: level or None;
    misnamed: names were found that stood in for something unknown."""

    misnamed = False

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
        self.options = [o for o in which.candidates(self.units)
                        if o.effect not in settings.without]
        self.causes, self.chosen, self.added, self.drift = [], [], {}, None
        self.allowed = adequacy.allowance(self.chip, kind, settings.reference.get(kind),
                                          adequacy.level_within(self.parts, kind))
        if self.options:
            self._search()
        self._judge()

    def unit(self, part, model, certified):
        """Unit of one session; certified: the box is no nuisance."""
        reference = self.settings.reference_c
        designs = regressors.library(part, model.up, self.kind, reference, self.chip)
        if self.kind == "accel":
            designs.append(regressors.of_terms("box_tilt", "accel", part.moment(model.up), part.n,
                                               chip=self.chip))
        designs += regressors.generics(part, model.up, self.kind)
        if self.settings.certified:
            designs = [d for d in designs if d.effect != "box_tilt"]
        unit = nominal_fit.unit_of(self.kind, part, model, designs, certified)
        self._take_off(unit)
        return unit

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
        start = 0
        for design in unit.designs:
            for place, key in enumerate(design.keys):
                for effect, variant, one, size in known:
                    if (effect, variant, one) == (design.effect, design.variant, key):
                        unit.z = unit.z - size * unit.columns[:, start + place]
            start += len(design.keys)

    def levels(self, data=None):
        """Index into each unit's grid: levels that the data shows without effects, the flicker
        no more than is allowed."""
        data = data or self.data
        none = np.zeros(0, dtype=int)
        return [adequacy.allowed_fit(u, q[:, 0], p[:, :, 0], none, np.zeros(0), self.allowed)[1]
                for u, (q, p) in zip(data.units, data.statistics)]

    def _search(self):
        self.limits = thresholds.of(self.units, self.options, self.levels())
        self._choose()

    def _choose(self):
        """Named effects, by forward selection, and their classes."""
        named = [o for o in self.options if not o.generic]
        self.chosen = selection.forward(self.data, named, self.limits.named)
        self.causes = classes.causes(self.data, named, self.chosen)
        if self._stands_in():
            self.chosen, self.causes = [], []

    def _stands_in(self):
        """True when something smooth in one variable, nameless, does about as well as all the
        names found, none of which has to do with that variable: they only stand in for it."""
        if not self.causes:
            return False
        if self.same_session and len(self.causes) > MOST_OF_ONE:
            return True
        domains = {regressors.DOMAIN[c.effect] for c in self.causes}
        columns = np.concatenate([c.columns for c in self.chosen])
        prior = np.concatenate([c.prior for c in self.chosen])
        total = float((which.score(self.data, columns, prior) - self.data.base)[0])
        enough = (STAND_IN * total if len(self.causes) > 1 else total + drifting.DRIFT_NATS)
        return any(gain > enough and not any(classes.related(domain, d) for d in domains)
                   for domain, (gain, _) in adequacy.generic_gains(
                       self.data, self.options, []).items())

    def _judge(self):
        """Adequacy, drift, plausibility, shrinkage."""
        self._settle()
        self.causes = [c for c in self.causes if not self._only_bends(c)]
        while doubted := [c for c in self.causes if self._doubted(c)] or self._opposed():
            self._drop(doubted)
            self.unexplained = self.misnamed = self.drift is None
        if self.drift:
            self._drop(drifting.by_chance(self))
        self._merge()
        if self.options and self.kind == "accel" and not self.settings.certified \
                and "box_tilt" not in self.settings.without and crooked_box.possible(self):
            box, self.box_data = crooked_box.found(self)
            self._fill(box)
            self.causes += [c for c in box if max(map(abs, c.value.values()), default=0.0)
                            >= crooked_box.LEAST_DEG]
        if crooked_box.bent(self.causes):
            self.crooked = []  # a nonlinearity leans the faces as well
        self.shrinkage = self._shrink()

    def _drop(self, causes):
        """Go on without these names."""
        if causes:
            self.chosen = [o for o in self.chosen if not any(o in c.chosen for c in causes)]
            self.causes = [c for c in self.causes if c not in causes]
            self._settle()

    def _settle(self):
        """Adequacy, drift and shares of the causes as they are now."""
        self._adequate()
        self.drift = None
        if not self.adequacy.ok and "drift" not in self.settings.without:
            self.drift = drifting.level(self)
        self.unexplained = (not self.adequacy.ok or bool(self.added)) and self.drift is None
        self._shares()

    def _adequate(self):
        """adequacy, and added: {domain: nats} of the generic discrepancies that add."""
        self.adequacy = adequacy.Adequacy(self.data, self.chosen, self.allowed)
        self.added = {}
        if not self.options:
            return
        gains = adequacy.generic_gains(self.data, self.options, self.chosen)
        self.added = {d: g for d, (g, _) in gains.items() if g > self.limits.generic + 2.0
                      and not any(g < BEND * c.score and classes.related(
                          d, regressors.DOMAIN[c.effect]) for c in self.causes)}
        own = adequacy.session_gain(self.data, self.options, self.chosen)
        if own > SESSION_NATS:
            self.added["time"] = max(own, self.added.get("time", 0.0))
        self._between_left()

    def _between_left(self):
        """Biases further apart than switching on explains, after the causes."""
        unit = self.units[-1]
        if not unit.between:
            return
        left = unit.z
        if self.chosen:
            columns = np.concatenate([c.columns for c in self.chosen])
            prior = np.concatenate([c.prior for c in self.chosen])
            theta = which.coefficients(which.fits(self.data, columns, prior), prior)[0][0]
            left = left - unit.columns[:, columns] @ theta
        covariance = unit.covariance(between.UNUSUAL[self.kind], 0.0)
        nats = 0.5 * float(left @ np.linalg.solve(covariance, left)) - 0.5 * len(left)
        if nats > SESSION_NATS:
            self.added["session"] = nats

    def _doubted(self, cause):
        """True for a name that only stands in for something unknown: most of it is the bend
        beside it, or noise does not fit and it takes less than most of the excess, or what is
        left varies by much in the very way that it should have explained."""
        if self._own_share(cause) < OWN_SHARE:
            return True
        if not self.unexplained:
            return False
        left = self.added.get(cause.domain, 0.0)
        return left > LEFT * cause.score or (cause.share or 0.0) < KEPT_SHARE

    def _only_bends(self, cause):
        """Whether a cause that is larger than can be only bends a far larger one, in the same
        variable."""
        return not cause.plausible and any(
            cause.score < TURNS_UP * c.score and classes.related(c.domain, cause.domain)
            for c in self.causes if c is not cause)

    def _merge(self):
        """One class of two causes in the same variable that each do most of what the other
        does: without either of them little is lost."""
        for cause in list(self.causes):
            for other in [c for c in self.causes if c.score < cause.score]:
                if cause in self.causes and classes.related(cause.domain, other.domain) \
                        and (cause.share or 0.0) + (other.share or 0.0) < SHARED:
                    cause.members[other.effect] = "each does most of what the other does"
                    self.causes.remove(other)

    def _opposed(self):
        """Causes that show in one way and of which one is larger than can be: they make up a
        form that none of them has, each against the others."""
        for cause in self.causes:
            kin = [c for c in self.causes
                   if c is not cause and classes.related(c.domain, cause.domain)]
            if not cause.plausible and kin:
                return [cause, *kin]
        return []

    def _own_share(self, cause):
        """Share of what a cause adds that its plain coefficients reproduce, the best variant
        on each axis: several lags with opposite signs are no slope."""
        gram = sum(u.gram[i] for u, i in zip(self.data.units, self.adequacy.index))
        columns = np.concatenate([c.columns for c in cause.chosen])
        plain = [o for o in self.options if o.effect == cause.effect and o.axis is None
                 and not o.variant.endswith("+")]
        whole = left = 0.0
        for axis in set(cause.axes):
            on = np.array(cause.axes) == axis
            mine, theta = columns[on], cause.theta[on]
            whole += float(theta @ gram[np.ix_(mine, mine)] @ theta)
            variants = [o.columns[np.array(o.axes) == axis] for o in plain]
            apart = classes.reproduced(gram, mine, theta, variants, np.zeros(0, dtype=int))
            left += apart[1] ** 2 if apart else 0.0
        return 1.0 - left / max(whole, 1e-12)

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
        index = adequacy.Adequacy(data, self.chosen, self.allowed).index
        return shrinkage.of(data, self.chosen, index)

    def _shares(self):
        """Each cause's share of the excess: what is lost without it."""
        index = self.adequacy.index
        total = max(adequacy.excess_at(self.data, [], index), 1e-9)
        now = adequacy.excess_at(self.data, self.chosen, index)
        for cause in self.causes:
            rest = [c for c in self.chosen if c not in cause.chosen]
            lost = adequacy.excess_at(self.data, rest, index) - now
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
