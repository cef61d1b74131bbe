"""The nominal model of one session by generalised least squares: a session becomes a Unit.

The nominal model's nuisance is projected out of the rows (nominal_rows.py); what is left of the
readings is the contrasts z. Their covariance C is white / n + placement + flicker. The levels of
the last two are found on a grid by restricted maximum likelihood [Patterson & Thompson, Biometrika
58 (1971) 545].

Everything later needs only z' C^-1 z, S' C^-1 z and S' C^-1 S at the points of the grid (S: the
columns of all effects), so these are what a Unit holds, the last only where it is asked for
(gram.py): to try a set of effects is to take some of their rows and columns. What is a nuisance of
one placement only is projected out there, and the covariance is factored in time (covariance.py),
so that time and memory grow as the session does."""
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy import linalg

from . import covariance, factored_gram, gram
from .nominal_rows import Rows

AT_A_TIME = 256  # columns of a unit matrix that are there at once: memory, not time
# Times the largest level of placement that is looked at: a hundredth is left of what such a
# placement says of where it lies.
LOOSE = 10.0
# Share of its energy below which a column is silent: rounding leaves 1e-22 of it, the weakest
# column that says anything in a session of the paper's or the recommended protocol 2e-6.
NOTHING = 1e-7
# Nats that a level of noise may be behind a quieter one and still be looked at: exp(-10) is
# 1 in 20,000, which no prior here makes up for (diagnosis/odds.py).
HOPELESS = 10.0


