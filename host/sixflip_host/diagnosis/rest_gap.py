"""What one long rest, or several in one attitude, say, on the one model.

The hypotheses of rest_forms.py compete in the posterior that the poses are judged by, on the
units of rest_units.py, whose figures are held out in time.
"""
from dataclasses import dataclass, replace

import numpy as np

from sixflip_sim.effects.drift import FLOOR_OF_KERNEL

from .. import progress
from ..experiment import long_rest, terms
from . import (
    adequacy,
    aliases,
    between_sessions,
    cutoffs,
    effect_estimates,
    gap_figures,
    hypotheses,
    leaps,
    members,
    odds,
    rest_forms,
    rest_units,
    scored_sets,
    wandering,
)
from .localisation import Place
from .posterior import HOLDS, search_sets

BENT = 4.0  # standard deviations of its square or cube at which an axis is bent
MEANS = 12  # fewer say nothing of how a reading goes on
SETTLES_S = 30.0  # so long tyres, springs and contacts of a robot that has stopped may still creep
SETTLED = "session"  # the level by which one rest differs from the next


@dataclass(frozen=True)
class RestCause:
    """One effect, or one class of effects, on the axes that show it: names (the likeliest
    first), place ({name: probability} of what stands here), score (nats), value and interval by
    axis, unit, plausible, share of the excess, domain; variant and shape (see hypotheses.Form)
    of the first name."""

    names: tuple
    place: dict
    score: float
    value: dict
    interval: dict
    unit: str
    plausible: bool
    share: object
    domain: str
    variant: str = ""
    shape: tuple = ()

    @property
    def effect(self):
        return self.names[0]

    @property
    def probabilities(self):
        """{name: probability} of the names of its class."""
        return {name: self.place.get(name, 0.0) for name in self.names}

    @property
    def nameless(self):
        """Probability that what stands here has no name."""
        return odds.nameless(self.place) - self.place.get(SETTLED, 0.0)

    @property
    def letters(self):
        return sorted({key[0] for key in self.value})


@dataclass(frozen=True)
class RestGap:
    """One sensor: kind, rest (LongRest), causes (tuple of RestCause), places (tuple of Place),
    nameless (probabilities that something without a name is there), sums (one gap_figures.Sums
    an axis), looked_at (names of effects)."""

    kind: str
    rest: long_rest.LongRest
    causes: tuple
    places: tuple
    nameless: tuple
    sums: tuple
    looked_at: frozenset

    @property
    def shrinkage(self):
        """gap_figures.Shrinkage of the three axes together."""
        return sum(self.sums[1:], self.sums[0]).shrinkage(self._named)

    @property
    def by_axis(self):
        """{"x": gap_figures.Shrinkage, ...}"""
        return {k: sums.shrinkage(self._named) for k, sums in zip("xyz", self.sums)}

    @property
    def _named(self):
        return any(c.effect != "drift" for c in self.causes)  # noise cannot be foretold

    def reason(self, name):
        """Why an effect could not be seen in this rest; "" where it could."""
        if name in self.looked_at:
            return ""
        return rest_forms.limits(self.rest, self.kind, name) or "needs rests in several poses"


def gaps_by_sensor(sessions, settings, lines=(), least_s=0.0, tones=()):
    """{sensor: RestGap} of blocks.Sessions, {} where nothing rests for long enough; least_s: of
    the longest rest; tones: (sensor, axis letter) that a tone without a steady frequency moves."""
    rest = long_rest.in_one_attitude(sessions, lines)
    if rest is None or rest.n < MEANS or np.bincount(rest.rest, rest.seconds).max() < least_s:
        return {}
    chip = sessions[0].capture.meta["sensor"]
    return {kind: of_one_sensor(rest, kind, chip, settings, _jumps(sessions, kind, tones))
            for kind in rest.values}


