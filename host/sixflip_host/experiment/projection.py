"""Least squares on columns: what some columns leave of others (projection, ranks, alias index),
and the regression of a sensor's three channels at once.

The signature of an effect is its columns (one a coefficient) after the nominal parameters have
been projected out; an effect without anything left is silent. The alias index A(a|b) =
|P_b S_a|^2 / |S_a|^2 is the share of a's signature that b can reproduce, averaged over a's
coefficients with equal weight.

The regression has coefficients of each channel's own and coefficients that they share, with
priors, and the noise of each channel by maximum likelihood [Bishop, Pattern Recognition and
Machine Learning (2006), section 3.5].
"""
from dataclasses import dataclass

import numpy as np

# Of the largest singular value, or of the energy before projection: rounding leaves 1e-29 of the
# energy of an effect that is silent, the weakest signature in any of the named protocols 5e-4.
NEGLIGIBLE = 1e-9
# Of the noise of each channel, which settles in four where the priors say little, in ten where a
# coefficient lies twelve of its prior from none; and by how much it has settled, a part of it.
ROUNDS, SETTLED = 30, 1e-6
ROUNDED = 1e-12  # of a sum of 1e5 products: columns that differ by less have their priors alone
LEAST_LEFT = 1e-9  # of a variance, (m/s2)2 or (rad/s)2: a simulator without noise has none
MOST_ROWS = 4000  # of a log that a fit looks at; each stands for those around it
# Stretches of a log, each of them one observation of what its coefficients are worth: a standard
# error by twenty is known to a sixth, and of a minute's log each holds about one move.
STRETCHES = 20
UNEVEN = 2.0  # standard errors that octaves are apart by chance in one of twenty
SEGMENT = 512  # rows whose spectrum is taken at once: ten seconds of a grid of 50 Hz


def lateral_basis(axis):
    """(2, 3): two unit vectors across a unit vector."""
    aside = np.zeros(3)
    aside[np.argmin(np.abs(axis))] = 1.0
    first = cross(axis, aside)
    first /= np.linalg.norm(first)
    return np.stack([first, cross(axis, first)])


def across_blocks(columns):
    """(3k, 3k - 2): orthonormal, across two columns (3k, 2) that are the same two directions in
    each of k blocks: first the differences between the blocks, axis by axis, then the mean
    across both directions."""
    k = len(columns) // 3
    first, second = columns[:3].T
    helmert = np.zeros((k, k - 1))
    for i in range(1, k):
        helmert[:i, i - 1], helmert[i, i - 1] = -1.0 / i, 1.0
    helmert /= np.linalg.norm(helmert, axis=0)
    mean = np.tile(np.cross(first, second), k) / np.sqrt(k)
    return np.hstack([np.kron(helmert, np.eye(3)), mean[:, None] / np.linalg.norm(mean)])


def cross(a, b):
    """(3,) of two vectors; numpy's own takes thirty times as long for a single pair."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def by_axis(functions):
    """(n, 3, 3k): k functions, each (n,) on all axes or (n, 3) of each axis' own, with a
    coefficient an axis: those of the first function first."""
    columns = np.zeros((len(functions[0]), 3, len(functions), 3))
    for number, values in enumerate(functions):
        columns[:, range(3), number, range(3)] = values.reshape(len(values), -1)
    return columns.reshape(len(columns), 3, -1)


def basis(columns):
    """Orthonormal basis (m, r) of the span of columns (m, k)."""
    if columns.shape[1] == 0:
        return columns
    u, s, _ = np.linalg.svd(columns, full_matrices=False)
    return u[:, s > NEGLIGIBLE * max(s[0], 1e-300)] if len(s) else u


def without(space, columns):
    """columns (m, k) with their part in the span of the orthonormal `space` removed, twice:
    once leaves rounding of the size that decides ranks."""
    for _ in range(2):
        columns = columns - space @ (space.T @ columns)
    return columns


def alias_index(a, b):
    """A(a|b) for two signatures (m, ka), (m, kb): 0 nothing, 1 all of a is in b."""
    space = basis(b)
    return float(((space.T @ a) ** 2).sum() / (a ** 2).sum())


def rank(columns, reference):
    """How many combinations of the columns exceed 1e-8 of the reference's largest."""
    if columns is None:
        return 0
    top = np.linalg.svd(reference, compute_uv=False)[0]
    return int((np.linalg.svd(columns, compute_uv=False) > 1e-8 * top).sum())


