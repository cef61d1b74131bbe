"""The size of a cause with its interval, the axes that have it, and whether it is believable."""
from dataclasses import replace

import numpy as np

from sixflip_sim.effects.library import EFFECTS

from ..experiment import terms
from . import odds, plausible

SIGNIFICANT = 3.0  # standard deviations at which an axis is said to have the effect
FORM = 0.05  # of a size, standard deviation: parts do not have the library's very curves


def sized(cause, data, levels, chip, kind, share=None):
    """The aliases.Cause with value and interval {key: ...}, letters of the axes, plausible,
    domain and unit; share: of the excess. levels: index into each unit's grid."""
    theta, sigma = effective(cause, data, levels)
    axis_of = dict(zip(cause.keys, cause.axes))
    shown = [] if cause.effect == "box_tilt" else letters(cause, theta, sigma)
    value = {k: float(v) for k, v in theta.items() if not shown or "xyz"[axis_of[k]] in shown}
    interval = {k: (float(v - odds.Z_90 * sigma[k]), float(v + odds.Z_90 * sigma[k]))
                for k, v in value.items()}
    if shown:
        shown = sorted({*shown, *("xyz"[a] for a in cause.other_axes)})
    return replace(cause, value=value, interval=interval, letters=shown, share=share,
                   plausible=plausible.believable(cause.effect, chip, kind, value, sigma),
                   domain=terms.DOMAIN[cause.effect], unit=EFFECTS[cause.effect].units[kind])


def letters(cause, theta, sigma):
    """Axes with a significant coefficient, at least the most significant one."""
    strong = {}
    for key, axis in zip(cause.keys, cause.axes):
        if key in theta:
            ratio = abs(theta[key]) / max(sigma[key], 1e-12)
            strong[axis] = max(strong.get(axis, 0.0), ratio)
    most = max(strong, key=strong.get)
    return ["xyz"[a] for a in sorted(strong) if strong[a] > SIGNIFICANT or a == most]


def effective(cause, data, levels):
    """({key: size}, {key: sigma}): what all variants and bends of the effect add together, and
    the other names of its class beside it, as the nearest plain sizes. levels: index into each
    unit's grid."""
    gram = sum(u.gram.at(i) for u, i in zip(data.units, levels))
    base = {}
    own = [c for c in cause.chosen if c.effect == cause.effect]
    for candidate in sorted(own, key=lambda c: -_energy(c, cause, gram)):
        for key, power, column in zip(candidate.keys, candidate.powers, candidate.columns):
            if power == 1:
                base.setdefault(key, column)
    plain = np.array(list(base.values()))
    every = np.concatenate([c.columns for c in cause.chosen])
    taken = nearest(gram, plain, every)
    size = taken @ cause.theta
    variance = np.diag(taken @ cause.covariance @ taken.T)
    spread = np.sqrt(variance + (FORM * size) ** 2)
    return dict(zip(base, size)), dict(zip(base, spread))


def nearest(gram, plain, every):
    """(p, k): what coefficients of the columns `every` (k,) come to as sizes of the columns
    `plain` (p,), nearest in the metric of the noise; gram (K, K) the products of all columns."""
    block = gram[np.ix_(plain, plain)]
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
    block = block / scale / scale[:, None] + 1e-9 * np.eye(len(plain))
    return np.linalg.solve(block, gram[np.ix_(plain, every)] / scale[:, None]) / scale[:, None]


def _energy(candidate, cause, gram):
    """chi2 of what one of a cause's candidates adds."""
    start = 0
    for one in cause.chosen:
        theta = cause.theta[start:start + len(one.keys)]
        start += len(one.keys)
        if one is candidate:
            return float(theta @ gram[np.ix_(one.columns, one.columns)] @ theta)
    return 0.0