def _jumps(sessions, kind, tones):
    """[probability] of the longest rest's axes having tails as heavy as they have by noise; what
    a tone does to the means is no leap."""
    session = max(sessions, key=lambda s: np.subtract(*(long_rest.longest(s) or (0, 0))[::-1])
                  / s.rate)
    first, end = long_rest.longest(session)
    rest = long_rest.scaled(session, kind)[first:end]
    return [1.0 if (kind, axis) in tones else leaps.jumps([x], session.rate)
            for axis, x in zip("xyz", rest.T)]


def of_one_sensor(rest, kind, chip, settings, jumps=(1.0, 1.0, 1.0), flickers=1.0):
    """RestGap of a LongRest; flickers: times that of one log that it has."""
    progress.doing("the %s at rest" % ("gyro" if kind == "gyro" else "accelerometer"))
    units = rest_units.axis_units(rest, kind, chip, settings)
    data = gap_figures.data_of(units)
    flicker, reference = flickers * adequacy.usual(chip, kind), settings.reference.get(kind)
    levels = rest_units.levels(rest, kind, flicker if reference is None else max(
        reference, flicker / 4.0), reference is not None)
    several = int(rest.rest.max()) > 0
    forms = [f for f in hypotheses.forms_of(units, settings.without)
             if several or f.effect != SETTLED]
    model = scored_sets.Model(units, data.statistics, levels)
    posterior = search_sets(model, forms, cutoffs.for_protocol(units, forms, levels))
    fits = adequacy.goodness_of_fit(units, data.statistics, posterior.best, levels)
    chosen = [f for f in posterior.best.forms if not f.generic and len(f.shared)]
    strange = [(f, ["xyz"[axis] for axis, _ in members.axes_of(model, posterior, f)])
               for f in posterior.best.forms
               if f.generic and not _settled(f, units, fits, levels, rest, kind)]
    causes = [members.in_full(model, forms, posterior, cause) for cause in aliases.causes(
        posterior, units, forms, rest.temperature is not None)]
    told = [_told(c, data, fits, chip, kind, chosen, rest_forms.place(
        c, model, forms, posterior, rest)) for c in causes]
    beaten = [c for c, rest_cause in zip(causes, told) if _beaten(rest_cause, strange, posterior)]
    chosen = [f for f in chosen if not any(f in c.chosen for c in beaten)]
    told = [rest_cause for c, rest_cause in zip(causes, told) if c not in beaten]
    # What goes to and fro between levels, or straight on, is no drift, however little it wanders.
    other = {k: p for k, p in zip("xyz", jumps) if p < odds.CHANCE}
    if "drift" in posterior.best.names:
        straight = leaps.goes_straight(rest, kind, flicker)
        other |= {k: p for k, p in straight.items() if p < odds.CHANCE}
        told += _drift(posterior, units, data, levels, kind, chosen, fits.index, other)
    places = [Place(kind, letter, c.domain, 1.0 if c.share is None else c.share,
                    np.exp(-min(c.score, 600.0))) for c in told for letter in c.letters]
    for form, letters in strange:
        gain = np.exp(-min(posterior.gains[form.effect], 600.0))
        places += [Place(kind, k, hypotheses.domain(form.effect), 1.0, gain)
                   for k in letters or [None]]
    places += [Place(kind, letter, "time", 1.0, p) for letter, p in other.items()]
    if not fits.ok and not places:
        places = [Place(kind, None, "time", 1.0, fits.p)]
    return RestGap(kind, rest, tuple(told), tuple(places),
                   (*(1.0 - posterior.places[f.effect].get("", 0.0) for f, _ in strange),
                    *([] if fits.ok else [1.0 - fits.p]), *(1.0 - p for p in other.values())),
                   tuple(rest_units.held_out(rest, unit, chosen, point, levels)
                         for unit, point in zip(units, fits.index)),
                   frozenset(f.effect for f in forms))


