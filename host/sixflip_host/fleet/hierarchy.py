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


@dataclass(frozen=True, eq=False)
class Population:
    """One block of k parameters over n boards.

    mean (k,) with error (k, k); spread (k, k): covariance of the boards' true values; belongs
    (n,): probability that a board is of the batch; shrunk (n, k) with shrunk_error (n, k, k):
    each board's own values, as far as its estimates tell them from the batch's; total (n, k):
    variance that an estimate has about the mean; rare: share ε; freedom: boards less one.
    """

    mean: np.ndarray
    error: np.ndarray
    spread: np.ndarray
    belongs: np.ndarray
    shrunk: np.ndarray
    shrunk_error: np.ndarray
    total: np.ndarray
    rare: float
    freedom: int


def fit(y, R):
    """Population of estimates y (n, k), nan where there is none, with covariances R (n, k, k);
    None of fewer than FEWEST boards with a value."""
    y, R, scale, known = _prepared(np.array(y, float), np.array(R, float))
    n, k = y.shape
    if known.any(axis=1).sum() < FEWEST:
        return None
    mean, spread = np.median(y, axis=0), _first_spread(y, R, known)
    rare, wider, weight = START, WIDER[1], np.ones(n)
    for turn in range(ROUNDS):
        inverse, logdet = _inverse(spread + R)
        weighted = inverse * weight[:, None, None]
        error = np.linalg.inv(weighted.sum(axis=0))
        new_mean = error @ np.einsum("nij,nj->i", weighted, y)
        off = y - new_mean
        distance = np.einsum("ni,nij,nj->n", off, inverse, off)
        dims = known.sum(axis=1)
        if turn % EVERY == 0:
            wider = max(WIDER, key=lambda w: _likelihood(distance, dims, rare, w))
        belongs = _belongs(distance, dims, rare, wider)
        rare = min(MOST, float((1.0 - belongs).mean()))
        weight = belongs + (1.0 - belongs) / wider
        gain = spread @ inverse
        own = np.einsum("nij,nj->ni", gain, off)
        left = spread - gain @ spread
        carried = gain @ error @ gain.transpose(0, 2, 1)
        new = (np.einsum("n,ni,nj->ij", weight, own, own) + left.sum(axis=0)
               + (weight[:, None, None] * carried).sum(axis=0)) / n
        moved = max(np.abs(np.sqrt(np.diag(new)) - np.sqrt(np.diag(spread))).max(),
                    np.abs(new_mean - mean).max())
        mean, spread = new_mean, 0.5 * (new + new.T)
        if moved < STILL:
            break
    inverse, _ = _inverse(spread + R)
    # What does not belong to the batch is not drawn to it.
    wide = spread * (1.0 / weight)[:, None, None]
    gain = wide @ _inverse(wide + R)[0]
    shrunk = mean + np.einsum("nij,nj->ni", gain, y - mean)
    unit = np.outer(scale, scale)
    return Population(mean * scale, error * unit, spread * unit, belongs, shrunk * scale,
                      (wide - gain @ wide) * unit,
                      (np.diag(spread) + np.diag(error)
                       + np.einsum("nii->ni", R)) * scale ** 2, rare,
                      int(known.any(axis=1).sum()) - 1)


def _prepared(y, R):
    """(y, R, scale (k,), known (n, k)) in units in which boards differ by about 1; a missing
    value is 0 with a variance of UNKNOWN."""
    variance = np.einsum("nii->ni", R)
    known = np.isfinite(y) & np.isfinite(variance)
    scale = np.ones(y.shape[1])
    for j in range(y.shape[1]):
        own = y[known[:, j], j]
        if len(own):
            width = 1.4826 * np.median(np.abs(own - np.median(own)))
            noise = np.sqrt(np.median(variance[known[:, j], j]))
            scale[j] = max(width, noise, 1e-12 * max(np.abs(own).max(), 1e-300))
    y = np.where(known, y, 0.0) / scale
    middle = np.array([np.median(y[known[:, j], j]) if known[:, j].any() else 0.0
                       for j in range(y.shape[1])])
    y = np.where(known, y, middle)
    R = np.where(known[:, :, None] & known[:, None, :], R, 0.0) / np.outer(scale, scale)
    index = np.arange(y.shape[1])
    R[:, index, index] = np.where(known, R[:, index, index], UNKNOWN)
    return y, R, scale, known


def _first_spread(y, R, known):
    """A diagonal to begin with: the boards' robust variance less that of their estimates."""
    found = []
    for j in range(y.shape[1]):
        own = y[known[:, j], j]
        if not len(own):
            found.append(1.0)
            continue
        width = 1.4826 * np.median(np.abs(own - np.median(own)))
        found.append(max(width ** 2 - np.median(R[known[:, j], j, j]), 0.01 * width ** 2, 1e-6))
    return np.diag(found)


def _inverse(C):
    values = np.linalg.inv(C)
    return values, np.linalg.slogdet(C)[1]


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
