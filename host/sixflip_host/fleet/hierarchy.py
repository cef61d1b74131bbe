"""A population of boards: mean and covariance of what its parts have, by restricted likelihood.

    y_b = θ_b + e_b,  e_b ~ N(0, R_b) known,  θ_b ~ N(μ, Σ)

by EM [Laird & Ware, Biometrics 38 (1982) 963]; the uncertainty of μ is in the estimate of Σ
(restricted likelihood). A few parts may be anything: with the probability ε a board's own
deviation is λ times as wide [the contaminated normal distribution: Tukey (1960); Little, Applied
Statistics 37 (1988) 23], and both are estimated, so that a broken board neither moves the mean nor
widens the batch.
"""
from dataclasses import dataclass

import numpy as np

WIDER = (9.0, 36.0, 144.0, 900.0, 10000.0)  # λ: variances of what does not belong to the batch
ROUNDS, EVERY = 300, 5
STILL = 1e-4  # of a standard deviation: what a round must no longer change
UNKNOWN = 1e8  # variances of the boards: what a missing value counts as
START = 0.02  # ε in the first round
MOST = 0.25  # and at most: what more boards have is the batch
FEWEST = 3  # boards that a spread is made of
PIECE = 4096  # boards whose covariances are in memory at a time


@dataclass(frozen=True, eq=False)
class Population:
    """One block of k parameters over n boards.

    mean (k,) with error (k, k); spread (k, k): covariance of the boards' true values; belongs
    (n,): probability that a board is of the batch; wider: λ; rare: share ε; freedom: boards
    less one.
    """

    mean: np.ndarray
    error: np.ndarray
    spread: np.ndarray
    belongs: np.ndarray
    wider: float
    rare: float
    freedom: int

    def sigma(self, variance):
        """(m, k) standard deviation that estimates with these variances (m, k) have about the
        mean."""
        return np.sqrt(np.diag(self.spread) + np.diag(self.error) + variance)

    def shrunk(self, y, R, belongs):
        """(values (m, k), sigma (m, k)): each board's own values, as far as its estimates tell
        them from the batch's. What does not belong to the batch is not drawn to it, and what a
        board does not tell is the batch's."""
        scale = np.sqrt(np.maximum(np.diag(self.spread), np.diag(self.error)))
        y, R, known = _whole(y / scale, R / np.outer(scale, scale), self.mean / scale)
        weight = _weight(belongs, self.wider)
        unit = np.outer(scale, scale)
        wide = self.spread / unit * (1.0 / weight)[:, None, None]
        gain = wide @ np.linalg.inv(wide + R)
        value = self.mean / scale + np.einsum("nij,nj->ni", gain, y - self.mean / scale)
        left = np.einsum("nii->ni", wide - gain @ wide)
        return value * scale, np.sqrt(np.maximum(left, 0.0)) * scale


class _Boards:
    """Estimates y (n, k) and their covariances R[first:end] in units in which boards differ by
    about 1; a missing value is the median with a variance of UNKNOWN."""

    def __init__(self, y, R):
        self.R, self.n = R, len(y)
        self.variance = np.concatenate([np.einsum("nii->ni", R[cut]) for cut in cuts(self.n)])
        self.known = np.isfinite(y) & np.isfinite(self.variance)
        self.scale = np.array([self._width(y[:, j], j) for j in range(y.shape[1])])
        middle = [np.median(y[known, j]) if known.any() else 0.0
                  for j, known in enumerate(self.known.T)]
        self.y = np.where(self.known, y, middle) / self.scale
        self._kept = None

    def _width(self, y, j):
        own = y[self.known[:, j]]
        if not len(own):
            return 1.0
        width = 1.4826 * np.median(np.abs(own - np.median(own)))
        noise = np.sqrt(np.median(self.variance[self.known[:, j], j]))
        return max(width, noise, 1e-12 * max(np.abs(own).max(), 1e-300))

    def pieces(self):
        """(slice, y (m, k), R (m, k, k)) of PIECE boards at a time."""
        if self._kept is not None:
            return self._kept
        made = (self._piece(cut) for cut in cuts(self.n))
        if self.n <= PIECE:
            made = self._kept = list(made)
        return made

    def _piece(self, cut):
        R = self.R[cut] / np.outer(self.scale, self.scale)
        y, R, _ = _whole(np.where(self.known[cut], self.y[cut], np.nan), R, self.y[cut])
        return cut, y, R

    def first_spread(self):
        """A diagonal to begin with: the boards' robust variance less that of their estimates."""
        variances = []
        for j, known in enumerate(self.known.T):
            own = self.y[known, j]
            if not len(own):
                variances.append(1.0)
                continue
            width = 1.4826 * np.median(np.abs(own - np.median(own)))
            noise = np.median(self.variance[known, j]) / self.scale[j] ** 2
            variances.append(max(width ** 2 - noise, 0.01 * width ** 2, 1e-6))
        return np.diag(variances)