def _settled(form, units, fits, levels, rest, kind):
    """Whether a member of the set is no more than what switching on again, or putting down
    again, does to a reading; a gyro that stays on reads the same again."""
    return form.effect == SETTLED and (kind == "accel" or np.ptp(rest.session) > 0) and all(
        u.grid[k][0] <= max(between_sessions.UNUSUAL["bias"][kind], levels.usual(u)[0])
        for u, k in zip(units, fits.index))


def _told(cause, data, fits, chip, kind, chosen, place):
    """RestCause of an aliases.Cause; where the change from one rest to the next may be no more
    than that, what does it is among the names. Its share: what is lost without it."""
    cause = _with_bent(effect_estimates.sized(cause, data, list(fits.index), chip, kind), data,
                       list(fits.index))
    names = cause.names
    if place.get("drift", 0.0) > 1.0 - HOLDS:
        names = [*names, "drift"]  # one walk in many goes the way of a warm-up
    if place.get(SETTLED, 0.0) > 1.0 - HOLDS:
        names = [*names, "drift", *(["table_tilt"] if kind == "accel" else [])]
    rest = [form for form in chosen if form not in cause.chosen]
    share = gap_figures.excess_share(data.units, data.statistics, fits.index, (rest, fits.index),
                                     (chosen, fits.index))
    return RestCause(tuple(dict.fromkeys(names)), dict(place), cause.score, cause.value,
                     cause.interval, cause.unit, cause.plausible, share,
                     terms.DOMAIN[cause.effect], cause.variant, cause.shape)


def _beaten(cause, strange, posterior):
    """Whether something without a name says more on every axis of a cause: what the name gains
    may be no more than a part of that."""
    return bool(cause.letters) and all(any(
        (not letters or letter in letters) and posterior.gains[form.effect] > cause.score
        for form, letters in strange) for letter in cause.letters)


def _with_bent(cause, data, index):
    """The cause with the axes whose reading only bends: their slope is next to nothing, and is
    said so."""
    ratios = np.abs(cause.theta) / np.sqrt(np.maximum(np.diag(cause.covariance), 1e-300))
    powers = cause.chosen[0].powers
    missing = {"xyz"[axis] for power, axis, ratio in zip(powers, cause.axes, ratios)
               if power > 1 and ratio > BENT} - set(cause.letters)
    if not missing:
        return cause
    theta, covariance = effect_estimates.effective(
        cause, sum(u.gram.at(i) for u, i in zip(data.units, index)))
    half = {key: odds.Z_90 * float(spread) for key, spread in zip(
        theta, np.sqrt(np.diag(covariance))) if key in missing}
    return replace(cause, value={**cause.value, **{key: float(theta[key]) for key in half}},
                   interval={**cause.interval, **{
                       key: (float(theta[key] - half[key]), float(theta[key] + half[key]))
                       for key in half}}, letters=sorted({*cause.letters, *half}))


def _drift(posterior, units, data, levels, kind, chosen, index, other):
    """[RestCause] of a drift in the likeliest set: its Allan floor on the axes that wander more
    than is usual and do nothing other, with a 90 % interval by the profile of the likelihood."""
    value, interval, free = {}, {}, frozenset(["flicker"])
    for key, unit, statistics in zip("xyz", units, data.statistics):
        course = wandering.by_flicker(unit, statistics, posterior.best.shared,
                                            levels.prior(unit, free))
        level, low, high = wandering.profile(sorted({b for _, b in unit.grid}), course)
        if low > levels.flicker and key not in other:
            value[key] = level * FLOOR_OF_KERNEL
            interval[key] = (low * FLOOR_OF_KERNEL, high * FLOOR_OF_KERNEL)
    if not value:
        return []
    share = gap_figures.drift_share(units, data.statistics, posterior.best, chosen, index, levels)
    return [RestCause(("drift",), dict(posterior.places["drift"]), posterior.gains["drift"], value,
                      interval, "mg" if kind == "accel" else "deg/s", True, share, "time")]
