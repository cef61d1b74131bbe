"""Columns of functions, and what some columns leave of others: projection, ranks, alias index.

The signature of an effect is its columns (one a coefficient) after the nominal parameters have
been projected out; an effect without anything left is silent. The alias index A(a|b) =
|P_b S_a|^2 / |S_a|^2 is the share of a's signature that b can reproduce, averaged over a's
coefficients with equal weight.
"""
import numpy as np

# Of the largest singular value, or of the energy before projection: rounding leaves 1e-29 of the
# energy of an effect that is silent, the weakest signature in any of the named protocols 5e-4.
NEGLIGIBLE = 1e-9


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
