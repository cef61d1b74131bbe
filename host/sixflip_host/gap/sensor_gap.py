"""Stages 1 and 3 to 6 for one sensor: accelerometer or gyro, over the rests of all sessions."""
import numpy as np

from sixflip_sim.effects.library import EFFECTS

from . import (
    adequacy,
    between,
    classes,
    crooked,
    nominal_fit,
    regressors,
    selection,
    shrinkage,
    sizes,
    thresholds,
    which,
)

ALONG_FREEDOM = 10  # contrasts along gravity that a half of a session must have
DRIFT_NATS = 6.0
JUMP_NATS = 3.0  # what a jump at an unknown time costs in each session
LEAST_BOX_DEG = 0.1  # below that a placement by hand is as crooked
KEPT_SHARE = 0.6  # of the excess, below which a name is no explanation where noise does not fit
MOST_OF_ONE = 2  # causes that one session, held out against itself, can be believed to show
STAND_IN = 0.8  # of the gain of several names
OWN_SHARE = 0.5  # of a bent effect that must be the effect itself
SESSION_NATS = 8.0  # log evidence at which what is left varies in time beyond doubt


class SensorGap:
    """units, data, options, thresholds, chosen, causes, adequacy, shrinkage; unexplained: bool;
    added: {domain: nats} of generic discrepancies beyond the causes; drift: level or None."""

    def __init__(self, kind, sessions, nominal, settings):
        self.kind, self.sessions, self.nominal = kind, sessions, nominal
        self.settings = settings
        self.chip = sessions[0].capture.meta["sensor"]
        self.parts = [(s, m) for s, m in zip(sessions, nominal)]
        parts = self.parts
        regressors.agree(sessions)
        self.units = [self._unit(part, model, settings.certified) for part, model in parts]
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

    def _unit(self, part, model, certified):
        reference = self.settings.reference_c
        designs = regressors.library(part, model.up, self.kind, reference, self.chip)
        if self.kind == "accel":
            designs.append(regressors.of_terms("box_tilt", "accel", part.moment(model.up), part.n,
                                               chip=self.chip))
        designs += regressors.generics(part, model.up, self.kind)
        designs = [d for d in designs if not (certified and d.effect == "box_tilt")]
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
        enough = (STAND_IN * total if len(self.causes) > 1 else total + DRIFT_NATS)
        return any(gain > enough and not any({domain, d} <= kin for kin in classes.KIN
                                             for d in domains)
                   for domain, (gain, _) in adequacy.generic_gains(
                       self.data, self.options, []).items())

    def _box(self):
        """Crooked faces: tested beside the causes found, with the box no longer a nuisance.

        Twelve free angles take up much that is none: they are looked for last, where all else
        is explained and nothing in the registers moves readings near zero.
        """
        if self.unexplained or self.drift or self.settings.coarse or max(
                s.rounding_accel.max() for s in self.sessions) > nominal_fit.COARSE_MG:
            return
        units = [self._unit(part, model, True) for part, model in self.parts]
        for unit, (part, model) in zip(units, self.parts):
            self._with_box(unit, part, model)
        data = which.Data(units)
        options = [o for o in which.candidates(units) if not o.generic
                   and o.effect not in self.settings.without]
        mine = [o for o in options if o.effect == "box_tilt"]
        if not mine:
            return
        limit = thresholds.of(units, mine, self.levels(data)).named
        # All axes and terms of the causes: here they show across gravity, too.
        same = [o for o in options if o.axis is None and o.variant.rstrip("+") in {
            c.variant.rstrip("+") for c in self.chosen if c.effect == o.effect}
            and not o.variant.endswith("+")]
        same += [o for o in options if o.axis is None and not o.variant and o not in same
                 and o.effect in {c.effect for c in self.chosen}]
        best, gain = selection.best_of(which.gains(data, mine, same))
        if best is not None and gain > limit:
            visible = {o.effect for o in self.options}
            rivals = [o for o in options if o.effect == "box_tilt" or o.effect not in visible]
            found = classes.causes(data, rivals + same, same + [best])
            self.box_data = data
            box = [c for c in found if c.effect == "box_tilt"]
            self._fill(box)
            self.causes += [c for c in box
                            if max(map(abs, c.value.values()), default=0.0) >= LEAST_BOX_DEG]

    def _with_box(self, unit, part, model):
        """Give a unit made without a box its columns, so that both sets have one order."""
        design = regressors.of_terms("box_tilt", "accel", part.moment(model.up), part.n,
                                     chip=self.chip)
        unit.designs = unit.designs + [design]
        columns = unit.contrasts.T @ design.columns
        unit.silent = np.concatenate([unit.silent, (columns ** 2).sum(axis=0)
                                      <= nominal_fit.NOTHING * (design.columns ** 2).sum(axis=0)
                                      ])
        unit.columns = np.hstack([unit.columns, columns])
        unit._whiten()

    def _judge(self):
        """Adequacy, drift, plausibility, shrinkage."""
        self._adequate()
        self.drift = None
        if not self.adequacy.ok and not self.added and "drift" not in self.settings.without:
            self._drift()
        self.unexplained = (not self.adequacy.ok or bool(self.added)) and self.drift is None
        self._shares()
        doubted = [c for c in self.causes if self._doubted(c)]
        if doubted:
            self.chosen = [o for o in self.chosen if not any(o in c.chosen for c in doubted)]
            self.causes = [c for c in self.causes if c not in doubted]
            self._adequate()
            self.unexplained = True
            self._shares()
        if self.options and self.kind == "accel" and not self.settings.certified \
                and "box_tilt" not in self.settings.without:
            self._box()
        self.shrinkage = self._shrink()

    def _adequate(self):
        """adequacy, and added: {domain: nats} of the generic discrepancies that add."""
        self.adequacy = adequacy.Adequacy(self.data, self.chosen, self.allowed)
        self.added = {}
        if not self.options:
            return
        gains = adequacy.generic_gains(self.data, self.options, self.chosen)
        self.added = {d: g for d, (g, _) in gains.items() if g > self.limits.generic + 2.0}
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
        left varies in the very way that it should have explained."""
        if self._own_share(cause) < OWN_SHARE:
            return True
        if not self.unexplained:
            return False
        return cause.domain in self.added or (cause.share or 0.0) < KEPT_SHARE

    def _own_share(self, cause):
        """Share of what a cause adds that its plain coefficients reproduce."""
        gram = sum(u.gram[i] for u, i in zip(self.data.units, self.adequacy.index))
        columns = np.concatenate([c.columns for c in cause.chosen])
        plain = np.array([not k.endswith("+") for k in cause.keys])
        if plain.all():
            return 1.0
        whole = float(cause.theta @ gram[np.ix_(columns, columns)] @ cause.theta)
        left = classes.reproduced(gram, columns, cause.theta, [columns[plain]],
                                  np.zeros(0, dtype=int))
        return 1.0 - left[1] ** 2 / max(whole, 1e-12)

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
        data = which.Data([self._unit(p, m, self.settings.certified) for p, m in parts])
        index = adequacy.Adequacy(data, self.chosen, self.allowed).index
        return shrinkage.of(data, self.chosen, index)

    def _drift(self):
        """More flicker than is allowed: drift if the rests themselves wander, and all that is
        left looks like it."""
        columns = np.concatenate([c.columns for c in self.chosen] + [np.zeros(0, dtype=int)])
        prior = np.concatenate([c.prior for c in self.chosen] + [np.zeros(0)])
        free = which.fits(self.data, columns, prior)
        level = max(u.grid[f.index[0]][1] for u, f in zip(self.units, free))
        if level <= self.allowed * 1.001:
            return
        gain = sum(float(f.loglik[0]) - at_level(u, s, columns, prior, self.allowed)
                   for u, f, s in zip(self.units, free, self.data.statistics))
        seen = expected = 0.0
        least = 1.0
        for (part, _), unit, fit in zip(self.parts, self.units, free):
            values = part.accel if self.kind == "accel" else part.gyro
            noise = part.noise_accel if self.kind == "accel" else part.noise_gyro
            found = adequacy.wandering(part, values, noise, unit.grid[fit.index[0]][1])
            if found:
                seen, expected = seen + found[0], expected + found[1]
                least = min(least, found[2])
        free_ratio = sum(float(f.quadratic[0]) for f in free) / max(
            1, sum(u.freedom for u in self.units) - len(columns))
        if gain > DRIFT_NATS and seen > 0.4 * expected and least < 1e-3 and free_ratio < 1.6 \
                and self._jumps(free) < gain - DRIFT_NATS / 2.0:
            self.drift = (level, gain)

    def _jumps(self, fits):
        """Nats that one jump in each session gains, with no more flicker than is allowed: what
        jumps once does not drift."""
        total = 0.0
        for (part, _), unit, fit in zip(self.parts, self.units, fits):
            placement = unit.grid[fit.index[0]][0]
            factor = np.linalg.cholesky(unit.covariance(placement, self.allowed))
            z = np.linalg.solve(factor, unit.z)
            best = 0.0
            for start in np.unique(part.placement)[1:]:
                step = np.kron((part.placement >= start)[:, None], np.eye(3))
                columns = np.linalg.solve(factor, unit.contrasts.T @ step)
                size = np.linalg.lstsq(columns, z, rcond=1e-9)[0]
                best = max(best, 0.5 * float(z @ columns @ size) - JUMP_NATS)
            total += best
        return total

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


def at_level(unit, statistics, columns, prior, allowed):
    """Largest log-likelihood with no more flicker than allowed."""
    quadratic, projections = statistics
    fit = which.Fit
    keep = [i for i, (_, level) in enumerate(unit.grid) if level <= allowed * 1.001]
    return max(float(fit(_Point(unit, i), (quadratic[i:i + 1], projections[i:i + 1]), columns,
                         prior).loglik[0]) for i in keep)


class _Point:
    """One point of a unit's grid, for which.Fit."""

    def __init__(self, unit, index):
        self.grid = unit.grid[index:index + 1]
        self.gram, self.logdet = unit.gram[index:index + 1], unit.logdet[index:index + 1]


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
