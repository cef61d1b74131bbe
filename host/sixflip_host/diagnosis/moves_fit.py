"""All moves of all sessions fitted together: what each says of the columns that all have.

A move is the unit of replication: its own information on the sizes, weighted by how well it agrees
with the others (Student's t), habits of the hand and bends of the sensor beside them. The point
that it is turned about is another one in each, by as much as the moves themselves say. How
strongly hands (or wheels) shake and shift the box on its way is told frequency by frequency: a
spectrum for each kind of move of each session, along each direction, from the moves themselves
(moves_unit.spectra).
"""
from dataclasses import dataclass
from itertools import product

import numpy as np

from sixflip_sim.effects import typical

from ..experiment import inertial_fit
from . import moves_unit

FEWEST_FLAT = 6  # turns on a table, if there is one session only
SINGLE_FOLDS = 2  # of one session: every other move is foretold by those between
ROUNDS, FREEDOM = 4, 4.0  # of weighting; Student's t
BENT, WANDERED = (0.03, 0.1, 0.3, 1.0), (0.1, 0.3, 1.0)  # of the widest priors
EFFECTS = {"lever_arm": np.arange(3), "filter_lag": np.array([3])}  # their columns
AT_A_TIME = 64  # moves left out together
CENTRE = EFFECTS["lever_arm"]
# cm, tried: how far apart the points are that single moves turn about. A box on an axle, a hand
# that rolls it over its edges, one that holds it in the air.
CENTRES_CM = (0.0, 0.1, 0.3, 1.0, 3.0)


@dataclass(frozen=True, eq=False)
class MovesFit:
    """moves; prior (k,) of all columns: those of inertial_fit.COMPETING first, then nuisances;
    folds (moves,): which session; gram (moves, k, k) and inner (moves, k), weighted; precision:
    [(n, 3)] of each move, 1/mg²; one_hand: all turned in the air by one hand."""

    moves: list
    prior: np.ndarray
    folds: np.ndarray
    gram: np.ndarray
    inner: np.ndarray
    precision: list
    one_hand: bool

    @property
    def nuisance(self):
        return np.arange(inertial_fit.COMPETING_NUMBER, len(self.prior))

    @property
    def apart_ms(self):
        """typical.read_apart() of the moves' samples."""
        return typical.read_apart(1.0 / float(np.median(self.moves[0].turn.dt)))

    def own(self, move):
        """Indices of the columns that a move has."""
        return _own(move, sorted({m.session for m in self.moves}))

    def sizes(self, columns, among=None):
        """(theta (4,), covariance (4, 4)) with the effects that columns name; zeros elsewhere.
        The larger of what the model and what the scatter of the moves (jackknife) say. among
        (moves,) bool: of these moves only."""
        chosen = np.arange(len(self.moves)) if among is None else np.flatnonzero(among)
        prior = self.prior[columns]
        gram = self.gram[chosen[:, None, None], columns[:, None], columns]
        inner = self.inner[chosen[:, None], columns]
        theta, covariance = solved(gram.sum(axis=0), inner.sum(axis=0), prior)
        each = without_each(gram, inner, prior) - theta
        grown = np.sqrt(np.maximum((each ** 2).sum(axis=0) / np.diag(covariance), 1.0))
        covariance = covariance * grown * grown[:, None]
        sizes, spread = np.zeros(4), np.zeros((4, 4))
        effects = np.flatnonzero(columns < 4)
        sizes[columns[effects]] = theta[effects]
        spread[np.ix_(columns[effects], columns[effects])] = covariance[np.ix_(effects, effects)]
        return sizes, spread

    def solved(self, columns):
        """Sizes of these columns (k,) by all moves."""
        gram, inner = self.gram.sum(axis=0), self.inner.sum(axis=0)
        return solved(gram[np.ix_(columns, columns)], inner[columns], self.prior[columns])[0]

    def rms(self, left):
        """mg of what is left of each move, (n, 3) mg: quiet moves, directions and frequencies
        count more, as they do for the sizes."""
        total = sum(float((p * x ** 2).sum()) for p, x in zip(self.precision, left))
        return float(np.sqrt(total / sum(float(p.sum()) for p in self.precision)))

    def bare(self, columns, kept):
        """[(n, 3)] mg of each move less what these columns add, all but the effects kept (4,)
        bool."""
        habits = np.zeros(len(self.prior))
        habits[columns] = self.solved(columns)
        habits[:4][kept] = 0.0
        return [m.y - m.table @ habits[self.own(m)] for m in self.moves]


