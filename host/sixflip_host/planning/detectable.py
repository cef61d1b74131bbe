"""The smallest size of each effect that a planned capture would show, at 80 % power.

Generalised least squares with known variances: white noise over the samples of a row, the scatter
of a placement by hand (two small turns), flicker as the diagnosis has it. The unit of replication
is the placement, never the sample (GAP finding 3).
"""
import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from sixflip_sim.effects import typical

from ..experiment.flicker import flicker_kernel
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
    """A PlannedModel (design) in rows of equal, independent noise: whitener (3n, 3n) takes rows
    there, space (3n, r) is an orthonormal basis of what the nominal parameters take up there."""

    design: PlannedModel
    whitener: np.ndarray
    space: np.ndarray

    def _white(self, columns):
        return self.whitener @ columns

    def smallest(self, name):
        """{key: smallest size seen with 80 % power}; SILENT where nothing of it is left."""
        keys, columns = self.design.raw(name)
        space = self.space
        if name in self.design.own:  # a nuisance itself: measured beside the others
            rest = self.design.without_own(name)
            space = basis(self._white(rest.space))
        white = self._white(columns)
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
        kernel = flicker(self.design.rows)
        white = self.whitener @ kernel @ self.whitener.T
        left = white - self.space @ (self.space.T @ white)
        left = left - (left @ self.space) @ self.space.T
        information = 0.5 * (left ** 2).sum()
        return math.sqrt(QUANTILE / math.sqrt(information)) if information > 0 else SILENT


def power_of(design, chip, rate_hz=100.0, step=0.0):
    """Power of a PlannedModel read by a chip (a key of typical.NOISE) at rate_hz; step: size of
    a count, mg or deg/s."""
    noise = covariance(design, chip, rate_hz, step)
    whitener = np.linalg.inv(np.linalg.cholesky(noise))
    return Power(design, whitener, basis(whitener @ design.space))


def flicker(rows):
    """(3n, 3n) covariance of unit flicker, axes and sessions apart."""
    kernel = flicker_kernel(rows.at.t, rows.seconds)
    return np.kron(kernel * (rows.session[:, None] == rows.session[None]), np.eye(3))


def covariance(design, chip, rate_hz, step=0.0):
    """(3n, 3n) in mg2 or (deg/s)2; step: of a count."""
    rows = design.rows
    sigma = np.array(typical.noise_at(chip, rate_hz, step))
    white = sigma ** 2 / np.maximum(rows.seconds * rate_hz, 1.0)[:, None]
    total = np.diag(white.reshape(-1)) + typical.FLICKER[chip] ** 2 * flicker(rows)
    if design.sensor == "accel":
        level = (math.radians(PLACEMENT_DEG) * MG_PER_RAD) ** 2
        for placement in np.unique(rows.placement):
            mask = np.repeat(rows.placement == placement, 3)
            turns = design.tilts_of(placement)[mask]
            total[np.ix_(mask, mask)] += level * turns @ turns.T
    else:  # a half turn by hand: an error of the angle, seen as rate along the axis turned
        error = np.where(rows.rest, 0.0, FLIP_DEG / rows.seconds)
        for k in np.flatnonzero(~rows.rest):
            along = np.array([rows.at.up[i][k] * error[k] for i in range(3)])
            total[3 * k:3 * k + 3, 3 * k:3 * k + 3] += np.outer(along, along)
    return total


def middle(sizes):
    """The median over the coefficients; SILENT when half of them are."""
    values = sorted(sizes.values())
    return values[(len(values) - 1) // 2] if values else SILENT
