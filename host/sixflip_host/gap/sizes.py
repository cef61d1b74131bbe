"""The size of a cause with its interval, the axes that have it, and whether it is believable."""
import numpy as np

from . import plausible

SIGNIFICANT = 3.0  # standard deviations at which an axis is said to have the effect
Z_90 = 1.645


def fill(cause, data, levels, chip, kind):
    """Fill value and interval {key: ...}, letters of the axes, plausible."""
    theta, sigma = effective(cause, data, levels)
    cause.value = {k: float(v) for k, v in theta.items()}
    cause.interval = {k: (float(v - Z_90 * sigma[k]), float(v + Z_90 * sigma[k]))
                      for k, v in theta.items()}
    cause.letters = []
    if cause.effect != "box_tilt":
        cause.letters = letters(cause, theta, sigma)
        axis_of = dict(zip(cause.keys, cause.axes))
        cause.value = {k: v for k, v in cause.value.items()
                       if "xyz"[axis_of[k]] in cause.letters}
        cause.interval = {k: cause.interval[k] for k in cause.value}
        cause.letters = sorted({*cause.letters, *("xyz"[a] for a in cause.other_axes)})
    cause.plausible = plausible.believable(cause.effect, chip, kind, cause.value, sigma)


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
    """({key: size}, {key: sigma}); a bend beside a coefficient is taken in by the nearest size
    without it. levels: index into each unit's grid."""
    theta, sigma = {}, {}
    gram = sum(u.gram[i] for u, i in zip(data.units, levels))
    start = 0
    for candidate in cause.chosen:
        mine = [(k, c) for k, c in zip(candidate.keys, candidate.columns) if not k.endswith("+")]
        base = np.array([c for _, c in mine])
        values = cause.theta[start:start + len(candidate.keys)]
        errors = cause.sigma[start:start + len(candidate.keys)]
        start += len(candidate.keys)
        block = gram[np.ix_(base, base)]
        scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
        block = block / scale / scale[:, None] + 1e-9 * np.eye(len(base))
        inner = gram[np.ix_(base, candidate.columns)] @ values / scale
        size = np.linalg.solve(block, inner) / scale
        spread = np.sqrt(np.diag(np.linalg.inv(block))) / scale
        bare = len(mine) == len(candidate.keys)
        for i, (key, _) in enumerate(mine):
            theta[key] = size[i]
            sigma[key] = errors[candidate.keys.index(key)] if bare else spread[i]
    return theta, sigma
