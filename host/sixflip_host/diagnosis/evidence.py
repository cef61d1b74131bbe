"""How likely a set of hypotheses makes what was captured: one score for all of them.

A hypothesis is one of three kinds. *Shared*: columns whose coefficients are the same in every
session, as an effect of the sensor is. *Private*: columns with coefficients of each session's
own, integrated out there with their prior (a jump at some time, a sine, something smooth in
time). *Free level*: a variance component (flicker, placement) larger than the chip and the hand
usually have.

The score is the log predictive likelihood, in nats: the coefficients that are shared are learned
from the other sessions, with their covariance V, and each session is judged by what that makes
of it, C + S V S' instead of C [Geisser & Eddy, JASA 74 (1979) 153]. Where there is one session
only, V is the prior. The levels of placement and flicker are the likeliest ones of the session
itself, times their prior. How far the sizes found are from those that the data sheets give is in
the score as well: physical plausibility is a prior here, not a gate afterwards.

All functions take R data sets at once (null simulation), R = 1 for the real one.
"""
from dataclasses import dataclass

import numpy as np
from scipy import special

from .elimination import reduced, whitening

# A standard deviation of each level's logarithm. Placement may be anything: a box that is put
# down in any heading on a tilted table scatters by degrees.
USUAL_FACTOR = {"placement": 8.0, "flicker": 2.0, "switch_on": 1.2}
KNOWN_FACTOR = 1.4  # and where a capture of noise alone was given


@dataclass(frozen=True)
class Levels:
    """What is usual: placement and flicker, mg or deg/s, and the change from one switch-on to the
    next, of a bias in the same and of a scale in thousandths; known: the flicker was measured."""

    placement: float
    flicker: float
    bias: float
    scale: float
    known: bool = False

    def usual(self, unit):
        """(placement, flicker) that a unit has at most; of what is between the sessions (change
        from one switch-on to the next, 0)."""
        if unit.between:
            return getattr(self, unit.between), 0.0
        return self.placement, self.flicker

    def prior(self, unit, free):
        """(G,) log prior of each point of a unit's grid; free: names of levels that may be
        anything. Less than usual is as good as usual."""
        grid = np.array(unit.grid)
        if unit.between:
            usual = {"switch_on": (grid[:, 0], self.usual(unit)[0])}
        else:
            usual = {"placement": (grid[:, 0], self.placement),
                     "flicker": (grid[:, 1], self.flicker)}
        total = np.zeros(len(grid))
        for name, (values, level) in usual.items():
            if name not in free:
                factor = KNOWN_FACTOR if self.known and name == "flicker" else USUAL_FACTOR[name]
                above = np.maximum(np.log(np.maximum(values, 1e-9) / level), 0.0)
                total -= 0.5 * (above / np.log(factor)) ** 2
        return total


@dataclass(frozen=True)
class Fit:
    """One unit at the likeliest levels, private columns integrated out, for R data sets: index
    of the grid (R,), quadratic (R,), inner (R, k), gram (R, k, k) of the shared columns, logdet
    and level (R,), evidence (R,) with the shared columns' coefficients by their prior."""

    index: np.ndarray
    quadratic: np.ndarray
    inner: np.ndarray
    gram: np.ndarray
    logdet: np.ndarray
    level: np.ndarray
    evidence: np.ndarray


def fit(unit, statistics, shared, private, level, points=None, elimination=None):
    """Fit of one unit; level (G,) log prior of its grid; points: which of the grid, None: all;
    elimination: the Elimination of the private columns, if made."""
    chosen = np.arange(len(level)) if points is None else points
    if elimination is None or not len(private) or not len(shared):
        r = reduced(unit, statistics, shared, private, chosen)
    else:
        r = elimination.reduced(shared.index, chosen)
    level = level[chosen]
    left, logdet = r.quadratic, 0.0
    if len(shared):
        left, logdet = known(r.gram + np.diag(shared.prior ** -2.0), r.inner, r.quadratic)
        logdet = logdet + np.log(shared.prior).sum()
    likelihood = -0.5 * left - (r.logdet - level + logdet)[:, None]
    index = likelihood.argmax(axis=0)
    every = np.arange(r.quadratic.shape[1])
    return Fit(chosen[index], r.quadratic[index, every], r.inner[index, :, every], r.gram[index],
               r.logdet[index], level[index], likelihood[index, every])