@dataclass(frozen=True, eq=False)
class Unit:
    """One session (or a part of one) of one sensor, reduced to sufficient statistics.

    rows; designs: list of terms.Design, their K columns side by side; grid: list of (placement
    level, flicker level), G of them, in a table of this shape; z (m,) contrasts and columns (m,
    K), in the basis of the rows' groups without what space (m, p), orthonormal, holds; freedom;
    energy (K,), silent (K,) bool; gram: gram.Products, logdet (G,), quadratic (G,),
    inner (G, K).
    signature: what the protocol is known by, see cutoffs.py. within: {(effect, variant, number
    of its choice): nats that the blocks of the rests say for it, less what it cost to look for
    it}. between: what of the sessions it is the difference of, "bias" or "scale", or "", see
    between_sessions.py. turns: the turns that it was made of, where all columns are asked
    for. axis: 0..2 where the units are axes, which have no coefficient in common.
    """

    rows: Rows
    designs: list
    grid: list
    shape: tuple
    groups: list
    space: np.ndarray
    z: np.ndarray
    columns: np.ndarray
    freedom: int
    energy: np.ndarray
    silent: np.ndarray
    gram: gram.Products
    logdet: np.ndarray
    quadratic: np.ndarray
    inner: np.ndarray
    signature: tuple = ()
    within: dict = field(default_factory=dict)
    between: str = ""
    turns: tuple = ()
    axis: int | None = None
    _factors: dict = field(default_factory=dict, init=False, repr=False)

    @property
    def apart(self):
        """Whether it has no coefficient in common with the others."""
        return self.axis is not None

    @property
    def coarse(self):
        """Every other level of placement and of flicker, as indices of the grid."""
        return np.arange(len(self.grid)).reshape(self.shape)[::2, ::2].ravel()

    def tried(self, likelihood, points=None):
        """Of points of the grid (None: the coarse selection) those that are worth a look, where
        there may be more than noise: without those that by noise alone, log likelihood (G,) or
        of several data sets (G, R), are far behind a quieter one in all of them, since whatever
        there is shows more and gains more there."""
        points = self.coarse if points is None else points
        grid, alone = np.array(self.grid)[points], likelihood.reshape(len(self.grid), -1)[points]
        quieter = (grid <= grid[:, None]).all(axis=2)
        best = np.array([alone[row].max(axis=0) for row in quieter])
        return points[(alone > best - HOPELESS).any(axis=1)]

    def around(self, point, reach=1):
        """Indices of a point of the grid and its neighbours, so many steps off at most."""
        a, b = divmod(point, self.shape[1])
        every = np.arange(len(self.grid)).reshape(self.shape)
        return every[max(a - reach, 0):a + reach + 1,
                     max(b - reach, 0):b + reach + 1].ravel()

    def raw(self, columns):
        """(rows, k) columns before projection."""
        return np.hstack([d.columns for d in self.designs])[:, columns]

    def contrasts(self, y):
        """(m,) contrasts of other readings y (n,) of the same rows."""
        z = covariance.turned(self.rows.groups, y[:, None])[:, 0]
        return z - self.space @ (self.space.T @ z)

    def in_rows(self, z):
        """(n,) the contrasts as readings: what the nuisance leaves."""
        return covariance.turned_back(self.rows.groups, z[:, None])[:, 0]

    def noise_energy(self, placement, level, with_common=True):
        """Expected sum of squares of the contrasts where there is nothing but noise; with_common:
        and what is known beforehand to a standard deviation."""
        base, lateral, kernel = covariance.energies(self.groups, self.space)
        noise = base + placement ** 2 * lateral + level ** 2 * kernel
        if not with_common:
            return noise
        common = self.rows.turned_common()
        left = common - self.space @ (self.space.T @ common)
        known = left @ self._open_still(common, placement, level) if self.rows.fitted else left
        return noise + float((known * left).sum())

    def _open_still(self, common, placement, level):
        """(c, c) covariance of coefficients of columns common (m, c), known to 1 beforehand, with
        what the readings tell of them at these levels of noise."""
        factor = covariance.Factor(self._together, [placement], level)
        white = factor.whitened(np.hstack([self.space, common]))[0]
        number = self.space.shape[1]
        taken = np.linalg.lstsq(white[:, :number], white[:, number:], rcond=None)[0]
        left = white[:, number:] - white[:, :number] @ taken
        return np.linalg.inv(np.eye(common.shape[1]) + left.T @ left)

    def statistics(self, z=None, points=None):
        """(quadratic (G, R), projections (G, K, R)) of contrasts z (m, R), default the data's;
        points: which of the grid are asked for, see
        factored_gram.FactoredGram."""
        if z is None:
            return self.quadratic[:, None], self.inner[:, :, None]
        return self.gram.statistics(z, points)[:2]

    def chi2(self, z, index):
        """Of contrasts z (m,) against noise with the levels of one point of the grid."""
        return float(self.products(z[:, None], index)[0, 0])

    def products(self, z, index):
        """(R, R) z'Qz of contrasts z (m, R), Q the inverse of their covariance at one point of
        the grid, across what is a nuisance."""
        common = self.rows.turned_common()
        white = self._factor(index).whitened(np.hstack([self.space, common, z]))[0]
        number = white.shape[1] - z.shape[1]
        fixed, data = white[:, :number], white[:, number:]
        metric = fixed.T @ fixed
        known = np.arange(self.space.shape[1], number)
        metric[known, known] += 1.0
        taken = fixed.T @ data
        return data.T @ data - taken.T @ np.linalg.solve(metric, taken)

    def weight(self, index):
        """Trace of the metric Q of products()."""
        n = self.space.shape[0]
        return sum(float(np.trace(self.products(np.eye(n, min(AT_A_TIME, n - first), -first),
                                                index)))
                   for first in range(0, n, AT_A_TIME))

    @cached_property
    def _together(self):
        """[Group] of the same readings: one where they are few, which takes less time than
        many."""
        if self.groups[-1].rows.stop > covariance.FEW or len(self.groups) == 1:
            return self.groups
        base, _, kernel = covariance.components(self.groups)
        return covariance.alone(base, linalg.block_diag(*(g.lateral for g in self.groups)), kernel)

    def _factor(self, index):
        """covariance.Factor at one point of the grid; the last one is kept."""
        if index not in self._factors:
            self._factors.clear()
            placement, level = self.grid[index]
            self._factors[index] = covariance.Factor(self._together, [placement], level)
        return self._factors[index]

    def draw(self, index, generator, number):
        """Contrasts (m, R) without any effect, with the levels of one point of the grid."""
        factor = self._factor(index)
        z = factor.coloured(generator.standard_normal((factor.n, number)))
        common = self.rows.turned_common()
        z = z + common @ generator.standard_normal((common.shape[1], number))
        return z - self.space @ (self.space.T @ z)

    def innovations(self, point, private, explained, loose=False):
        """(m, 3) what is left of the readings at a point (placement, flicker), whitened in the
        order of time to a standard deviation of 1, and (m, 3) the share of each that the fit
        takes up. private: columns that are fitted as the nuisance is; explained (n,): what the
        others add. Of a placement that is free across gravity, the differences of its blocks;
        loose: every one may lie anywhere there, as in a fit, and what it takes up of a reading
        is in its share."""
        placement = LOOSE * max(a for a, _ in self.grid) if loose else point[0]
        factor = covariance.Factor(self.groups, [placement], point[1])
        fitted = np.hstack([self.rows.nuisance, self.raw(private)])
        x = covariance.turned(self.rows.groups, np.column_stack(
            [fitted, self.rows.y - explained]))
        common = self.rows.turned_common()
        white = factor.whitened(np.hstack([common, x]))[0]
        # Coefficients known to a standard deviation of 1 are observed as 0 with that error.
        known = np.eye(common.shape[1], white.shape[1])
        basis, s, _ = np.linalg.svd(np.vstack([white, known])[:, :-1], full_matrices=False)
        basis = basis[:len(white), s > 1e-9 * s[0]]
        left = white[:, -1] - basis @ (basis.T @ white[:, -1])
        leverage = (basis ** 2).sum(axis=1)
        if loose:
            leverage += np.concatenate([
                ((inverse[0] @ g.lateral * placement) ** 2).sum(axis=1)
                for g, inverse in zip(self.groups, factor.inverses)])
        keep = np.concatenate([np.arange(g.rows.start, g.rows.start
                                         + (g.rows.stop - g.rows.start) // 3 * 3)
                               for g in self.groups])
        return left[keep].reshape(-1, 3), leverage[keep].reshape(-1, 3)


def unit(rows, designs, wanted=None, **about):
    """Unit of Rows and a list of Design; about: the fields that say what it is of. wanted:
    indices of the columns that are asked for, the others count as silent (None: all)."""
    groups = covariance.reduced(rows.groups)
    nuisance = covariance.turned(rows.groups, rows.nuisance)
    space, s, _ = np.linalg.svd(nuisance, full_matrices=False)
    space = space[:, s > 1e-9 * max(s[0], 1e-300)] if s[0] > 0.0 else space[:, :0]

    def left(x):
        x = covariance.turned(rows.groups, x)
        return x - space @ (space.T @ x)
    raw = np.hstack([np.zeros((len(rows.y), 0)), *(d.columns for d in designs)])
    columns, z = left(raw), left(rows.y[:, None])
    energy = (raw ** 2).sum(axis=0)
    silent = (columns ** 2).sum(axis=0) <= NOTHING * np.maximum(energy, 1e-300)
    if wanted is not None:
        silent |= ~np.isin(np.arange(len(silent)), wanted)
    columns[:, silent] = 0.0
    placements, flickers = rows.levels
    if not any(g.lateral.shape[1] for g in groups):
        placements = placements[:1]
    grid = [(a, b) for a in placements for b in flickers]
    shape = len(placements), len(flickers)
    make = gram.dense_products if len(columns) <= covariance.FEW else factored_gram.FactoredGram
    grams = make(groups, grid, space, rows.turned_common(), columns)
    quadratic, inner, logdet = grams.statistics(z)
    return Unit(rows, designs, grid, shape, groups, space, z[:, 0],
                columns, len(z) - space.shape[1], 3.0 * (raw ** 2).mean(axis=0), silent, grams,
                logdet, quadratic[:, 0], inner[:, :, 0], **about)
