"""The figures of a gap: what is estimated of effects session by session, how far the gap shrinks
by them, and which share of it goes with a cause.

The coefficients of an effect are estimated on the other sessions by generalised least squares.
Levels of placement and flicker are those of the session itself, by restricted maximum likelihood
with the effects in [Patterson & Thompson, Biometrika 58 (1971) 545]. These functions take R data
sets at once, R = 1 for the real one.

The share closed is that of squares, (before^2 - after^2) / (before^2 - floor^2). Both are sums
whose variances are known, so their ratio has a Fieller interval [Fieller, JRSS B 16 (1954) 175];
unbounded means that the gap is too small to measure. The excess is chi2 of what is read beyond
its degrees of freedom.
"""
import math
from dataclasses import dataclass

import numpy as np

from . import evidence, hypotheses, odds
from .elimination import NONE


@dataclass(frozen=True, eq=False)
class Data:
    """Units with the statistics of R data sets in every one: lists of Unit and of (quadratic
    (G, R), projections (G, K, R))."""

    units: list
    statistics: list


def data_of(units):
    """Data of these units, with their own contrasts."""
    return Data(units, [u.statistics() for u in units])


@dataclass(frozen=True, eq=False)
class Fit:
    """Restricted maximum likelihood in one unit: index of the grid (R,), course (G, R) of the log
    likelihood over it, inner (R, k) and gram (R, k, k) there, for pooling."""

    index: np.ndarray
    course: np.ndarray
    inner: np.ndarray
    gram: np.ndarray


def fit(unit, statistics, shared):
    """Fit of elimination.Columns (k,)."""
    quadratic, projections = statistics
    gram, inner = unit.gram.at_all_points(shared.index), projections[:, shared.index]
    course = -0.5 * quadratic - unit.logdet[:, None]
    if len(shared):
        full = gram + np.diag(1.0 / shared.prior ** 2)
        solved = np.linalg.solve(full, inner)
        course = course + 0.5 * (inner * solved).sum(axis=1)
        course = course - 0.5 * np.linalg.slogdet(full)[1][:, None]
    index = course.argmax(axis=0)
    return Fit(index, course, inner[index, :, np.arange(quadratic.shape[1])], gram[index])


def fits(data, shared):
    """Fit of every unit."""
    return [fit(u, s, shared) for u, s in zip(data.units, data.statistics)]


def coefficients(fits, shared):
    """(theta (R, k), V (R, k, k)) of several Fits of these Columns together."""
    total = sum(f.gram for f in fits) + np.diag(1.0 / shared.prior ** 2)
    covariance = np.linalg.inv(total)
    theta = np.einsum("rij,rj->ri", covariance, sum(f.inner for f in fits))
    return theta, covariance


@dataclass(frozen=True)
class Shrinkage:
    """before, after, floor (weighted RMS a contrast, mg or deg/s); share, interval (or None);
    further: what was held out lies surely further off from what the others foretell than from
    nothing, by more than they may be off in the sizes."""

    before: float
    after: float
    floor: float
    share: float | None
    interval: tuple | None
    further: bool = False


@dataclass(frozen=True)
class Sums:
    """Weighted squares of what was held out before, after and of noise alone; weight: sum of the
    weights; spread: variances of the gap's and of the closed part's estimates, and the covariance
    of both."""

    before: float
    after: float
    floor: float
    weight: float
    spread: tuple

    def __add__(self, other):
        return Sums(self.before + other.before, self.after + other.after,
                    self.floor + other.floor, self.weight + other.weight,
                    tuple(a + b for a, b in zip(self.spread, other.spread)))

    def times(self, factor):
        """The same with so much of the weight."""
        return Sums(factor * self.before, factor * self.after, factor * self.floor,
                    factor * self.weight, tuple(factor * v for v in self.spread))

    def shrinkage(self, named, beside=None):
        """Shrinkage; named: something was found that can be foretold; beside: Sums of what counts
        for the share only, of whose gap the others' noise, where it is overrated, takes nothing
        off."""
        rms = [math.sqrt(max(v, 0.0) / self.weight) if self.weight > 0.0 else 0.0
               for v in (self.before, self.after, self.floor)]
        if not named:
            return Shrinkage(*rms, None, None)
        gap, every = self.before - self.floor, self
        if beside is not None and beside.weight > 0.0:
            gap, every = max(gap, 0.0) + beside.before - beside.floor, self + beside
        closed = every.before - every.after
        ends = _ends(gap, closed, *every.spread)
        return Shrinkage(*rms, *fieller(gap, closed, *every.spread),
                         closed < 0.0 and ends is not None and ends[1] <= 0.0)


