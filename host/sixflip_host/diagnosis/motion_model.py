"""What shows in motion only: a sensor off the axis it is turned about, and one behind the other.

All moves of all sessions that go from rest to rest are fitted together (moves_fit.py). The effects
and the strangers of motion (what follows the rate, its size, its products, its change) compete in
the posterior that rests and turns have, too, each session by the others; what a member costs comes
from the moves themselves with their signs drawn by lot (moves_unit.py).
"""
import math
from dataclasses import dataclass, replace

import numpy as np

from sixflip_sim.effects.library import EFFECTS

from ..experiment import inertial_fit
from ..planning import detectable
from . import (
    between_sessions,
    cutoffs,
    discrepancy,
    effect_estimates,
    holdout_gain,
    hypotheses,
    localisation,
    moves_fit,
    moves_unit,
    odds,
    scored_sets,
    turn_model,
)
from .detect.detection import Finding
from .posterior import search_sets

FEWEST_MOVES = 12  # three for each of the four sizes
FOLLOWS = {"speed": "size of the rate", "rates": "rate", "squares": "products of the rates",
           "changes": "change of the rate", "scale": "size of the rate and gravity"}
KNOWN_CM = 5.0  # standard deviation beyond which a direction of the arm is not known


@dataclass(frozen=True, eq=False)
class MotionGap:
    """chip; fit: MovesFit, or None where there are too few moves; Posterior, scores {effect:
    nats}, gains {effect: nats of each alone}; chosen: names in the likeliest set; findings (list
    of Finding), remarks, nameless; theta, covariance of (lever arm x, y, z in cm; the
    accelerometer's delay behind the gyro in ms), sizes: of those found; bare (n, 3) mg of each
    move, less hands' habits and bends; held: HeldMoves or None."""

    chip: str
    fit: moves_fit.MovesFit | None
    posterior: object = None
    scores: dict | None = None
    gains: dict | None = None
    chosen: tuple = ()
    findings: tuple = ()
    remarks: tuple = ()
    nameless: tuple = ()
    theta: np.ndarray | None = None
    covariance: np.ndarray | None = None
    sizes: np.ndarray | None = None
    bare: tuple = ()
    held: holdout_gain.HeldMoves | None = None

    @property
    def seen(self):
        """True when there are moves enough."""
        return self.fit is not None

    @property
    def one_hand(self):
        return self.fit.one_hand

    @property
    def shrinkage(self):
        """gap_figures.Shrinkage, or None where nothing is found."""
        return self.held and self.held.shrinkage

    def with_effect(self, name):
        """The same with an effect among those found, whether it passes the threshold or not."""
        if not self.seen or name not in inertial_fit.EFFECT_NAMES or name in self.chosen:
            return self
        score = self.gains.get(name, 0.0)
        places = {name: {name: odds.probability(score)}, **self.posterior.places}
        return _told(replace(self, chosen=(*self.chosen, name),
                             scores=dict(self.scores, **{name: score}),
                             posterior=replace(self.posterior, places=places)))

    def beside_a_bend(self):
        """The same where the accelerometer bends: a hand's acceleration is read by another scale
        than gravity then, which is no stranger of the rate."""
        if not self.seen:
            return self
        strange = [form for form in self.posterior.best.forms if form.generic]
        scale = [told for form, told in zip(strange, _strange(self.posterior))
                 if form.variant == "scale"]
        return replace(
            self, nameless=tuple(p for p in self.nameless if p not in [told[0] for told in scale]),
            remarks=tuple(w for w in self.remarks if w not in [told[1] for told in scale]))

    def least(self, name):
        """Smallest size that would show, cm or ms."""
        variance = np.sort(np.diag(self.covariance)[moves_fit.EFFECTS[name]])
        if name == "filter_lag":
            variance = variance + self.fit.apart_ms ** 2 / len(np.unique(self.fit.folds))
        return (math.sqrt(2.0 * self.posterior.cost.member) + detectable.POWER_80) * float(
            math.sqrt(variance[(len(variance) - 1) // 2]))

    def floor(self):
        """mg: what is left with the sizes found."""
        return self.fit.rms([y - m.columns[:, :, :4] @ self.sizes
                             for y, m in zip(self.bare, self.fit.moves)])

    def columns(self, extra=()):
        """Columns of nuisances, of strangers and of the effects in the set."""
        strange = [f.columns for f in self.posterior.best.forms if f.generic]
        return np.concatenate([self.fit.nuisance, *strange] + [
            moves_fit.EFFECTS[n] for n in (*self.chosen, *extra)])


def motion_gap(sessions, usable, nominal, gyro, settings):
    """MotionGap, or None where the gyro cannot carry gravity from rest to rest (gyro: SensorGap
    or None)."""
    if gyro is None:
        return None
    others = [s for s in sessions if s not in usable and s.capture.gyro is not None]
    turned = [turn_model.settled(unit, between_sessions.likeliest(unit, gyro.model.usual()))
              for unit in gyro.units if not unit.between]
    return judged([*usable, *others], nominal, turned, sessions[0].capture.meta["sensor"],
                  settings.without)


def judged(sessions, models, turned, chip, without=()):
    """MotionGap of sessions, the first len(models) with poses; models: their NominalSensor;
    turned: their calibrated turns; without: effects left out of the library."""
    moves = moves_unit.moves(sessions, models, turned)
    if len(moves) < FEWEST_MOVES:
        return MotionGap(chip, None)
    fit = moves_fit.fit(moves, chip)
    rounding = max(float(s.rounding_accel.max(initial=0.0)) for s in sessions)
    posterior, gains = _searched(fit, without, rounding)
    posterior = discrepancy.in_motion(fit, posterior)
    chosen = tuple(f.effect for f in posterior.best.forms if not f.generic)
    return _told(MotionGap(chip, fit, posterior, posterior.gains, gains, chosen))


def _searched(fit, without, rounding=0.0):
    """(Posterior of the likeliest set of effects and of strangers of motion, {effect: nats that
    it gains alone}); rounding: mg that it leaves in the means of the rests."""
    competing, everything = np.arange(inertial_fit.COMPETING_NUMBER), np.arange(len(fit.prior))
    others = moves_fit.without_each(fit.gram, fit.inner, fit.prior)
    left = fit.inner - (fit.gram @ others[:, :, None])[:, :, 0]
    designs = moves_unit.designs(fit.prior)
    bins = sum(len(m.table) for m in fit.moves)
    energy = sum((m.table[:, :, competing] ** 2).sum(axis=(0, 1)) for m in fit.moves) / bins
    # A row's two sensors are read at moments of each session's own; and what rounding leaves in
    # the rests is not in the moves, whose readings go through many codes.
    varying = np.where(competing == inertial_fit.LAG, fit.apart_ms, np.where(
        competing >= inertial_fit.EFFECTS_NUMBER, rounding, 0.0))
    units = [moves_unit.unit(
        fit.gram[fit.folds == f], fit.inner[fit.folds == f], left[fit.folds == f], competing,
        everything[len(competing):], fit.prior, energy, designs, varying)
        for f in np.unique(fit.folds)]
    forms = [f for f in hypotheses.forms_of(units, without, drift=False)
             if not f.generic or f.axis is None or f.variant == "speed"]
    model = scored_sets.Model(units, [u.statistics() for u in units], moves_unit.NO_LEVELS)
    # Each at its own cost: few moves of a hand carry most of what it adds, and a form that those
    # few mimic gains ten times in nulls what another does.
    least = cutoffs.least_nats(len(forms))
    own = {form: max(nats, least) for form, nats in cutoffs.simulated_each(
        units, forms, moves_unit.NO_LEVELS, [0] * len(units)).items()}
    posterior = search_sets(model, forms, cutoffs.Cutoffs(least, discrepancy.MOVED, own=own))
    alone = model.scored(())
    return posterior, {f.effect: model.scored((f,)).score - alone.score for f in forms}


def _told(gap):
    """A MotionGap with what its set says: findings, sizes, figures on what is held out."""
    others = [n for n in inertial_fit.EFFECT_NAMES if n not in gap.chosen]
    theta, covariance = gap.fit.sizes(gap.columns(others))
    strange = _strange(gap.posterior)
    nameless, remarks = [p for p, _ in strange], [words for _, words in strange]
    gap = replace(gap, theta=theta, covariance=covariance, findings=[], nameless=tuple(nameless),
                  remarks=tuple(remarks), held=None)
    if not gap.chosen:
        return gap
    sizes, spread = gap.fit.sizes(gap.columns())
    findings = []
    for name in gap.chosen:
        finding = _finding(name, sizes, np.sqrt(np.diag(spread)), gap.scores[name],
                           gap.posterior.places[name])
        if not effect_estimates.believable(name, gap.chip, finding.sensor, finding.value):
            remarks.append("in motion %s would help, but at an impossible size: something else "
                           "acts" % name.replace("_", " "))
            nameless.append(localisation.Place("accel", None, "motion", 1.0,
                                               odds.chance(finding.score)))
        elif name == "lever_arm" and gap.one_hand:
            remarks.append("turned about a point %.1f cm from the accelerometer: the hand's grip "
                           "or the box, flips on a table tell"
                           % np.linalg.norm(list(finding.value.values())))
        else:
            findings.append(finding)
    named = np.isin(np.arange(4), [i for f in findings for i in moves_fit.EFFECTS[f.effect]])
    gap = replace(gap, sizes=sizes * named, bare=tuple(gap.fit.bare(gap.columns(), named)),
                  nameless=tuple(nameless), remarks=tuple(remarks))
    if not findings:
        return gap
    held = holdout_gain.held_moves(gap, named, spread * named * named[:, None])
    if not held.alone:
        remarks.append("no session alone shows all that was found in motion: it was held out by "
                       "every other move")
    remarks.append("what was found in motion is judged on %d moves; what the hand adds counts as "
                   "noise there" % len(gap.fit.moves))
    return replace(gap, held=held, remarks=tuple(remarks), findings=[
        replace(finding, share=holdout_gain.share_of_effect(gap, held, finding.effect))
        for finding in findings])


def _strange(posterior):
    """[(Place, sentence)] of what has no name in the likeliest set, axis by axis where it is on
    one."""
    total, strange = max(sum(map(abs, posterior.gains.values())), 1e-9), []
    for form in posterior.best.forms:
        if form.generic:
            gain = posterior.gains[form.effect]
            axis = None if form.axis is None else "xyz"[form.axis]
            place = localisation.Place("accel", axis, "motion", gain / total, odds.chance(gain))
            strange.append((
                place, "what the accelerometer reads in motion follows the %s in a way that no "
                "effect of the library does" % FOLLOWS[form.variant]))
    return strange


def _finding(name, sizes, sigma, score, place):
    """Finding of an effect in motion, sizes (4,) and sigma (4,)."""
    if name == "lever_arm":
        known = [i for i in range(3) if sigma[i] < KNOWN_CM]
        value = {"xyz"[i]: float(sizes[i]) for i in known}
        interval = {"xyz"[i]: (float(sizes[i] - odds.Z_90 * sigma[i]),
                               float(sizes[i] + odds.Z_90 * sigma[i])) for i in known}
        return Finding(name, "accel", [], value, EFFECTS[name].units["accel"], score, "motion",
                       "it sits %.1f cm off the point it is turned about"
                       % np.linalg.norm(list(value.values())), interval, place=place)
    sensor, tau = ("accel", sizes[3]) if sizes[3] > 0 else ("gyro", -sizes[3])
    return Finding(name, sensor, [], {"tau": float(tau)}, "ms", score, "motion",
                   "it is %.1f ms behind the other sensor; how late both are together shows "
                   "nowhere" % tau,
                   {"tau": (float(tau - odds.Z_90 * sigma[3]), float(tau + odds.Z_90 * sigma[3]))},
                   place=place)
