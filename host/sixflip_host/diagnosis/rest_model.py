"""Stages 1 and 3 to 6 for one sensor: accelerometer or gyro, over the rests of all sessions."""
from dataclasses import dataclass, replace

import numpy as np

from .. import progress
from ..experiment import attitude_fit, block_measures, linear_model, nominal_rows, session_terms
from ..experiment.terms import corrected, of_terms
from . import (
    adequacy,
    aliases,
    between_sessions,
    box_tilt_test,
    cutoffs,
    evidence,
    gap_figures,
    holdout_gain,
    hypotheses,
    leaps,
    members,
    scored_sets,
    session_strangers,
    strangers,
    wandering,
)
from .posterior import judge_likeliest, search_sets
from .sensor_gap import DOUBT, SensorGap
from .settings import Conditions, Settings

SECOND_ORDER_CHI2 = 2.0  # of what turned poses change in a cause: one nat, at most
JUDGED_AGAIN = 3  # times, at most, that a set is with what a walk does beside the rest of it
SHRUNK = 0.1  # of the usual sizes: of what next to nothing is known, next to nothing


@dataclass(frozen=True)
class RestModel:
    """The model of one sensor at rest: kind "accel" or "gyro", chip, and what was asked for and
    holds for all of its sessions."""

    kind: str
    chip: str
    settings: Settings
    conditions: Conditions = Conditions()
    drifts = True  # whether noise may wander
    left_in = "noise"  # the domain of what is left that no hypothesis takes up
    form = 0.02  # cutoffs.Cutoffs.form

    def fit(self, sessions, nominal):
        """SensorGap of sessions with their NominalSensors."""
        progress.doing("effects of the %s" % ("gyro" if self.kind == "gyro" else "accelerometer"))
        heard = [self._heard(session) for session in sessions]
        parts = list(zip(session_terms.agreed(heard), nominal))
        searched = self._searched(parts)
        turned = self._turned_back(parts, searched)
        if turned:
            refitted = self._searched(turned, searched[-1].best.forms)
            if refitted[-1].best.score > searched[-1].best.score:
                parts, searched = turned, refitted
        units, data, options, noise, forms, cost, model, posterior = searched
        best = posterior.best
        causes = [members.in_full(model, forms, posterior, cause)
                  for cause in aliases.causes(posterior, units, forms, all(
                      session.thermometer for session, _ in parts))]
        fitted = adequacy.goodness_of_fit(
            units, data.statistics, best, noise, self.conditions.shaken.get(self.kind, ()),
            self.kind == "accel")
        chosen = [f for f in best.forms if not f.generic and len(f.shared)]
        drift = wandering.drift(self.kind, [session for session, _ in parts], units, data, noise,
                                posterior, fitted, chosen)
        odd, p = leaps.no_drift(self.kind, parts, drift) if drift else ("", 1.0)
        if p < adequacy.DOUBTFUL_P:
            drift, fitted = None, replace(fitted, ok=False, odd=odd, p=min(p, fitted.p))
        nameless = [f for f in best.forms if f.generic]
        doubted = any(posterior.stranger_share(c.effect) > DOUBT for c in causes)
        crooked = [box_tilt_test.squareness(*part) for part in parts
                   if self.kind == "accel"]
        gap = SensorGap(
            self, parts, units, data, options, forms, noise, cost, posterior,
            chosen, nameless, causes, fitted,
            {f.effect: members.axes_of(model, posterior, f) for f in nameless},
            drift, not fitted.ok or bool(nameless) or doubted, crooked)
        gap = replace(gap, causes=gap.sized(causes, data)).without_parts(model)
        gap = self.shrunk(gap)
        held = gap.refuted(model)
        return self._tilted(gap if held is gap else self.shrunk(held))

    def _searched(self, parts, likeliest=None):
        """(units, data, options, noise, forms, cost, model, Posterior): the likeliest sets of
        causes, with all that they were looked for with, of [(Session, NominalSensor)]; likeliest:
        the set that was found at other poses."""
        units = [self.unit(*part, self.settings.certified) for part in parts]
        units += self.between(units, parts)
        data = gap_figures.data_of(units)
        options = hypotheses.by_fleet(
            hypotheses.forms_of(units, self.settings.without, self.drifts), self.kind,
            self.settings.prior)
        noise = self.usual()
        # A square beside a slope is for the board's record; here a discrepancy stands for it.
        forms = [f for f in options if not f.record]
        cost = replace(cutoffs.for_protocol(units, [f for f in forms if not f.instead], noise),
                       form=self.form)
        model = scored_sets.Model(units, data.statistics, noise)
        progress.doing("what explains it best")
        posterior = search_sets(model, forms, cost) if likeliest is None \
            else judge_likeliest(model, forms, cost, likeliest)
        for _ in range(JUDGED_AGAIN):
            if not wandering.walks_beside_others(posterior.best):
                break
            # What else is there moves within the rests as well.
            before = posterior.best.names
            units = [replace(unit, within=self._within(parts[place][0], wandering.beside_others(
                unit, sums, posterior.best, place))) if not unit.between else unit
                for place, (unit, sums) in enumerate(zip(units, data.statistics))]
            model = scored_sets.Model(units, data.statistics, noise)
            posterior = judge_likeliest(model, forms, cost, posterior.best.forms)
            if posterior.best.names == before:
                break
        return units, data, options, noise, forms, cost, model, posterior

    def _turned_back(self, parts, searched):
        """The parts with NominalSensors fitted without all that any effect adds; None where that
        changes next to nothing. A nominal sensor takes up what it can of a large cause and turns
        the poses with it, at which all columns are evaluated: the second order of a cause, which
        would pass for another (a Gauss-Newton step, of all columns together: the causes found
        may be the wrong ones)."""
        units, best = searched[0], searched[-1].best
        if self.kind != "accel" or not len(best.shared):
            return None
        sizes = evidence.coefficients(best.fits, best.shared)[0][0]
        free = np.concatenate([np.full(len(d.keys), not (d.choices or d.record))
                               for d in units[0].designs])
        every = np.flatnonzero(free)
        prior = np.concatenate([(1.0 if d.generic else hypotheses.TYPICAL) * d.prior
                                for d in units[0].designs])[every]
        points = [int(fit.index[0]) for fit in best.fits]
        gram = sum(u.gram.at(k, every) for u, k in zip(units, points))
        theta = np.linalg.solve(gram + np.diag((SHRUNK * prior) ** -2.0),
                                sum(u.inner[k][every] for u, k in zip(units, points)))
        turned, chi2 = [], 0.0
        for (session, nominal), unit in zip(parts, units):
            added = (unit.raw(every) @ theta).reshape(-1, 3)
            less = attitude_fit.fit(session, added @ np.linalg.inv(nominal.matrix).T)
            angle = np.linalg.norm(less.up - nominal.up, axis=1)[session.placement][:, None]
            changed = 2.0 * angle * (unit.raw(best.shared.index) @ sizes).reshape(-1, 3)
            chi2 += float((changed ** 2 * session.seconds[:, None]
                           / session.noise_accel ** 2).sum())
            turned.append((session, less))
        return turned if chi2 > SECOND_ORDER_CHI2 else None

    def _tilted(self, gap):
        """The gap with a crooked box among its causes where there is one."""
        if self.kind == "accel" and not self.settings.certified \
                and "box_tilt" not in self.settings.without and box_tilt_test.possible(gap):
            progress.doing("whether the box is square")
            box, data = box_tilt_test.search(gap)
            gap = replace(gap, causes=gap.causes + gap.sized(box, data))
        if box_tilt_test.bent(gap.causes):
            gap = replace(gap, crooked=[])  # a nonlinearity leans the faces as well
        return gap

    def shrunk(self, gap):
        """With the shrinkage on the sessions held out; with one session on its halves, where
        they can be had."""
        progress.doing("how far the gap shrinks on what is held out")
        data, index = gap.data, gap.adequacy.index
        strange = hypotheses.columns_of(gap.strangers)
        private = [own + strange for own in gap.posterior.best.private]
        if gap.same_session and gap.chosen:
            certified = self.settings.certified
            parts = holdout_gain.halves(self.kind, *gap.parts[0], certified)
            if parts:
                wanted = hypotheses.columns_of(gap.chosen).index
                data = gap_figures.data_of([self.unit(*part, certified, wanted)
                                            for part in parts])
                index, private = gap.halved_levels(data), None
        return replace(gap, shrinkage=holdout_gain.shrinkage(
            data, gap.chosen, index, gap.noise, gap.wanders, private))

    def usual(self):
        """evidence.Levels of this sensor."""
        return adequacy.levels(self.chip, self.kind, self.settings.reference.get(self.kind))

    def unit(self, part, model, certified, wanted=None):
        """Unit of one session; certified: the box is no nuisance; wanted: see
        linear_model.unit."""
        reference = self.conditions.reference_c
        rows = self._banded(nominal_rows.rows(self.kind, part, model, certified), part)
        designs = session_terms.library(part, model.up, self.kind, reference, self.chip)
        if self.kind == "accel":
            designs += session_terms.along_axes(part, model, self.chip)
            designs.append(of_terms("box_tilt", "accel", part.moment(model.up), part.n,
                                    chip=self.chip))
        designs += strangers.shared(part, model.up, self.kind, reference)
        designs += session_strangers.private(part, model.up, self.kind, rows.left())
        if self.kind == "accel":
            designs = corrected(designs, model.matrix)
        if self.settings.certified:
            designs = [d for d in designs if d.effect != "box_tilt"]
        return linear_model.unit(self._less_known(rows, designs), designs, wanted,
                                 signature=nominal_rows.signature(part),
                                 within=self._within(part))

    def _heard(self, session):
        """The session, how much it shakes told by axes without a dead band: within it an axis is
        silent, and at its edge it leaps."""
        deaf = self.conditions.banded.get("accel", ())
        if not deaf or session.accel is None:
            return session
        return replace(session, loudness=block_measures.loudness(
            session.capture, session.first, session.end, np.delete(np.arange(3), deaf)))

    def _banded(self, rows, part):
        """The rows where what a dead band takes off on either side of 0, known to some counts
        only, is a nuisance of its axes. A gyro rests within its band, and what such an axis reads
        then is one: it says nothing of the Earth's rate, which the others feel."""
        axes = self.conditions.banded.get(self.kind, ())
        if not axes or self.kind == "gyro" and len(axes) == 3:
            return rows
        if self.kind == "gyro":
            own = np.eye(3 * part.n)[:, np.isin(np.arange(3 * part.n) % 3, axes)]
            return replace(rows, nuisance=np.hstack([rows.nuisance, own]))
        columns = np.zeros((part.n, 3, len(axes)))
        for number, axis in enumerate(axes):
            columns[:, axis, number] = np.sign(np.rint(part.accel[:, axis]))
        return replace(rows, nuisance=np.hstack([rows.nuisance, columns.reshape(-1, len(axes))]))

    def _within(self, part, explained=0.0):
        """{(effect, variant, number of its choice): nats}: what the rests say of each walk, and
        what the choice of a period or of a step costs; explained: see wandering.within_rests."""
        return {**wandering.walks_within_rests(part, self.kind, self.chip, explained),
                **session_strangers.looked_at(
                    part.t, len(hypotheses.PARTS) * len(hypotheses.WIDTHS))}

    def between(self, units, parts):
        """[Unit of what lies between the sessions], none where there is nothing between; parts:
        [(Session, NominalSensor)]."""
        return between_sessions.of_rests(self.kind, units, parts, self.usual())

    def _less_known(self, rows, designs):
        """The rows without what the simulator compared with predicts already."""
        known = self.settings.simulated.get(self.kind, ())
        every = [(d.effect, d.variant, key) for d in designs for key in d.keys]
        sizes = np.zeros(len(every))
        for effect, variant, key, size in known:
            if (effect, variant, key) in every:
                sizes[every.index((effect, variant, key))] += size
        if not sizes.any():
            return rows
        return replace(rows, y=rows.y - np.hstack([d.columns for d in designs]) @ sizes)