def fit(moves, chip):
    """MovesFit of moves of one chip."""
    sessions = sorted({m.session for m in moves})
    by_hand = {m.session: m.by_hand for m in moves}
    # What a hand in the air turns the box about may be its grip as well.
    one_hand = len(sessions) == 1 and by_hand[sessions[0]] and sum(
        m.flat for m in moves) < FEWEST_FLAT
    folds = np.array([sessions.index(m.session) for m in moves])
    if len(sessions) == 1:
        folds = np.arange(len(moves)) % SINGLE_FOLDS
    shared = inertial_fit.priors(chip)
    wide = np.concatenate([shared, *(inertial_fit.local_priors(by_hand[s]) for s in sessions)])
    squares, weights = [m.y ** 2 for m in moves], np.ones(len(moves))
    hands, theta = np.array([m.by_hand for m in moves]), np.zeros(len(wide))
    for _ in range(ROUNDS):
        variances = moves_unit.spectra(moves, squares, weights)
        plain = _information(moves, sessions, variances, len(wide))
        apart = _apart(*plain, theta, hands)
        gram, inner = _each_about_its_own(*plain, apart)
        total = np.tensordot(weights, gram, axes=1), weights @ inner
        prior = _settled(*total, wide, len(shared), len(sessions))
        theta, covariance = solved(*total, prior)
        weights, excess = _weighted(gram, inner, theta)
        squares = []
        for move, across, centre, within in zip(moves, plain[0], *_centres(*plain, theta, apart)):
            own = _own(move, sessions)
            # What the sizes are off by, a move's own centre makes good in part.
            columns = move.table - move.table[:, :, CENTRE] @ (within @ across[CENTRE][:, own])
            squares.append(_expected(move, move.y - move.table @ theta[own], centre, within)
                           + _spread(columns, covariance[np.ix_(own, own)]))
    weights = weights / excess
    gram *= weights[:, None, None]
    inner *= weights[:, None]
    return MovesFit(moves, prior, folds, gram, inner,
                    [w / v for w, v in zip(weights, variances)], one_hand)


def _own(move, sessions):
    local = np.arange(move.table.shape[2] - move.shared)
    start = move.shared + len(local) * sessions.index(move.session)
    return np.concatenate([np.arange(move.shared), start + local])


def _information(moves, sessions, variances, k):
    """(gram (moves, k, k), inner (moves, k)) of each move."""
    gram, inner = np.zeros((len(moves), k, k)), np.zeros((len(moves), k))
    for j, (move, variance) in enumerate(zip(moves, variances)):
        own = _own(move, sessions)
        root = 1.0 / np.sqrt(variance)
        scaled = (move.table * root[:, :, None]).reshape(-1, len(own))
        gram[j][np.ix_(own, own)] = scaled.T @ scaled
        inner[j, own] = scaled.T @ (move.y * root).ravel()
    return gram, inner


def _apart(gram, inner, theta, hands):
    """(moves,) cm, the likeliest of CENTRES_CM: how far from the others' the point is that each
    move turns about, for the moves of hands (moves,) bool and for others; theta (k,): of all."""
    block = gram[:, CENTRE[:, None], CENTRE]
    rest = inner[:, CENTRE] - gram[:, CENTRE] @ theta
    nats = []
    for sigma in CENTRES_CM:
        inside = np.eye(len(CENTRE)) + sigma ** 2 * block
        gained = np.einsum("ja,ja->j", rest, np.linalg.solve(
            inside, sigma ** 2 * rest[:, :, None])[:, :, 0])
        nats.append(0.5 * (gained - np.linalg.slogdet(inside)[1]))
    apart = np.zeros(len(hands))
    for kind in (hands, ~hands):
        apart[kind] = CENTRES_CM[int(np.sum(np.array(nats)[:, kind], axis=1).argmax())]
    return apart


