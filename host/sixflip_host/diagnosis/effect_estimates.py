"""What can be said of one member of the likeliest set: on which other axes and in which other
variants of its effect it would do its work as well; its size with an interval, the axes that have
it, and whether such a size is believable.
"""
import math
from dataclasses import replace

import numpy as np
from scipy import optimize, special

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

from ..experiment import terms
from . import evidence, hypotheses, odds

AS_WELL = 3.0  # nats, GAP stage 4
SIGNIFICANT = 3.0  # standard deviations at which an axis is said to have the effect
FORM = 0.05  # of a size, standard deviation: parts do not have the library's very curves


def in_full(model, forms, posterior, cause):
    """An aliases.Cause of a Posterior's best set with other_axes and variants."""
    return replace(cause, other_axes=_rival_axes(model, forms, posterior, cause.chosen[0]),
                   variants=_variants(model, forms, posterior, cause))


def _rival_axes(model, forms, posterior, form):
    """Axes (0..2) on which the same effect would do as well as on the one it was found on: where
    a pose's attitude is free, x: f_y f_z and y: f_x f_z add the same along gravity."""
    if form.axis is None:
        return ()
    others = _without(model, posterior, form)
    return tuple(other.axis for other in forms if other.effect == form.effect
                 and (other.variant, other.record) == (form.variant, form.record)
                 and other.axis not in (None, form.axis)
                 and model.extended(others, other).score > posterior.best.score - AS_WELL)


def axes_of(model, posterior, form):
    """[(axis 0..2, nats)] of a member of the best set: the axes that it does its work on, each
    by what it gains there alone; [] of a level of noise."""
    others = _without(model, posterior, form)
    gains = {}
    for axis in range(3):
        part = hypotheses.on_axis(form, axis) if form.axes else None
        if part is not None:
            gains[axis] = model.extended(others, part).score - others.score
    most = max(gains.values(), default=0.0)
    share = posterior.cost.beside if form.generic else posterior.cost.form
    return [(axis, gain) for axis, gain in gains.items()
            if gain == most or gain > posterior.cost.nats(form) + share * most]


def _variants(model, forms, posterior, cause):
    """((probability, Cause), ...): a cause in the variants of its effect that are as likely to
    within AS_WELL (a lag, a time constant), its own first: which of them it is makes a size as
    uncertain as noise does."""
    form, others = cause.chosen[0], _without(model, posterior, cause.chosen[0])
    told = [(posterior.best.score, cause)]
    for other in forms:
        if other.effect != form.effect or other.variant == form.variant or (
                other.keys, other.record) != (form.keys[:len(other.keys)], form.record):
            continue
        scored = model.extended(others, other)
        if scored.score > posterior.best.score - AS_WELL:
            told.append((scored.score, _sized_as(cause, other, scored)))
    weights = np.exp(np.array([score for score, _ in told]) - posterior.best.score)
    return tuple((float(w), variant) for w, (_, variant) in zip(weights / weights.sum(), told))


def _sized_as(cause, form, scored):
    """A cause whose own form is another one, with its coefficients in a Scored set with that."""
    chosen, columns = (form, *cause.chosen[1:]), scored.shared.index
    theta, covariance = (v[0] for v in evidence.coefficients(scored.fits, scored.shared))
    place = [int(np.flatnonzero(columns == c)[0]) for part in chosen for c in part.columns]
    return replace(cause, chosen=chosen, theta=theta[place],
                   covariance=covariance[np.ix_(place, place)])


def _without(model, posterior, form):
    """Scored of the likeliest set without a member."""
    return model.scored(tuple(f for f in posterior.best.forms if f is not form))


def sized(cause, data, levels, chip, kind, share=None):
    """The aliases.Cause with value and interval {key: ...}, letters of the axes, plausible,
    domain and unit; share: of the excess. levels: index into each unit's grid."""
    gram = sum(u.gram.at(i) for u, i in zip(data.units, levels))
    theta, covariance = effective(cause, gram)
    sigma = dict(zip(theta, np.sqrt(np.diag(covariance))))
    axis_of = dict(zip(cause.keys, cause.axes))
    shown = [] if cause.effect == "box_tilt" else letters(cause, theta, covariance)
    value = {k: float(v) for k, v in theta.items() if not shown or "xyz"[axis_of[k]] in shown}
    interval = _intervals(cause, gram, value, sigma)
    if shown:
        shown = sorted({*shown, *("xyz"[a] for a in cause.other_axes)})
    return replace(cause, value=value, interval=interval, letters=shown, share=share,
                   variant=_own(cause, gram)[0].variant,
                   plausible=believable(cause.effect, chip, kind, value, sigma),
                   domain=terms.DOMAIN[cause.effect], unit=EFFECTS[cause.effect].units[kind])


def _intervals(cause, gram, value, sigma):
    """{key: (low, high)}, 90 % of what a size may be in all variants of its effect that are as
    likely, each with its own uncertainty: which lag or time constant it is nothing tells."""
    mixed = [(p, *effective(variant, gram)) for p, variant in cause.variants[1:]]
    own = 1.0 - sum(p for p, _, _ in mixed)
    intervals = {}
    for key, size in value.items():
        parts = [(own, size, sigma[key])]
        for p, theta, covariance in mixed:
            place = list(theta).index(key)
            parts.append((p, theta[key], math.sqrt(covariance[place, place])))
        low, high = _ends(*np.array(parts).T)
        intervals[key] = (min(low, size), max(high, size))
    return intervals


