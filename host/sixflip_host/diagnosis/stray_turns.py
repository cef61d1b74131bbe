"""Turns that end far from where gravity says while the others do not, as where samples were lost.

What is left across gravity of each turn, degrees, is either of one kind, normal or with the
heavier tails of a hand (Student's t), or of that kind and of a far larger one for a share of them.
Each is judged by its likelihood with scale, misalignment and bias integrated out [Laplace's
method; Kass & Raftery, J. Am. Stat. Assoc. 90 (1995) 773]: in a session with few turns these bend
to most of them, and the turn that they do not bend to is not far off for that.
"""
from dataclasses import dataclass

import numpy as np
from scipy import special

from ..experiment import turns
from .moves_fit import FREEDOM

LEVELS_DEG = tuple(0.03 * 1.35 ** k for k in range(18))  # of turns that are alike
FAR_DEG, FAR_TIMES = (5.0, 15.0, 45.0), 5.0  # a tenth of a second that is lost, and more
SHARES = (0.01, 0.03, 0.1, 0.3)  # tried, of turns that are far off
TAILS = (FREEDOM, 1e6)  # degrees of freedom of turns that are alike; so many are normal
ROUNDS = 8  # of weighting turns by how far they are off


@dataclass(frozen=True, eq=False)
class Ends:
    """Where the n turns of one session end: off (n, 2) degrees across gravity; columns (n, 2, p)
    of what may be unknown in them; known (n, 2) deg^2 that the bias and gravity's direction at
    rest make of it."""

    off: np.ndarray
    columns: np.ndarray
    known: np.ndarray


def ends(unit, forms, attitude_deg):
    """Ends of the turns of a linear_model.Unit; forms: hypotheses.Forms of what was found in
    them, which is unknown as well; attitude_deg: of gravity's direction at rest."""
    chosen = unit.turns
    columns = np.hstack([unit.rows.nuisance, *(unit.raw(form.columns) for form in forms)])
    seconds = np.array([t.seconds for t in chosen])
    first = np.cumsum([0] + [3 if t.flip else 2 for t in chosen])[:-1]
    rows = np.stack([first, first + 1], 1)
    wander = np.array([np.diag(block)[:2] for block in turns.wandering(chosen)])
    columns = columns[rows] * seconds[:, None, None]
    flat = columns.reshape(len(rows) * 2, -1)
    _, size, turned = np.linalg.svd(flat / np.maximum(np.linalg.norm(flat, axis=0), 1e-30),
                                    full_matrices=False)
    scaled = columns / np.maximum(np.linalg.norm(flat, axis=0), 1e-30)
    return Ends(unit.rows.y[rows] * seconds[:, None],
                scaled @ turned[size > 1e-6 * max(size.max(), 1e-30)].T,
                wander * seconds[:, None] ** 2 + attitude_deg ** 2)


def nats(sessions):
    """(nats, number of turns) by which some turns of sessions (list of Ends) being far off is
    likelier than all being alike."""
    alike = max(_likelihood(sessions, _alike(level, tail))[0]
                for level in LEVELS_DEG + FAR_DEG for tail in TAILS)
    apart = [(level, far, tail) for level in LEVELS_DEG for far in FAR_DEG for tail in TAILS
             if far >= FAR_TIMES * level]
    best, number = max(_likelihood(sessions, _apart(*levels, share))
                       for levels in apart for share in SHARES)
    return best - alike - np.log(len(SHARES) * len(FAR_DEG)), number


def _alike(level, tail):
    """Density of turns that are off by one level: see _likelihood."""
    def density(left, known):
        variance = known + level ** 2
        square = (left ** 2 / variance).sum(axis=1)
        value = -0.5 * (tail + 2.0) * np.log1p(square / tail) - 0.5 * np.log(variance).sum(axis=1)
        weight = (tail + 2.0) / (tail + square)
        return value, weight[:, None] / variance, np.zeros(len(left))
    return density


def _apart(level, far, tail, share):
    """Density of turns of which a share is off by a far larger level: see _likelihood."""
    usual, lost = _alike(level, tail), _alike(far, TAILS[-1])

    def density(left, known):
        (near, near_precision, _), (off, off_precision, _) = usual(left, known), lost(left, known)
        near, off = near + np.log1p(-share), off + np.log(share)
        chance = special.expit(off - near)
        return (np.logaddexp(near, off), near_precision
                + chance[:, None] * (off_precision - near_precision), chance)
    return density


def _likelihood(sessions, density):
    """(log likelihood, expected number of turns far off) with what is unknown of each session
    integrated out. density(left (n, 2), known (n, 2)) -> log density (n,), precision (n, 2) with
    which each turn counts, chance (n,) that it is far off."""
    total = number = 0.0
    for session in sessions:
        precision = 1.0 / session.known
        for _ in range(ROUNDS):
            weighted = session.columns * precision[:, :, None]
            gram = np.einsum("nki,nkj->ij", weighted, session.columns)
            theta = np.linalg.solve(gram, np.einsum("nki,nk->i", weighted, session.off))
            left = session.off - session.columns @ theta
            value, precision, chance = density(left, session.known)
        weighted = session.columns * precision[:, :, None]
        gram = np.einsum("nki,nkj->ij", weighted, session.columns)
        total += float(value.sum()) - 0.5 * np.linalg.slogdet(gram)[1]
        number += float(chance.sum())
    return total, number
