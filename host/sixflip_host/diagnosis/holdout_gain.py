"""Stage 6: how far the gap shrinks on the session held out, in one unit.

Of the contrasts z = mu + noise of the session held out and the prediction d of the causes, whose
coefficients come from the other sessions, all figures are weighted root mean squares with the
weights Q of the fit (Unit.weight): before^2 = z'Qz / tr Q, after^2 = (z - d)'Q(z - d) / tr Q and
floor^2, the same of noise alone. A contrast that a hand scatters counts as little as it does for
the sizes. The share is that of these figures, (before^2 - after^2) / (before^2 - floor^2): what is
closed, 2 d'Qz - d'Qd, of the gap z'Qz - m (m: degrees of freedom). Both are sums with known
variances, so their ratio has a Fieller interval [Fieller, JRSS B 16 (1954) 175]; unbounded means
that the gap is too small to measure. Levels of noise found in these very contrasts make z'Qz of
noise alone vary by no more than the chi-squared of as many; `python -m
tests.studies.robustness.shares` prints how often the intervals hold what is true.
"""
import math
from dataclasses import dataclass

import numpy as np

from . import coefficient_fits

Z_90 = 1.6448536269514722


@dataclass(frozen=True)
class Shrinkage:
    """before, after, floor (weighted RMS a contrast, mg or deg/s); share, interval (or None)."""

    before: float
    after: float
    floor: float
    share: float | None
    interval: tuple | None


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

    def shrinkage(self, found):
        """Shrinkage; found: something was named that can be foretold."""
        rms = [math.sqrt(max(v, 0.0) / self.weight) if self.weight > 0.0 else 0.0
               for v in (self.before, self.after, self.floor)]
        if not found:
            return Shrinkage(*rms, None, None)
        return Shrinkage(*rms, *fieller(self.before - self.floor, self.before - self.after,
                                        *self.spread))


NOTHING = Sums(0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0))


def of(data, chosen, index):
    """Shrinkage of all sessions, each held out in turn; index: into each unit's grid, the levels
    that count as noise."""
    columns = np.concatenate([c.columns for c in chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in chosen] + [np.zeros(0)])
    found = coefficient_fits.fits(data, columns, prior) if len(columns) else None
    total = NOTHING
    for held, (unit, point) in enumerate(zip(data.units, index)):
        if unit.between:
            continue
        own = along = 0.0
        if found:
            others = found[:held] + found[held + 1:] or found
            theta = coefficient_fits.coefficients(others, prior)[0][0]
            # Of whitened contrasts z and prediction d: d'd and d'z.
            own = float(theta @ unit.gram[point][np.ix_(columns, columns)] @ theta)
            along = float(theta @ unit.inner[point][columns])
        before, number = float(unit.quadratic[point]), float(unit.freedom)
        total = total + Sums(before, before - 2.0 * along + own, number, unit.weight(point),
                             (2.0 * number + 4.0 * max(before - number, 0.0), 4.0 * own,
                              4.0 * along))
    return total.shrinkage(bool(found))


def fieller(gap, closed, variance_gap, variance_closed, both):
    """(share, (low, high)); (share or None, None) where the interval is unbounded. both: the
    covariance."""
    z2 = Z_90 * Z_90
    a = gap * gap - z2 * variance_gap
    b = -2.0 * (gap * closed - z2 * both)
    c = closed * closed - z2 * variance_closed
    root = b * b - 4.0 * a * c
    if a <= 0.0 or root < 0.0 or closed <= 0.0:  # nothing closed: too little to learn it from
        return None, None
    low, high = (-b - math.sqrt(root)) / (2 * a), (-b + math.sqrt(root)) / (2 * a)
    return min(closed / gap, 1.0), (min(low, 1.0), min(high, 1.0))
