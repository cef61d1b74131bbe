"""The covariance of a session's readings, factored so that time and memory grow as the session.

Readings come in groups, one a placement (or a turn), in the order of time. Within a group the
covariance may be anything: white noise and what is fixed, the group's lateral directions times
the square of a placement level, flicker. Between groups there is flicker only, a sum of
exponentials, so that one state for each carries all that a group says of those after it: the
Cholesky factor of such a (semiseparable) matrix needs a few small matrices a group, and no
matrix of all readings [Foreman-Mackey et al., Astron. J. 154 (2017) 220, extended from single
readings to groups].
"""
import copy
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from .noise_arrays import ALL_TIMES_S, flicker_kernel

AT_A_TIME = 512  # whitened rows that are there at once: memory, not time
# Time alone decides these two (python -m tests.studies.bench.diagnose_cost --cores 1).
FEW = 300  # readings up to which one matrix of all of them takes less time than many small ones
SMALL = 24  # rows of a matrix up to which many at once take less time than each by itself


@dataclass(frozen=True, eq=False)
class Group:
    """Readings rows (slice) of all, r of them: base (r, r) white and fixed; lateral (r, q) of
    unit level; kernel (r, r) of unit flicker within; from_before (r, J) how the states that
    groups before have left are felt, to_later (r, J) what it leaves to those after it, decay
    (J,) of the states over it; basis (r, r - l): across l directions that are a nuisance in
    this group only, see projection.across_blocks().
    """

    rows: slice
    base: np.ndarray
    lateral: np.ndarray
    kernel: np.ndarray
    from_before: np.ndarray
    to_later: np.ndarray
    decay: np.ndarray
    basis: np.ndarray


def alone(base, lateral, kernel):
    """[Group] of readings that are one group: base (n, n), lateral (n, q), kernel (n, n)."""
    n, none = len(base), np.zeros((len(base), 0))
    return [Group(slice(0, n), base, lateral, kernel, none, none, np.zeros(0), np.eye(n))]


def apart(bases, laterals, kernels):
    """[Group] of groups that leave nothing to those after them: base (r, r), lateral (r, q) and
    kernel (r, r) of each, the last with a level of its own."""
    groups, start = [], 0
    for base, lateral, kernel in zip(bases, laterals, kernels):
        n, none = len(base), np.zeros((len(base), 0))
        groups.append(Group(slice(start, start + n), base, lateral, kernel, none, none,
                            np.zeros(0), np.eye(n)))
        start += n
    return groups


def in_time(t, seconds, shares, parts):
    """[Group] of blocks of three readings each (x y z): t, seconds (n,) of the blocks; shares
    (3,): variance of each axis' flicker; parts: [(slice of blocks, base, lateral, basis)]."""
    times = np.array(ALL_TIMES_S)
    axes = np.sqrt(shares)
    ends, groups, before = t + 0.5 * seconds, [], None
    for blocks, base, lateral, basis in parts:
        own_t, own_s = t[blocks], seconds[blocks]
        last = ends[blocks].max()
        before = own_t[0] - 0.5 * own_s[0] if before is None else before
        x = own_s[:, None] / times
        mean = (1.0 - np.exp(-x)) / x
        felt = mean * np.exp(-np.maximum(own_t - 0.5 * own_s - before, 0.0)[:, None] / times)
        left = mean * np.exp(-(last - ends[blocks])[:, None] / times)
        groups.append(Group(
            slice(3 * blocks.start, 3 * blocks.stop), base, lateral,
            _of_axes(flicker_kernel(own_t, own_s), shares), _of_axes(felt, axes),
            _of_axes(left, axes), np.repeat(np.exp(-max(last - before, 0.0) / times), 3), basis))
        before = max(last, before)
    return groups


def _of_axes(values, sizes):
    """Kronecker product of values (a, b) and the diagonal matrix of sizes (3,)."""
    product = np.zeros((len(values), 3, values.shape[1], 3))
    for axis, size in enumerate(sizes):
        product[:, axis, :, axis] = values * size
    return product.reshape(3 * len(values), -1)


def reduced(groups):
    """The groups without the directions that are a nuisance of their own: readings in the basis
    across them."""
    reduced_groups, start = [], 0
    for g in groups:
        turned, n = g.basis.T, g.basis.shape[1]
        reduced_groups.append(Group(
            slice(start, start + n), turned @ g.base @ g.basis, turned @ g.lateral,
            turned @ g.kernel @ g.basis, turned @ g.from_before, turned @ g.to_later, g.decay,
            np.eye(n)))
        start += n
    return reduced_groups


def turned(groups, x):
    """(n', R) readings x (n, R) in the bases of their groups."""
    return np.concatenate([g.basis.T @ x[g.rows] for g in groups])


def turned_back(groups, x):
    """(n, R) from (n', R): readings that have nothing in the directions left out."""
    readings, start = [], 0
    for g in groups:
        n = g.basis.shape[1]
        readings.append(g.basis @ x[start:start + n])
        start += n
    return np.concatenate(readings)


