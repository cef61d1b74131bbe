"""What one long rest, or several in one attitude, say, on the one model.

The hypotheses of rest_forms.py compete in the posterior that the poses are judged by; flicker
and the change from one rest to the next are its levels. The figures are held out in time: the
rest is cut into pieces, every fourth one is foretold from the others.
"""
from dataclasses import dataclass, replace

import numpy as np

from .. import progress
from ..experiment import covariance, linear_model, long_rest, nominal_rows, terms
from ..experiment.flicker import flicker_kernel
from . import (
    adequacy,
    aliases,
    coefficient_fits,
    cutoffs,
    effect_estimates,
    evidence,
    holdout_gain,
    hypotheses,
    odds,
    posterior,
    rest_forms,
    session_offsets,
)
from .localisation import Place

# From one rest to the next where nothing was moved, beyond flicker: the Allan floor of the parts
# (typical.FLOOR); a gyro's is the Earth's rate, should the box have been put down again.
OFFSET = {"accel": 0.1, "gyro": 0.003}
OFFSETS = {"accel": (0.1, 0.3, 1.0, 3.0, 12.0), "gyro": (0.003, 0.01, 0.05, 0.3, 1.0)}
FLICKERS = {"accel": (0.005, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 4.0, 12.0, 40.0),
            "gyro": (0.0002, 0.001, 0.002, 0.004, 0.008, 0.016, 0.03, 0.1, 0.3, 1.0)}
PIECES, FOLDS = 12, 4
BENT = 4.0  # standard deviations of its square or cube at which an axis is bent
MEANS = 12  # fewer say nothing of how a reading goes on
SETTLES_S = 30.0  # so long tyres, springs and contacts of a robot that has stopped may still creep
SETTLED = "session"  # the level by which one rest differs from the next


@dataclass(frozen=True)
class RestLevels:
    """What is usual: placement (from one rest to the next) and flicker, mg or deg/s."""

    placement: float
    flicker: float
    known: bool

    def prior(self, unit, free):
        """(G,) log prior of each point of a unit's grid; free: levels that may be anything. Less
        than usual is as good as usual."""
        grid = np.array(unit.grid)
        factor = np.log(evidence.KNOWN_FACTOR if self.known else evidence.USUAL_FACTOR["flicker"])
        total = np.zeros(len(grid))
        for column, level, name in ((0, self.placement, "switch_on"), (1, self.flicker,
                                                                       "flicker")):
            if name not in free:
                above = np.maximum(np.log(grid[:, column] / level), 0.0)
                total -= 0.5 * (above / factor) ** 2
        return total


