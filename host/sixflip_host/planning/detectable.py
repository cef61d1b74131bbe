"""The smallest size of each effect that a planned capture would show, at 80 % power.

Generalised least squares with the covariance that the diagnosis has (experiment/covariance.py), of
known variances: white noise over the samples of a row, the scatter of a placement by hand (two
small turns), flicker. The unit of replication is the placement, never the sample (GAP finding 3).
"""
import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from sixflip_sim.effects import typical

from ..experiment import covariance
from ..experiment.projection import basis, without
from .alias import PlannedModel

PLACEMENT_DEG = 0.05  # scatter of placing a box by hand (METHOD section 1)
FLIP_DEG = 0.4  # error of a half turn by hand (METHOD section 2)
POWER_80 = NormalDist().inv_cdf(0.8)  # standard deviations beyond a cutoff: seen in 80 %
# Two-sided 5 % over 12 tests (Bonferroni), and 80 % power.
QUANTILE = NormalDist().inv_cdf(1.0 - 0.05 / 2.0 / 12.0) + POWER_80
SILENT = math.inf
MG_PER_RAD = 1000.0  # of gravity, across it


@dataclass(frozen=True, eq=False)
class Power:
    """A PlannedModel (design) and the covariance of each session's rows: factors, list of (places
    of its rows, covariance.Factor); space (3n, r) is an orthonormal basis of what the nominal
    parameters take up of rows of equal, independent noise."""

    design: PlannedModel
    factors: list
    space: np.ndarray

    def whitened(self, columns):
        """(3n, k): columns (3n, k) in rows of equal, independent noise."""
        return _whitened(self.factors, columns)

    def smallest(self, name):
        """{key: smallest size seen with 80 % power}; SILENT where nothing of it is left."""
        keys, columns = self.design.raw(name)
        space = self.space
        if name in self.design.own:  # a nuisance itself: measured beside the others
            space = basis(self.whitened(self.design.without_own(name).space))
        white = self.whitened(columns)
        left = without(space, white)
        sizes = {}
        for j, key in enumerate(keys):
            norm, before = np.linalg.norm(left[:, j]), np.linalg.norm(white[:, j])
            seen = before > 0 and norm > 1e-6 * before
            sizes[key] = float(QUANTILE / norm) if seen else SILENT
        return sizes

    def smallest_flicker(self):
        """Level of flicker on top of the white noise and the placements that would be told
        from them: the variance's standard error from its Fisher information."""
        n = 3 * self.design.rows.n
        kernel = np.zeros((n, n))
        for places, factor in self.factors:
            kernel[np.ix_(places, places)] = covariance.components(factor.groups)[2]
        white = self.whitened(self.whitened(kernel).T)
        left = white - self.space @ (self.space.T @ white)
        left = left - (left @ self.space) @ self.space.T
        information = 0.5 * (left ** 2).sum()
        return math.sqrt(QUANTILE / math.sqrt(information)) if information > 0 else SILENT


def power_of(design, chip, rate_hz=100.0, step=0.0):
    """Power of a PlannedModel read by a chip (a key of typical.NOISE) at rate_hz; step: size of
    a count, mg or deg/s."""
    noise = np.array(typical.noise_at(chip, rate_hz, step))
    factors = []
    for session in np.unique(design.rows.session):
        own = np.flatnonzero(design.rows.session == session)
        groups = _groups(design, own, noise ** 2 / rate_hz)
        places = (3 * own[:, None] + np.arange(3)).ravel()
        factors.append((places, covariance.Factor(groups, [1.0], typical.FLICKER[chip])))
    return Power(design, factors, basis(_whitened(factors, design.space)))


def _whitened(factors, columns):
    white = np.empty_like(columns)
    for places, factor in factors:
        white[places] = factor.whitened(columns[places])[0]
    return white


def _groups(design, own, density):
    """list of covariance.Group of the rows `own` of one session: of each placement, and of the
    turn before it. density (3,): of white noise, mg2 s or (deg/s)2 s."""
    rows, parts = design.rows, []
    for placement in np.unique(rows.placement[own]):
        places = np.flatnonzero(rows.placement[own] == placement)
        mine = own[places]
        white = np.diag((density / rows.seconds[mine][:, None]).ravel())
        parts.append((slice(places[0], places[-1] + 1), white, _by_hand(design, placement, mine),
                      np.eye(3 * len(mine))))
    return covariance.in_time(rows.at.t[own], rows.seconds[own], np.ones(3), parts)


def _by_hand(design, placement, mine):
    """(3k, q) what a hand's placement and its half turn add to the k rows of a placement, each
    of a standard deviation of 1."""
    if design.sensor == "accel":
        own = (3 * mine[:, None] + np.arange(3)).ravel()
        return math.radians(PLACEMENT_DEG) * MG_PER_RAD * design.tilts_of(placement)[own]
    # An error of the angle is seen as a rate along the axis turned about.
    error = np.where(design.rows.rest[mine], 0.0, FLIP_DEG / design.rows.seconds[mine])
    return (error[:, None] * np.stack(design.rows.at.up, 1)[mine]).reshape(-1, 1)


def middle(sizes):
    """The median over the coefficients; SILENT when half of them are."""
    values = sorted(sizes.values())
    return values[(len(values) - 1) // 2] if values else SILENT