def alias_matrix(signatures):
    """(names, matrix): A(row | column) for {name: signature}, silent ones left out."""
    names = [name for name in signatures if signatures[name] is not None]
    spaces = {name: basis(signatures[name]) for name in names}
    table = np.array([[((spaces[b].T @ signatures[a]) ** 2).sum() / (signatures[a] ** 2).sum()
                       for b in names] for a in names])
    return names, table.reshape(len(names), len(names))


@dataclass(frozen=True)
class Regression:
    """log: evidence; own (3, p) coefficients of each channel and shared (k,) ones, with their
    standard errors; covariance (k, k) of the shared ones by the noise alone; left (n, 3), what is
    not predicted, or None; variance (3,) of the noise."""

    log: float
    own: np.ndarray
    own_sigma: np.ndarray
    shared: np.ndarray
    shared_sigma: np.ndarray
    covariance: np.ndarray
    left: np.ndarray
    variance: np.ndarray


def regression(y, own, own_sd, columns, mean, sd, inflation, live, rows=None, residuals=True,
               every=1, variance=None):
    """Regression of y (n, 3) = own (n, p) · beta of each channel + columns (n, 3, k) · shared,
    with priors own_sd (p,) or (3, p) about 0 and sd (k,) about mean (k,). every: of how many rows
    each of the n is one; variance (3,): of a noise near the one that is looked for. Without
    residuals what they cost on every row is saved: standard errors are those of noise alone."""
    n, p = own.shape
    weight = every_weight = np.ones(n) if rows is None else 1.0 / rows
    raw, fewer = (y, own, columns), max(1, n // MOST_ROWS) if every == 1 else 1
    weight, y, own, columns = (x[::fewer] for x in (weight, y, own, columns))
    n, k_rows = n * every, every * fewer
    y = (y - columns @ mean if mean.any() else y) * weight[:, None]
    own = own * weight[:, None]
    # Of each channel, and as rows that lie together: that is the speed of the products.
    columns = np.multiply(columns.transpose(1, 0, 2), weight[:, None], order="C")
    prior = np.concatenate([np.broadcast_to(own_sd, (3, p)).ravel(), sd])
    if variance is None:
        variance = np.maximum((y - y.mean(axis=0)).var(axis=0), LEAST_LEFT)
    grams, rights = products(y, own, columns, k_rows)
    power, looked = (y ** 2).sum(axis=0) * k_rows, len(y) * k_rows
    for _ in range(ROUNDS):
        weights = live / (variance * inflation)
        gram = np.diag(1.0 / prior ** 2) + np.tensordot(weights, grams, 1)
        gram[np.diag_indices(len(gram))] *= 1.0 + ROUNDED
        scale = np.sqrt(np.diag(gram))
        solved = np.linalg.solve(gram / np.outer(scale, scale), weights @ rights / scale) / scale
        # What is left, from the products: the rows themselves are gone through once, at the end.
        explained = (2.0 * rights - grams @ solved) @ solved
        before, variance = variance, np.maximum((power - explained) / looked, LEAST_LEFT)
        if np.all(np.abs(variance - before) <= SETTLED * before):
            break
    beta, shared = solved[:3 * p].reshape(3, p), solved[3 * p:]
    left = y - own @ beta.T - (columns @ shared).T
    variance = np.maximum((left ** 2).mean(axis=0), LEAST_LEFT)
    log = -0.5 * (n / inflation * np.log(variance[live]).sum() + ((solved / prior) ** 2).sum()
                  + np.linalg.slogdet(gram * np.outer(prior, prior))[1])
    inverse = np.linalg.inv(gram)
    sigma = np.sqrt(np.maximum(np.diag(inverse), 0.0))
    shared = shared + mean
    if residuals:
        weights = live / (variance * inflation)
        sigma = np.maximum(sigma, scattered(inverse, left, own, columns, k_rows * weights))
        left = raw[0] - raw[1] @ beta.T - raw[2] @ shared
        sigma = np.hypot(sigma, uneven(solved, left, *raw[1:], every_weight, every * weights,
                                       prior))
    return Regression(log, beta, sigma[:3 * p].reshape(3, p), shared, sigma[3 * p:],
                      inverse[3 * p:, 3 * p:], left if residuals else None, variance)


def products(y, own, columns, number):
    """(3, 3 p + k, 3 p + k), (3, 3 p + k): normal equations of each channel, of y (n, 3) on own
    (n, p) of its own and columns (3, n, k) that all share; each row stands for a number."""
    p, size = own.shape[1], 3 * own.shape[1] + columns.shape[2]
    grams, rights = np.zeros((3, size, size)), np.zeros((3, size))
    gram, right, shared = own.T @ own, own.T @ y, slice(3 * p, size)
    for c, channel in enumerate(columns):
        mine = slice(c * p, (c + 1) * p)
        grams[c, mine, mine] = gram
        grams[c, mine, shared] = own.T @ channel
        grams[c, shared, mine] = grams[c, mine, shared].T
        grams[c, shared, shared] = channel.T @ channel
        rights[c, mine], rights[c, shared] = right[:, c], channel.T @ y[:, c]
    return grams * number, rights * number


def scattered(inverse, left, own, columns, weights):
    """Standard errors (3 p + k,) of the coefficients by how much stretches of the log disagree on
    them: what a robot does besides is another thing in each of its moves, of no steady size
    [Liang & Zeger, Biometrika 73 (1986), 13, equation 8]. weights (3,): of a channel's samples."""
    n, p = own.shape
    edges = np.linspace(0, n, STRETCHES, endpoint=False).astype(int)
    parts = []
    shared = 0.0
    for c in range(3):
        score = weights[c] * left[:, c:c + 1]
        parts.append(np.add.reduceat(own * score, edges, axis=0))
        shared = shared + np.add.reduceat(columns[c] * score, edges, axis=0)
    pulls = np.concatenate([*parts, shared], 1) @ inverse
    return np.sqrt(STRETCHES / (STRETCHES - 1.0) * (pulls ** 2).sum(axis=0))


def uneven(sizes, left, own, columns, rows, weights, prior):
    """Standard deviations (3 p + k,) that coefficients of such sizes (3 p + k,) have from one
    octave of frequencies to another: what bends between two sensors shakes them unlike near a
    frequency of its own, which is the scale of neither. It is what is said without an octave, less
    what its noise and the priors make of the same sizes there, as of a jackknife [Efron, The
    Jackknife, the Bootstrap (1982)]. rows (n,) weigh the samples, weights (3,) the channels'
    squares; prior (3 p + k,)."""
    n, p = own.shape
    long = min(n, SEGMENT)
    window = np.hanning(long + 2)[1:-1] * np.sqrt(8.0 / 3.0)  # has the power of none
    number = np.log2((long // 2 + 1) / np.maximum(np.arange(long // 2 + 1), 0.5)).astype(int)
    size = 3 * p + columns.shape[2]
    grams, pulls = np.zeros((number.max() + 1, size, size)), np.zeros((number.max() + 1, size))
    every = np.concatenate([own, columns.reshape(n, -1), left], 1) * rows[:, None]
    parts = every[:n // long * long].reshape(-1, long, every.shape[1]) * window[:, None]
    spectra = np.fft.rfft(parts, axis=1) * np.sqrt(2.0 / long)
    mine, all_share = [slice(c * p, (c + 1) * p) for c in range(3)], slice(3 * p, size)
    for gram, pull, octave in zip(grams, pulls, range(len(grams))):
        some = spectra[:, number == octave].reshape(-1, every.shape[1])
        some = np.concatenate([some.real, some.imag])
        each, shared = some[:, :p], some[:, p:-3].reshape(len(some), 3, -1)
        of_own = each.T @ each
        for c, a in enumerate(mine):
            of_channel = np.ascontiguousarray(shared[:, c])
            gram[a, a] = weights[c] * of_own
            gram[a, all_share] = weights[c] * each.T @ of_channel
            gram[all_share, a] = gram[a, all_share].T
            gram[all_share, all_share] += weights[c] * of_channel.T @ of_channel
            pull[a] = weights[c] * each.T @ some[:, c - 3]
            pull[all_share] += weights[c] * of_channel.T @ some[:, c - 3]
    whole, far = grams.sum(axis=0), 0.0
    scale = np.sqrt(np.diag(whole) + prior ** -2.0)

    def inverse(gram):
        return np.linalg.inv((gram + np.diag(prior ** -2.0)) / np.outer(scale, scale)
                             + ROUNDED * np.eye(size)) / np.outer(scale, scale)
    # What the windows weigh is fitted best by sizes that are a little off.
    more = inverse(whole) @ (pulls.sum(axis=0) - sizes / prior ** 2)
    for gram, pull in zip(grams, pulls):
        covariance = inverse(whole - gram)
        apart = covariance @ ((sizes + more) / prior ** 2 - pull + gram @ more)
        noise = np.diag(covariance) - (covariance ** 2) @ prior ** -2.0
        far = far + np.maximum(apart ** 2 - UNEVEN ** 2 * np.maximum(noise, 0.0), 0.0)
    return np.sqrt((1.0 - 1.0 / len(grams)) * far)