def known(gram, inner, quadratic):
    """(quadratic (G, R) less what coefficients of that gram (G, k, k) and inner (G, k, R) explain,
    half the log determinant of the gram (G,)).

    One data set, as in a search, takes one factor: of the gram bordered by inner and quadratic,
    whose last corner squared is what is left [Bjorck, Numerical Methods for Least Squares
    Problems (1996), section 2.2.2].
    """
    points, k, number = inner.shape
    if number == 1:
        bordered = np.empty((points, k + 1, k + 1))  # the lower triangle is all that is read
        bordered[:, :k, :k], bordered[:, k, :k] = gram, inner[:, :, 0]
        bordered[:, k, k] = quadratic[:, 0] + 1.0  # so that rounding leaves it positive
        try:
            factor = np.linalg.cholesky(bordered)
        except np.linalg.LinAlgError:
            pass
        else:
            corners = np.diagonal(factor, axis1=1, axis2=2)
            return corners[:, k:] ** 2 - 1.0, np.log(corners[:, :k]).sum(axis=1)
    metric = whitening(gram)
    return quadratic - ((metric.matrix @ inner) ** 2).sum(axis=1), metric.half_logdet


def coefficients(fits, shared):
    """(theta (R, k), V (R, k, k)) of several Fits together."""
    covariance = np.linalg.inv(sum(f.gram for f in fits) + diagonal(shared.prior ** -2.0))
    return _times(covariance, sum(f.inner for f in fits)), covariance


def diagonal(values):
    """(..., k, k) of values (..., k)."""
    return values[..., None] * np.eye(values.shape[-1])


def _times(matrices, vectors):
    """(R, k) of matrices (R, k, k) and vectors (R, k)."""
    return (matrices @ vectors[:, :, None])[:, :, 0]


def _together(fits, shared):
    """(R,) log density of the contrasts of several units, the shared coefficients integrated out
    with their prior: what the chain rule makes of one after the other."""
    gram = sum(f.gram for f in fits) + diagonal(shared.prior ** -2.0)
    left, half = known(gram, sum(f.inner for f in fits)[:, :, None],
                       sum(f.quadratic for f in fits)[:, None])
    return (sum(f.level - f.logdet for f in fits) - 0.5 * left[:, 0] - half
            - np.log(shared.prior).sum(axis=-1))


def positive(units):
    """(K,) which of all columns have coefficients that are not less than nothing."""
    return np.concatenate([np.full(len(d.keys), d.positive) for d in units[0].designs])


def score(fits, shared, apart=False, bounded=None):
    """(R,) log predictive likelihood of all units, and how plausible the sizes are; shared:
    Columns, of which each of the R may have its own (R, k); apart: the units have no coefficient
    in common, nothing is learned from one for the other; bounded (K,): which of all columns'
    coefficients are positive, with half of the prior, twice as dense."""
    bounded = None if bounded is None or not bounded[shared.index].any() else bounded[shared.index]
    if not shared.index.shape[-1]:
        return _together(fits, shared)
    if apart or len(fits) == 1:
        return sum(_together([f], shared)
                   + (0.0 if bounded is None else _half(*coefficients([f], shared), bounded))
                   for f in fits)
    # Of each one held out: what it adds to the others.
    total = len(fits) * _together(fits, shared) - sum(
        _together(fits[:held] + fits[held + 1:], shared) for held in range(len(fits)))
    theta, covariance = coefficients(fits, shared)
    sigma = np.sqrt(np.einsum("rii->ri", covariance))
    beyond = np.maximum(np.abs(theta) - 2.0 * sigma, 0.0) / shared.prior
    if bounded is not None:
        total += _half(theta, covariance, bounded)
    return total - np.log1p(beyond ** 2).sum(axis=1)  # Cauchy: typical sizes are rough


def _half(theta, covariance, bounded):
    """(R,) what it adds that the bounded coefficients are positive: the share of their posterior
    that is, of the half that their prior is."""
    sigma = np.sqrt(np.einsum("rii->ri", covariance))
    return np.where(bounded, np.log(2.0) + special.log_ndtr(theta / sigma), 0.0).sum(axis=1)