NOTHING = Sums(0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0))


def spread(alone, of_z, both, of_d):
    """Variances of the gap's and of the closed part's estimates and their covariance, of: the
    variance of noise's own squares; z'QCQz, z'QCQd and d'QCQd with the noise's covariance C. What
    the noise in z has in common with other noise is taken off z, in size."""
    of_mean = max(of_z - 0.5 * alone, 0.0)
    return alone + 4.0 * of_mean, 4.0 * of_d, 4.0 * both * math.sqrt(of_mean / max(of_z, 1e-300))


def fieller(gap, closed, variance_gap, variance_closed, both):
    """(share, (low, high)); (None, None) where the interval is unbounded, or nothing is closed,
    which is too little to learn it from. both: the covariance."""
    ends = _ends(gap, closed, variance_gap, variance_closed, both)
    if ends is None or closed <= 0.0:
        return None, None
    return min(closed / gap, 1.0), (min(ends[0], 1.0), min(ends[1], 1.0))


def _ends(gap, closed, variance_gap, variance_closed, both):
    """(low, high) of the share, or None where it is unbounded."""
    z2 = odds.Z_90 ** 2
    a = gap * gap - z2 * variance_gap
    b = -2.0 * (gap * closed - z2 * both)
    c = closed * closed - z2 * variance_closed
    root = b * b - 4.0 * a * c
    if a <= 0.0 or root < 0.0:
        return None
    return (-b - math.sqrt(root)) / (2 * a), (-b + math.sqrt(root)) / (2 * a)


def freedom_taken(unit, point, private):
    """Degrees of freedom that private columns take off."""
    if not len(private):
        return 0.0
    gram = unit.gram.at(point, private.index)
    return float(np.trace(np.linalg.solve(gram + np.diag(private.prior ** -2.0), gram)))


def excess_at(units, statistics, chosen, index):
    """chi2 beyond the degrees of freedom with these Forms, at given points of the grids, each
    unit with sizes of its own."""
    shared, total = hypotheses.columns_of(chosen), 0.0
    for unit, (quadratic, projections), point in zip(units, statistics, index):
        total += quadratic[point, 0] - unit.freedom
        if len(shared):
            gram = unit.gram.at(point, shared.index) + np.diag(1.0 / shared.prior ** 2)
            inner = projections[point][shared.index, 0]
            total -= inner @ np.linalg.solve(gram, inner) - (~unit.silent[shared.index]).sum()
    return float(total)


def excess_share(units, statistics, index, without, including):
    """Share (0 to 1) of the excess that is there with no cause at all, at the points `index` of
    the grids, that goes with one cause: it is there `without` it and not `including` it, both
    pairs of Forms and of points."""
    total, before, after = (excess_at(units, statistics, forms, points)
                            for forms, points in (([], index), without, including))
    return float(np.clip((before - after) / max(total, before - after, 1e-9), 0.0, 1.0))


def drift_share(units, statistics, scored, chosen, index, levels):
    """excess_share() of noise that wanders more than usual, beside the Forms chosen: of the
    excess over noise with no more flicker than evidence.Levels say, what goes with more of it and
    with the walk that a Scored set has."""
    quiet = usual_levels(units, index, levels.flicker)
    total = excess_at(units, statistics, [], quiet)
    usual, found = (excess_at(units, statistics, chosen, points) for points in (quiet, index))
    by_level = usual - found
    walked = sum(_walked(*unit, choice.columns) for *unit, choices in zip(
        units, statistics, index, scored.chosen) for choice in choices
        if choice.form.effect == "drift")
    return float(np.clip((by_level + walked) / max(total, by_level + walked, 1e-9), 0.0, 1.0))


def _walked(unit, statistics, point, private):
    """chi2 that private columns take off beyond their degrees of freedom."""
    flat = np.zeros(len(unit.grid))
    before, after = (evidence.fit(unit, statistics, NONE, columns, flat,
                                  np.array([point]))
                     for columns in (NONE, private))
    return float(before.quadratic[0] - after.quadratic[0]) - freedom_taken(unit, point, private)


def usual_levels(units, index, flicker):
    """Indices of the grids' points with no more flicker than that (the least there is, if none),
    and the placement levels of the points `index`."""
    return [_usual(unit, point, flicker) for unit, point in zip(units, index)]


def _usual(unit, point, most):
    """Index of the point of a unit's grid that has no more flicker than that."""
    if unit.between:
        return point
    placement, flicker = unit.grid[point]
    low = [b for a, b in unit.grid if a == placement]
    low = [b for b in low if b <= most] or [min(low)]
    return unit.grid.index((placement, min(flicker, max(low))))