def _each_about_its_own(gram, inner, apart):
    """(gram, inner) of moves each of which turns about a point of its own, apart (moves,) cm from
    the others': that point integrated out."""
    across = gram[:, :, CENTRE]
    inside = np.eye(len(CENTRE)) + apart[:, None, None] ** 2 * across[:, CENTRE]
    taken = np.linalg.solve(inside, apart[:, None, None] ** 2 * np.swapaxes(across, 1, 2))
    return (gram - across @ taken,
            inner - (np.swapaxes(taken, 1, 2) @ inner[:, CENTRE, None])[:, :, 0])


def _centres(gram, inner, theta, apart):
    """((moves, 3) cm, (moves, 3, 3) covariance): where each turns about, off what theta (k,) says
    of all."""
    rest = inner[:, CENTRE] - gram[:, CENTRE] @ theta
    inside = np.eye(len(CENTRE)) + apart[:, None, None] ** 2 * gram[:, CENTRE[:, None], CENTRE]
    covariance = np.linalg.inv(inside) * apart[:, None, None] ** 2
    return (covariance @ rest[:, :, None])[:, :, 0], covariance


def _expected(move, left, centre, covariance):
    """(n, 3) mg²: squares that are expected of what is left of a move about its own centre, which
    is known to a covariance only [Dempster, Laird & Rubin, J. R. Stat. Soc. B 39 (1977) 1]."""
    return (left - (own := move.table[:, :, CENTRE]) @ centre) ** 2 + _spread(own, covariance)


def _spread(columns, covariance):
    """(n, 3): variance of what columns (n, 3, k) add, their sizes known to a covariance only. A
    few moves are fitted better by their habits than the next ones will be, and a hand that seems
    to hold still would make any of them evidence."""
    rows = columns.reshape(-1, len(covariance))
    return np.einsum("ij,ij->i", rows @ covariance, rows).reshape(columns.shape[:2])


def _settled(gram, inner, wide, shared, sessions):
    """(k,) prior: how large bends of the sensor and the course of its bias are, the likeliest of a
    few levels, in place of priors that would let them be anything."""
    local = (len(wide) - shared) // sessions
    bends = np.arange(shared - inertial_fit.BENDS, shared)
    courses = shared + np.flatnonzero(np.tile(np.arange(local) >= 3, sessions))
    tried = []
    for bent, wandered in product(BENT, WANDERED):
        tried.append(wide.copy())
        tried[-1][bends] *= bent
        tried[-1][courses] *= wandered
    return max(tried, key=lambda prior: _evidence(gram, inner, prior))


def solved(gram, inner, prior):
    """(theta (k,), covariance (k, k)) of moves together."""
    scaled = gram * prior * prior[:, None] + np.eye(len(prior))
    covariance = np.linalg.inv(scaled) * prior * prior[:, None]
    return covariance @ inner, covariance


def without_each(gram, inner, prior):
    """(moves, k): sizes from all moves but one."""
    total, right = gram.sum(axis=0), inner.sum(axis=0)
    sizes = []
    for first in range(0, len(gram), AT_A_TIME):
        part = slice(first, first + AT_A_TIME)
        scaled = (total - gram[part]) * prior * prior[:, None] + np.eye(len(prior))
        sizes.append(np.linalg.solve(scaled, ((right - inner[part]) * prior)[:, :, None]
                                     )[:, :, 0] * prior)
    return np.concatenate(sizes)


def _weighted(gram, inner, theta):
    """(weights (moves,), mean excess): how well each move's effects agree with all others'."""
    left = inner[:, :4] - gram[:, :4] @ theta
    values, vectors = np.linalg.eigh(gram[:, :4, :4])
    keep = values > 1e-9 * np.maximum(values[:, -1:], 1e-30)
    turned = np.einsum("jab,ja->jb", vectors, left)
    q = (np.where(keep, turned ** 2 / np.where(keep, values, 1.0), 0.0)).sum(axis=1)
    weights = (FREEDOM + keep.sum(axis=1)) / (FREEDOM + q)
    return weights, max(float((weights * q).sum() / keep.sum()), 1.0)


def _evidence(gram, inner, prior):
    """Log evidence of all columns against none of them; inner (k,)."""
    lower = np.linalg.cholesky(gram * prior * prior[:, None] + np.eye(len(prior)))
    half = np.linalg.solve(lower, inner * prior)
    return float(0.5 * (half ** 2).sum() - np.log(np.diag(lower)).sum())
