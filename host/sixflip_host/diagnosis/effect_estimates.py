"""The size of a cause with its interval, and whether it is believable."""
import math
from dataclasses import replace

import numpy as np
from scipy import optimize, special

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

from ..experiment import session_terms, terms
from . import hypotheses, odds

FORM = 0.05  # of a size, standard deviation: parts do not have the library's very curves


def sized(cause, data, levels, chip, kind, share=None):
    """The aliases.Cause with value and interval {key: ...}, on its axes where they are told (see
    members.py), plausible, domain and unit; share: of the excess. levels: index into each unit's
    grid."""
    gram = sum(u.gram.at(i) for u, i in zip(data.units, levels))
    theta, covariance = effective(cause, gram)
    sigma = dict(zip(theta, np.sqrt(np.diag(covariance))))
    axis_of = dict(zip(cause.keys, cause.axes))
    shown = [] if cause.effect == "box_tilt" else list(cause.letters)
    value = {k: float(v) for k, v in theta.items() if not shown or "xyz"[axis_of[k]] in shown}
    interval = _intervals(cause, gram, value, sigma)
    own = _own(cause, gram)[0]
    return replace(cause, value=value, interval=interval, letters=shown, share=share,
                   variant=own.variant, shape=own.shape,
                   plausible=believable(cause.effect, chip, kind, value, sigma),
                   domain=terms.DOMAIN[cause.effect], unit=_unit(own, kind))


def _unit(form, kind):
    """Unit of a Form's sizes."""
    unit = EFFECTS[form.effect].units[kind]
    return unit.removesuffix("/g") if session_terms.remembers_otherwise(form) else unit


def _intervals(cause, gram, value, sigma):
    """{key: (low, high)}, 90 % of what a size may be in all variants of its effect that are as
    likely, each with its own uncertainty: which lag, time constant or axis it is nothing tells."""
    mixed = [(p, *effective(variant, gram)) for p, variant in cause.variants[1:]]
    own = 1.0 - sum(p for p, _, _ in mixed)
    intervals = {}
    for key, size in value.items():
        parts = [(own, size, sigma[key])]
        for p, theta, covariance in mixed:
            if key not in theta:  # it is on another axis
                parts.append((p, 0.0, 0.0))
                continue
            place = list(theta).index(key)
            parts.append((p, theta[key], math.sqrt(covariance[place, place])))
        intervals[key] = ends(*np.array(parts).T)
    return intervals


def ends(weights, means, spreads):
    """(low, high) between which 90 % of a mixture of normal distributions lies, and the mean of
    the first of them, which is the size that is told: of the likeliest variant, or of a simpler
    one that does as well."""
    spreads = np.maximum(spreads, 1e-12)

    def above(size, part):
        return float(weights @ special.ndtr((size - means) / spreads)) - part
    reach = (means - 10.0 * spreads).min(), (means + 10.0 * spreads).max()
    low, high = (optimize.brentq(above, *reach, args=(part,)) for part in odds.ENDS_90)
    return min(low, float(means[0])), max(high, float(means[0]))


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
# wants; what warms up does so by more than it drifts; what shakes hardest may be beyond the
# filter, so that what is left of it in the samples shifts by any multiple of its power.
LOOSE = {"warm_up": 10.0, "dead_band": 1e9, "vibration_rectification": 1e9,
         "box_tilt": 20.0, "lever_arm": 10.0, "filter_lag": 20.0}


ONE_SIDED = ("dead_band",)  # a width below nothing is another cause's
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
    """True when no coefficient exceeds TAIL times its limit, or lies below nothing where none can,
    by more than twice its own uncertainty: of parts beyond the limit, as rough as typical sizes
    are, half have more than that [a Cauchy tail, as in evidence.score]. Below, what the prior says
    is in the score already."""
    for key, value in values.items():
        top = limit(effect, chip, sensor, key)
        slack = 2.0 * sigmas[key] if sigmas else 0.0
        if effect in ONE_SIDED and value + slack < 0.0:
            return False
        if top is not None and abs(value) - slack > TAIL * top:
            return False
    return True