@dataclass(frozen=True)
class RestCause:
    """One effect, or one class of effects, on the axes that show it: names (the likeliest
    first), place ({name: probability} of what stands here), score (nats), value and interval by
    axis, unit, plausible, share of the excess, domain."""

    names: tuple
    place: dict
    score: float
    value: dict
    interval: dict
    unit: str
    plausible: bool
    share: object
    domain: str

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
    nameless (probabilities that something without a name is there), sums (one holdout_gain.Sums
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
        """holdout_gain.Shrinkage of the three axes together."""
        return sum(self.sums[1:], self.sums[0]).shrinkage(self._named)

    @property
    def by_axis(self):
        """{"x": holdout_gain.Shrinkage, ...}"""
        return {k: one.shrinkage(self._named) for k, one in zip("xyz", self.sums)}

    @property
    def _named(self):
        return any(c.effect != "drift" for c in self.causes)  # noise cannot be foretold

    def reason(self, name):
        """Why an effect could not be seen in this rest; "" where it could."""
        if name in self.looked_at:
            return ""
        return rest_forms.limits(self.rest, self.kind, name) or "needs rests in several poses"


def of(sessions, settings, lines=(), least_s=0.0):
    """{sensor: RestGap} of blocks.Sessions, {} where nothing rests for long enough."""
    rest = long_rest.of(sessions, lines)
    if rest is None or rest.n < MEANS or rest.seconds.sum() < least_s:
        return {}
    chip = sessions[0].capture.meta["sensor"]
    return {kind: _sensor(rest, kind, chip, settings) for kind in rest.values}


def _units(rest, kind, chip, settings):
    """[Unit] of the three axes, which share no coefficient: each has the columns of all, the
    others' being zero."""
    designs = rest_forms.designs(rest, kind, chip, settings)
    number = int(rest.rest.max()) + 1
    lateral = (rest.rest[:, None] == np.arange(number)[None]).astype(float)
    if number == 1:
        lateral = lateral[:, :0]
    kernel = flicker_kernel(rest.t, rest.seconds) * (rest.session[:, None] == rest.session)
    warming = 0 if rest.temperature is None else int(round(
        float(rest.temperature[-1] - rest.temperature[0]) / 3.0))
    found = []
    for axis in range(3):
        own = [replace(d, columns=d.columns * (np.array(d.axes) == axis)) for d in designs]
        group = covariance.alone(np.diag(rest.noise[kind][:, axis] ** 2), lateral, kernel)
        rows = nominal_rows.Rows(rest.values[kind][:, axis], group, np.ones((rest.n, 1)),
                                 (OFFSETS[kind], FLICKERS[kind]), (0,))
        signature = ("rest", axis, tuple(rest.rest.tolist()),
                     tuple((rest.t - rest.t[0]).round().astype(int).tolist()), warming)
        unit = linear_model.unit(rows, own, signature=signature, apart=True)
        found.append(replace(unit, energy=unit.energy / 3.0))  # the rows are those of one axis
    return found


def _sensor(rest, kind, chip, settings):
    """RestGap: posterior, classes, adequacy, held-out figures."""
    progress.doing("the %s at rest" % ("gyro" if kind == "gyro" else "accelerometer"))
    units = _units(rest, kind, chip, settings)
    data = coefficient_fits.Data(units)
    flicker, reference = adequacy.usual(chip, kind), settings.reference.get(kind)
    levels = RestLevels(OFFSET[kind], flicker if reference is None
                        else max(reference, flicker / 4.0), reference is not None)
    several = int(rest.rest.max()) > 0
    forms = [f for f in hypotheses.of(units, settings.without)
             if several or f.effect != SETTLED]
    model = posterior.Model(units, data.statistics, levels)
    found = posterior.search(model, forms, cutoffs.of(units, forms, levels))
    fits = adequacy.of(units, data.statistics, found.best)
    chosen = [f for f in found.best.forms if not f.generic and len(f.shared)]
    strange = [(f, ["xyz"[axis] for axis, _ in posterior.axes_of(model, found, f)])
               for f in found.best.forms if f.generic and not _settled(f, units, fits, kind)]
    causes = aliases.causes(found, units, forms)
    told = [_told(c, data, fits, chip, kind, chosen, found) for c in causes]
    beaten = [c for c, one in zip(causes, told) if _beaten(one, strange, found)]
    chosen = [f for f in chosen if not any(f in c.chosen for c in beaten)]
    told = [one for c, one in zip(causes, told) if c not in beaten]
    told += _drift(found, units, data, levels, kind, chosen, fits.index)
    places = [Place(kind, letter, c.domain, 1.0 if c.share is None else c.share,
                    np.exp(-min(c.score, 600.0))) for c in told for letter in c.letters]
    for form, letters in strange:
        gain = np.exp(-min(found.gains[form.effect], 600.0))
        places += [Place(kind, k, hypotheses.domain(form.effect), 1.0, gain)
                   for k in letters or [None]]
    if not fits.ok and not places:
        places = [Place(kind, None, "time", 1.0, fits.p)]
    return RestGap(kind, rest, tuple(told), tuple(places),
                   (*(1.0 - found.places[f.effect].get("", 0.0) for f, _ in strange),
                    *([] if fits.ok else [1.0 - fits.p])),
                   tuple(_held_out(rest, unit, chosen, point, levels)
                         for unit, point in zip(units, fits.index)),
                   frozenset(f.effect for f in forms))


def _settled(form, units, fits, kind):
    """Whether a member of the set is no more than what switching on again, or putting down
    again, does to a reading."""
    return form.effect == SETTLED and max(u.grid[k][0] for u, k in zip(
        units, fits.index)) <= session_offsets.UNUSUAL[kind]


def _told(cause, data, fits, chip, kind, chosen, found):
    """RestCause of an aliases.Cause; where the change from one rest to the next may be no more
    than that, what does it is among the names. Its share: what is lost without it."""
    cause = _with_bent(effect_estimates.sized(cause, data, list(fits.index), chip, kind), data,
                       list(fits.index))
    names = cause.names
    if found.places[cause.effect].get(SETTLED, 0.0) > 1.0 - posterior.HOLDS:
        names = [*names, "drift", *(["table_tilt"] if kind == "accel" else [])]
    rest = [form for form in chosen if form not in cause.chosen]
    share = adequacy.share(data.units, data.statistics, fits.index, (rest, fits.index),
                           (chosen, fits.index))
    place = dict(found.places[cause.effect])
    return RestCause(tuple(names), place, cause.score, cause.value, cause.interval, cause.unit,
                     cause.plausible, share, terms.DOMAIN[cause.effect])


def _beaten(cause, strange, found):
    """Whether something without a name says more on every axis of a cause: what the name gains
    may be no more than a part of that."""
    return bool(cause.letters) and all(any(
        (not letters or letter in letters) and found.gains[form.effect] > cause.score
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
    theta, sigma = effect_estimates.effective(cause, data, index)
    half = {key: odds.Z_90 * sigma[key] for key in theta if key in missing}
    return replace(cause, value={**cause.value, **{key: float(theta[key]) for key in half}},
                   interval={**cause.interval, **{
                       key: (float(theta[key] - half[key]), float(theta[key] + half[key]))
                       for key in half}}, letters=sorted({*cause.letters, *half}))


def _drift(found, units, data, levels, kind, chosen, index):
    """[RestCause] of a drift in the likeliest set: its Allan floor on the axes that wander more
    than is usual, with a 90 % interval by the profile of the likelihood."""
    from .answer import FLOOR_OF_KERNEL
    if "drift" not in found.best.names:
        return []
    value, interval, free = {}, {}, frozenset(["flicker"])
    for key, unit, statistics in zip("xyz", units, data.statistics):
        course = evidence.by_flicker(unit, statistics, found.best.shared,
                                     levels.prior(unit, free))
        level, low, high = evidence.profile(sorted({b for _, b in unit.grid}), course)
        if low > levels.flicker:
            value[key] = level * FLOOR_OF_KERNEL
            interval[key] = (low * FLOOR_OF_KERNEL, high * FLOOR_OF_KERNEL)
    if not value:
        return []
    share = adequacy.share_of_drift(units, data.statistics, chosen, index, levels)
    return [RestCause(("drift",), dict(found.places["drift"]), found.gains["drift"], value,
                      interval, "mg" if kind == "accel" else "deg/s", True, share, "time")]


def _held_out(rest, unit, chosen, index, levels):
    """holdout_gain.Sums of one axis over the folds: pieces of the rest, every FOLDS-th of them
    foretold by the others, all means with one weight. The floor is that of noise that wanders no
    more than a chip may; what wanders more is a gap that nothing foretells."""
    y, group, (placement, flicker) = unit.rows.y, unit.rows.groups[0], unit.grid[index]
    noise = covariance.dense([group], placement, flicker)
    quiet = covariance.dense([group], 0.0, min(flicker, adequacy.TIMES_TYPICAL * levels.flicker))
    columns = np.concatenate([f.columns for f in chosen] + [np.zeros(0, dtype=int)]).astype(int)
    prior = np.concatenate([f.prior for f in chosen] + [np.zeros(0)])
    x = unit.raw(columns)
    pieces = np.minimum(np.arange(rest.n) * PIECES // rest.n, PIECES - 1)
    total = holdout_gain.NOTHING
    for fold in range(FOLDS):
        held = pieces % FOLDS == fold
        plain = _foretelling(x[:, :0], prior[:0], noise, held)
        z = plain @ y
        d = z - _foretelling(x, prior, noise, held) @ y
        scatter = plain @ noise @ plain.T
        total = total + holdout_gain.Sums(
            float(z @ z), float((z - d) @ (z - d)), float(np.trace(plain @ quiet @ plain.T)),
            float(held.sum()), holdout_gain.spread(
                2.0 * float((scatter ** 2).sum()), float(z @ scatter @ z),
                float(d @ scatter @ z), float(d @ scatter @ d)))
    return total


def _foretelling(x, prior, noise, held):
    """(held, n): what it takes to make of all means those held out less what the others foretell
    of them: a constant and the columns x."""
    train = ~held
    design = np.hstack([np.ones((len(x), 1)), x])
    solved = np.linalg.solve(noise[np.ix_(train, train)], design[train])
    gram = design[train].T @ solved + np.diag(np.concatenate([[0.0], prior ** -2.0]))
    out = np.eye(len(x))[held]
    out[:, train] -= design[held] @ np.linalg.solve(gram, solved.T)
    return out
