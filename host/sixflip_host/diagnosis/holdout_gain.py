"""Stage 6: how far the gap shrinks on the session held out.

With whitened contrasts z = mu + noise of the session held out (m of them) and the prediction d
of the causes, whose coefficients come from the other sessions, the explainable gap is
|mu|^2 = z'z - m and what is closed of it 2 d'z - d'd. Both are sums with known variances, so
their ratio has a Fieller interval [Fieller, JRSS B 16 (1954) 175]; unbounded means that the gap
is too small to measure.
"""
import math
from dataclasses import dataclass

import numpy as np

from . import coefficient_fits

Z_90 = 1.6448536269514722
FLOOR = 0.05  # of the noise's variance, standard deviation: it is estimated, too


@dataclass(frozen=True)
class Shrinkage:
    """before, after, floor (RMS a contrast, mg or deg/s); share, interval (or None)."""

    before: float
    after: float
    floor: float
    share: float | None
    interval: tuple | None


def of(data, chosen, index):
    """Shrinkage of all sessions, each held out in turn; index: into each unit's grid, the levels
    that count as noise."""
    columns = np.concatenate([c.columns for c in chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in chosen] + [np.zeros(0)])
    found = coefficient_fits.fits(data, columns, prior) if len(columns) else None
    before = after = floor = closed = gap = number = 0.0
    strength = along = 0.0
    for held, (unit, point) in enumerate(zip(data.units, index)):
        if unit.between:
            continue
        z, theta = unit.z, np.zeros(len(columns))
        if found:
            others = found[:held] + found[held + 1:] or found
            theta = coefficient_fits.coefficients(others, prior)[0][0]
        left = z - unit.columns[:, columns] @ theta
        # Of whitened contrasts z and prediction d: d'd and d'z.
        own = theta @ unit.gram[point][np.ix_(columns, columns)] @ theta
        both = theta @ unit.inner[point][columns]
        before += z @ z
        after += left @ left
        floor += unit.noise_energy(*unit.grid[point])
        number += unit.freedom
        gap += unit.quadratic[point] - unit.freedom
        closed += 2.0 * both - own
        strength += own
        along += both
    rms = [math.sqrt(max(v, 0.0) / max(number, 1)) for v in (before, after, floor)]
    if not found:
        return Shrinkage(*rms, None, None)
    return Shrinkage(*rms, *fieller(gap, closed, number, strength, along))


def fieller(gap, closed, number, strength, along):
    """(share, (low, high)); (share or None, None) where the interval is unbounded."""
    variance_gap = 2.0 * number + 4.0 * max(gap, 0.0) + (FLOOR * number) ** 2
    variance_closed, both = 4.0 * strength, 4.0 * along
    z2 = Z_90 * Z_90
    a = gap * gap - z2 * variance_gap
    b = -2.0 * (gap * closed - z2 * both)
    c = closed * closed - z2 * variance_closed
    root = b * b - 4.0 * a * c
    if a <= 0.0 or root < 0.0 or closed <= 0.0:  # nothing closed: too little to learn it from
        return None, None
    low, high = (-b - math.sqrt(root)) / (2 * a), (-b + math.sqrt(root)) / (2 * a)
    return min(closed / gap, 1.0), (min(low, 1.0), min(high, 1.0))
