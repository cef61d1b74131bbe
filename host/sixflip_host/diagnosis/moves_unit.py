"""The moves of one session, or of a half of one, as a unit of the posterior: what they say of the
effects and of the strangers of motion, all else integrated out with its prior.

A null is made of the moves themselves: what all hypotheses together leave of each, by the sizes
that the others give, with its sign by lot. That leaves the hand as it is, and takes away what it
has in common with an effect [ter Braak, Permutation versus bootstrap significance tests (1992)].
"""
import numpy as np

from ..experiment import inertial_fit
from ..experiment.gram import Products
from ..experiment.terms import Design
from .evidence import Levels

NO_LEVELS = Levels(1.0, 1.0, 1.0)  # of noise to choose from: the moves' own spectra are taken


class MovesUnit:
    """What scored_sets.Model asks of a unit, over the hypotheses' columns (K,): gram
    (Products), logdet (1,), silent (K,), energy (K,), designs; one point of a grid of levels."""

    between, turns, apart, within, rows = False, False, False, {}, None
    grid, shape, coarse = [(0.0, 0.0)], (1, 1), np.array([0])

    def __init__(self, gram, inner, left, columns, nuisance, prior, energy, designs):
        """gram (n, k, k), inner and left (n, k) of the moves; columns, nuisance: indices of the
        hypotheses' and of the other columns, of prior (k,)."""
        total = gram.sum(axis=0)
        block = total[np.ix_(nuisance, nuisance)] + np.diag(prior[nuisance] ** -2.0)
        self._taken = np.linalg.solve(block, total[np.ix_(nuisance, columns)])
        own = (total[np.ix_(columns, columns)]
               - total[np.ix_(columns, nuisance)] @ self._taken)
        self.gram = Products(own[None])
        self._inner, self._left = (one[:, columns] - one[:, nuisance] @ self._taken
                                   for one in (inner, left))
        self.logdet = np.zeros(1)
        self.energy, self.designs = energy, designs
        power = np.diag(own)
        self.silent = power <= 1e-9 * max(power.max(), 1e-300)
        self.freedom = len(gram)

    def tried(self, likelihood, points=None):
        return self.coarse

    def around(self, point, reach=1):
        return self.coarse

    def statistics(self, signs=None, points=None):
        """(quadratic (1, R), projections (1, K, R)) of the moves as they are, or with their
        signs (n, R) drawn, at the one point of the grid; what no hypothesis changes is left out of
        the quadratic."""
        sums = self._inner.sum(axis=0)[:, None] if signs is None else self._left.T @ signs
        return np.zeros((1, sums.shape[1])), sums[None]

    def draw(self, index, generator, number):
        return generator.choice([-1.0, 1.0], (self.freedom, number))


def designs(prior):
    """list of Design of Move's columns that compete, in their order; prior: inertial_fit's."""
    found, start = [], 0
    for effect, variant, axes in inertial_fit.COMPETING:
        part = slice(start, start + len(axes))
        keys = ["xyz"[a] for a in axes] if effect == "lever_arm" else [
            "tau"] if effect == "filter_lag" else ["%s%d" % ("xyz"[a], k)
                                                   for k, a in enumerate(axes)]
        found.append(Design(effect, variant, keys, axes, np.zeros((0, len(axes))), prior[part]))
        start += len(axes)
    return found