def cuts(n):
    """Slices of PIECE of n boards."""
    return [slice(k, min(k + PIECE, n)) for k in range(0, n, PIECE)]


def _whole(y, R, instead):
    """(y, R, known (m, k)) with what is missing put in: values `instead`, UNKNOWN variances."""
    known = np.isfinite(y) & np.isfinite(np.einsum("nii->ni", R))
    R = np.where(known[:, :, None] & known[:, None, :], R, 0.0)
    index = np.arange(y.shape[1])
    R[:, index, index] = np.where(known, R[:, index, index], UNKNOWN)
    return np.where(known, y, instead), R, known


def fit(y, R):
    """Population of estimates y (n, k), nan where there is none, with covariances R, of which
    R[first:end] are (m, k, k); None of fewer than FEWEST boards with a value.

    A round goes once over the boards, PIECE at a time, with mean, spread and error of the round
    before: in what the rounds come to rest at there is no difference.
    """
    y = np.array(y, float)
    boards = _Boards(y, R)
    n, k = y.shape
    dims = boards.known.sum(axis=1)
    if (dims > 0).sum() < FEWEST:
        return None
    mean, spread, error = np.median(boards.y, axis=0), boards.first_spread(), np.zeros((k, k))
    rare, wider, distance, weight = START, WIDER[1], np.zeros(n), np.ones(n)
    for turn in range(ROUNDS):
        precision, inner = np.zeros((k, k)), np.zeros(k)
        own, left, carried = np.zeros((3, k, k))
        for cut, values, errors in boards.pieces():
            inverse = np.linalg.inv(spread + errors)
            off = values - mean
            drawn = (inverse @ off[:, :, None])[:, :, 0]
            distance[cut] = (off * drawn).sum(axis=1)
            if turn:
                weight[cut] = _weight(_belongs(distance[cut], dims[cut], rare, wider), wider)
            weighted = inverse * weight[cut, None, None]
            precision += weighted.sum(axis=0)
            inner += weight[cut] @ drawn
            own += (drawn * weight[cut, None]).T @ drawn
            left += inverse.sum(axis=0)
            carried += np.einsum("nij,jk,nkl->il", weighted, error, inverse, optimize=True)
        error = np.linalg.inv(precision)
        step = error @ inner
        new = spread + spread @ (own + carried - left) @ spread / n
        if turn % EVERY == 0:
            wider = max(WIDER, key=lambda w: _likelihood(distance, dims, rare, w))
        rare = min(MOST, float((1.0 - _belongs(distance, dims, rare, wider)).mean()))
        moved = max(np.abs(np.sqrt(np.diag(new)) - np.sqrt(np.diag(spread))).max(),
                    np.abs(step).max())
        mean, spread = mean + step, 0.5 * (new + new.T)
        if moved < STILL and turn:
            break
    scale, unit = boards.scale, np.outer(boards.scale, boards.scale)
    return Population(mean * scale, error * unit, spread * unit,
                      _belongs(distance, dims, rare, wider), wider, rare,
                      int((dims > 0).sum()) - 1)


def _weight(belongs, wider):
    return belongs + (1.0 - belongs) / wider


def _likelihood(distance, dims, rare, wider):
    """Log likelihood of squared distances, what does not depend on λ left out."""
    common = np.log1p(-rare) - 0.5 * distance
    other = np.log(max(rare, 1e-6)) - 0.5 * dims * np.log(wider) - 0.5 * distance / wider
    return float(np.logaddexp(common, other).sum())


def _belongs(distance, dims, rare, wider):
    """Probability that a board at a squared distance is one of the batch."""
    nats = np.log(max(rare, 1e-6) / (1.0 - rare)) - 0.5 * dims * np.log(wider) \
        + 0.5 * distance * (1.0 - 1.0 / wider)
    return 1.0 / (1.0 + np.exp(np.clip(nats, -700.0, 700.0)))