def _ends(weights, means, spreads):
    """(low, high) between which 90 % of a mixture of normal distributions lies."""
    spreads = np.maximum(spreads, 1e-12)

    def above(size, part):
        return float(weights @ special.ndtr((size - means) / spreads)) - part
    reach = (means - 10.0 * spreads).min(), (means + 10.0 * spreads).max()
    return tuple(optimize.brentq(above, *reach, args=(part,)) for part in odds.ENDS_90)


def letters(cause, theta, covariance):
    """Axes whose coefficients are significant together, at least the most significant one: of
    several that share an effect each by itself may be of any size. covariance: of theta's."""
    axis_of, keys = dict(zip(cause.keys, cause.axes)), list(theta)
    strong = {}
    for axis in sorted({axis_of[key] for key in keys}):
        mine = [k for k, key in enumerate(keys) if axis_of[key] == axis]
        size = np.array([theta[keys[k]] for k in mine])
        block = covariance[np.ix_(mine, mine)] + 1e-24 * np.eye(len(mine))
        # chi2 [Wald, Trans. AMS 54 (1943) 426] less what all but one would have by chance
        chi2 = float(size @ np.linalg.solve(block, size)) - (len(mine) - 1)
        strong[axis] = math.sqrt(max(chi2, 0.0))
    most = max(strong, key=strong.get)
    return ["xyz"[a] for a in sorted(strong) if strong[a] > SIGNIFICANT or a == most]


def effective(cause, gram):
    """({key: size}, covariance (p, p) of the sizes): what all variants and bends of the effect
    add together, and the other names of its class beside it, as the nearest sizes of its first
    variant. gram (K, K): the products of all columns."""
    base = {}
    for candidate in _own(cause, gram):
        for key, power, column in zip(candidate.keys, candidate.powers, candidate.columns):
            if power == 1:
                base.setdefault(key, column)
    plain = np.array(list(base.values()))
    taken = nearest(gram, plain, hypotheses.columns_of(cause.chosen).index)
    size = taken @ cause.theta
    covariance = taken @ cause.covariance @ taken.T
    return dict(zip(base, size)), covariance + np.diag((FORM * size) ** 2)


def nearest(gram, plain, every):
    """(p, k): what coefficients of the columns `every` (k,) come to as sizes of the columns
    `plain` (p,), nearest in the metric of the noise; gram (K, K) the products of all columns."""
    block = gram[np.ix_(plain, plain)]
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
    block = block / scale / scale[:, None] + 1e-9 * np.eye(len(plain))
    return np.linalg.solve(block, gram[np.ix_(plain, every)] / scale[:, None]) / scale[:, None]


def _own(cause, gram):
    """The cause's candidates of its own effect, the one that adds most first."""
    own = [c for c in cause.chosen if c.effect == cause.effect]
    return sorted(own, key=lambda c: -_energy(c, cause, gram))


def _energy(candidate, cause, gram):
    """chi2 of what one of a cause's candidates adds."""
    start = 0
    for other in cause.chosen:
        theta = cause.theta[start:start + len(other.keys)]
        start += len(other.keys)
        if other is candidate:
            return float(theta @ gram[np.ix_(other.columns, other.columns)] @ theta)
    return 0.0


TIMES = 5.0  # the typical size, that is believed: more is numerically helpful only (GAP stage 3)
TAIL = 2.0
# Of those that are as large as a box is made, a sensor is mounted, a filter is set or a maker
# wants; what warms up does so by more than it drifts.
LOOSE = {"warm_up": 10.0, "dead_band": 1e9, "box_tilt": 20.0, "lever_arm": 10.0,
         "filter_lag": 20.0}


# What a part's drift with temperature amounts to while it warms up, and in what follows the
# thermometer by a minute: no data sheet gives these two by themselves.
BY_TEMPERATURE = {"warm_up": 10.0, "thermal_rate": 1.0}  # degC, minutes


def limit(effect, chip, kind, key):
    """Largest size that is believed, or None where there is no typical one."""
    size = typical.size(effect, chip, kind, key)[0]
    if size is None:
        size = typical.size(effect, chip, kind)[0]
    if size is None:
        return None
    top = LOOSE.get(effect, TIMES) * abs(size)
    if effect in BY_TEMPERATURE:
        slope = typical.size("thermal_bias", chip, kind, key)[0]
        top = max(top, TIMES * abs(slope) * BY_TEMPERATURE[effect])
    return top


def believable(effect, chip, sensor, values, sigmas=None):
    """True when no coefficient exceeds TAIL times its limit by more than twice its own
    uncertainty: of parts beyond the limit, as rough as typical sizes are, half have more than that
    [a Cauchy tail, as in evidence.score]. Below, what the prior says is in the score already."""
    for key, value in values.items():
        top = limit(effect, chip, sensor, key)
        slack = 2.0 * sigmas[key] if sigmas else 0.0
        if top is not None and abs(value) - slack > TAIL * top:
            return False
    return True