class Factor:
    """Cholesky factor of base + placement^2 lateral lateral' + flicker^2 kernel for L placement
    levels at once. logdet (L,): half of the logarithm of the determinant."""

    def __init__(self, groups, placements, flicker):
        levels = np.asarray(placements, float)
        self.groups, self.n = groups, groups[-1].rows.stop
        self.inverses, self.gains = [], []
        self.logdet = np.zeros(len(levels))
        known = np.zeros((len(levels), len(groups[0].decay), len(groups[0].decay)))
        for g in groups:
            own = g.base + flicker ** 2 * g.kernel + levels[:, None, None] ** 2 * (
                g.lateral @ g.lateral.T)
            felt = g.from_before @ known
            lower = np.linalg.cholesky(own - felt @ g.from_before.T)
            inverse = inverses(lower)
            gain = (flicker ** 2 * g.to_later.T - g.decay[:, None] * felt.transpose(0, 2, 1)
                    ) @ inverse.transpose(0, 2, 1)
            known = known * (g.decay[:, None] * g.decay) + gain @ gain.transpose(0, 2, 1)
            self.logdet += np.log(np.diagonal(lower, axis1=1, axis2=2)).sum(axis=1)
            self.inverses.append(inverse)
            self.gains.append(gain)

    def whitened(self, x):
        """(L, n, R): the inverse of the factor times x (n, R)."""
        return np.concatenate(list(self.whitened_parts(x)), axis=1)

    def whitened_parts(self, x):
        """whitened() piece by piece, some rows at a time."""
        levels = len(self.logdet)
        state = np.zeros((levels, len(self.groups[0].decay), x.shape[1]))
        coupled = state.shape[1] > 0
        pieces, rows = [], 0
        for g, inverse, gain in zip(self.groups, self.inverses, self.gains):
            left = x[g.rows] - g.from_before @ state if coupled else x[g.rows]
            white = inverse @ left
            if coupled:
                state *= g.decay[:, None]
                state += gain @ white
            pieces.append(white)
            rows += white.shape[1]
            if rows >= AT_A_TIME:
                yield np.concatenate(pieces, axis=1)
                pieces, rows = [], 0
        if pieces:
            yield np.concatenate(pieces, axis=1)

    def at(self, places):
        """The Factor at some of its placement levels."""
        chosen = copy.copy(self)
        chosen.logdet = self.logdet[places]
        chosen.inverses = [matrices[places] for matrices in self.inverses]
        chosen.gains = [matrices[places] for matrices in self.gains]
        return chosen

    def whitened_back(self, white):
        """(L, n, R): the transpose of the inverse of the factor times white (L, n, R), so that
        of whitened readings comes the inverse of the covariance times the readings."""
        back = np.empty_like(white)
        state = np.zeros((len(self.logdet), len(self.groups[0].decay), white.shape[2]))
        coupled = state.shape[1] > 0
        for g, inverse, gain in zip(self.groups[::-1], self.inverses[::-1], self.gains[::-1]):
            own = white[:, g.rows]
            if coupled:
                own = own + gain.transpose(0, 2, 1) @ state
            own = inverse.transpose(0, 2, 1) @ own
            if coupled:
                state *= g.decay[:, None]
                state -= g.from_before.T @ own
            back[:, g.rows] = own
        return back

    def coloured(self, white):
        """(n, R): the factor of the first level times white (n, R)."""
        coloured = np.empty_like(white)
        state = np.zeros((len(self.groups[0].decay), white.shape[1]))
        for g, inverse, gain in zip(self.groups, self.inverses, self.gains):
            own = white[g.rows]
            coloured[g.rows] = lapack.dtrtrs(inverse[0].T, own, trans=1)[0] + g.from_before @ state
            state = g.decay[:, None] * state + gain[0] @ own
        return coloured


def inverses(lower):
    """Inverses of lower triangles (L, n, n). numpy's knows nothing of triangles, but takes many
    small ones at once."""
    if lower.shape[1] <= SMALL:
        return np.linalg.inv(lower)
    return np.stack([lapack.dtrtri(triangle, lower=1)[0] for triangle in lower])


def energies(groups, basis):
    """(3,): traces of what is left of base, lateral lateral' and kernel when the orthonormal
    columns basis (n, p) are projected out."""
    total = np.zeros(3)
    state = np.zeros((len(groups[0].decay), basis.shape[1]))
    for g in groups:
        own = basis[g.rows]
        for k, part in enumerate((g.base, g.lateral @ g.lateral.T, g.kernel)):
            total[k] += np.trace(part) - (own * (part @ own)).sum()
        total[2] -= 2.0 * (own * (g.from_before @ state)).sum()
        state = g.decay[:, None] * state + g.to_later.T @ own
    return total


def components(groups):
    """(3, n, n): base, lateral lateral' and kernel of all readings, for what is small."""
    n = groups[-1].rows.stop
    parts, state = np.zeros((3, n, n)), np.zeros((len(groups[0].decay), n))
    for g in groups:
        own, before = g.rows, slice(g.rows.start)
        parts[:, own, own] = g.base, g.lateral @ g.lateral.T, g.kernel
        felt = g.from_before @ state[:, before]
        parts[2, own, before], parts[2, before, own] = felt, felt.T
        state[:, before] *= g.decay[:, None]
        state[:, own] = g.to_later.T
    return parts


def dense(groups, placement, flicker):
    """(n, n) the covariance itself, for what is small."""
    base, lateral, kernel = components(groups)
    return base + placement ** 2 * lateral + flicker ** 2 * kernel
