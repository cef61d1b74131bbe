"""Stage 3: which effect. Two-fold cross-session predictive log-likelihood, in nats.

The coefficients of an effect are estimated on the other sessions, with their covariance V; the
score is how much more likely they make the session held out, their uncertainty included:
C + S V S' instead of C. Levels of placement and flicker are those of the session itself, by
restricted maximum likelihood with and without the effect. Source: GAP stage 3; predictive
likelihood as in Geisser & Eddy, JASA 74 (1979) 153. Where there is one session that cannot be
halved, the score is the log evidence with the coefficients' prior.

All functions take R data sets at once (null simulation), R = 1 for the real one.
"""
import numpy as np


class Data:
    """Statistics of R data sets in every unit: lists of (quadratic (G, R), projections)."""

    def __init__(self, units, contrasts=None):
        self.units = units
        self.statistics = [u.statistics(None if contrasts is None else contrasts[i])
                           for i, u in enumerate(units)]
        self.number = self.statistics[0][0].shape[1]
        self._base = None

    @property
    def base(self):
        """(R,) log-likelihood of all units without effects."""
        if self._base is None:
            none = np.zeros(0, dtype=int)
            self._base = score(self, none, np.zeros(0))
        return self._base


class Fit:
    """Restricted maximum likelihood in one unit: index of the grid (R,), sums for pooling."""

    def __init__(self, unit, statistics, columns, prior):
        quadratic, projections = statistics
        k = len(columns)
        precision = np.diag(1.0 / prior ** 2) if k else np.zeros((0, 0))
        gram = unit.gram[:, columns[:, None], columns[None]] if k else np.zeros(
            (len(unit.grid), 0, 0))
        inner = projections[:, columns]
        loglik = -0.5 * quadratic - unit.logdet[:, None]
        if k:
            full = gram + precision
            solved = np.linalg.solve(full, inner)
            loglik = loglik + 0.5 * (inner * solved).sum(axis=1)
            loglik = loglik - 0.5 * np.linalg.slogdet(full)[1][:, None]
        self.index = loglik.argmax(axis=0)
        self.loglik = loglik.max(axis=0)
        every = np.arange(quadratic.shape[1])
        self.quadratic = quadratic[self.index, every]
        self.inner = inner[self.index, :, every]  # (R, k)
        self.gram = gram[self.index]  # (R, k, k)
        self.logdet = unit.logdet[self.index]


def fits(data, columns, prior):
    """Fit of every unit."""
    return [Fit(u, s, columns, prior) for u, s in zip(data.units, data.statistics)]


def coefficients(found, prior):
    """(theta (R, k), V (R, k, k)) of several Fits together."""
    total = sum(f.gram for f in found) + np.diag(1.0 / prior ** 2)
    covariance = np.linalg.inv(total)
    theta = np.einsum("rij,rj->ri", covariance, sum(f.inner for f in found))
    return theta, covariance


def predictive(fit, theta, covariance):
    """(R,) log density of a unit's contrasts, coefficients known to theta, covariance."""
    k = theta.shape[1]
    if not k:
        return -0.5 * fit.quadratic - fit.logdet
    moved = np.einsum("rij,rj->ri", fit.gram, theta)
    left = fit.inner - moved  # S' C^-1 (z - S theta)
    squares = fit.quadratic - (theta * (fit.inner + left)).sum(axis=1)
    widened = np.eye(k) + np.einsum("rij,rjk->rik", covariance, fit.gram)
    gain = np.linalg.solve(widened, np.einsum("rij,rj->ri", covariance, left)[:, :, None])[..., 0]
    return -0.5 * (squares - (left * gain).sum(axis=1)) - fit.logdet \
        - 0.5 * np.linalg.slogdet(widened)[1]


def score(data, columns, prior):
    """(R,) predictive log-likelihood with the effects in these columns."""
    found = fits(data, columns, prior)
    number, k = data.number, len(columns)
    if len(found) == 1:
        wide = np.broadcast_to(np.diag((0.3 * prior) ** 2), (number, k, k))
        return predictive(found[0], np.zeros((number, k)), wide)
    total = np.zeros(number)
    for held, fit in enumerate(found):
        others = found[:held] + found[held + 1:]
        if k:
            theta, covariance = coefficients(others, prior)
        else:
            theta, covariance = np.zeros((number, 0)), np.zeros((number, 0, 0))
        total += predictive(fit, theta, covariance)
    return total


class Candidate:
    """A variant of an effect on all its axes or on one: columns into the units' statistics."""

    def __init__(self, design, columns, axis):
        self.effect, self.variant, self.axis = design.effect, design.variant, axis
        chosen = [i for i, a in enumerate(design.axes) if axis is None or a == axis]
        self.keys = tuple(design.keys[i] for i in chosen)
        self.axes = tuple(design.axes[i] for i in chosen)
        self.columns = np.array([columns[i] for i in chosen], dtype=int)
        self.prior = np.array([design.prior[i] for i in chosen])

    @property
    def generic(self):
        return self.effect.startswith("~")


def candidates(units):
    """Every design on all axes and on each; those silent in all units are left out."""
    found, start = [], 0
    for design in units[0].designs:
        columns = np.arange(start, start + len(design.keys))
        start += len(design.keys)
        for axis in (None, 0, 1, 2):
            one = Candidate(design, columns, axis)
            if axis is not None and len(one.columns) == len(columns):
                continue
            if not len(one.columns) or silent(units, one.columns):
                continue
            found.append(one)
    return found


def silent(units, columns):
    """True when none of the units shows more than rounding of these columns."""
    return all(u.silent[columns].all() for u in units)


def gains(data, options, chosen=()):
    """{candidate: (R,) gain in nats} beside what was chosen already."""
    columns = np.concatenate([c.columns for c in chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in chosen] + [np.zeros(0)])
    before = score(data, columns, prior) if len(columns) else data.base
    out = {}
    for option in options:
        new = ~np.isin(option.columns, columns)
        if not new.any():
            continue
        both = np.concatenate([columns, option.columns[new]])
        out[option] = score(data, both, np.concatenate([prior, option.prior[new]])) - before
    return out
