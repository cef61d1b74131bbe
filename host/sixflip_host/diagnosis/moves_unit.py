"""The moves from rest to rest of all sessions, those with poses and those of a robot that drives;
how strongly each is shaken on its way, frequency by frequency; and those of one session, or of a
half of one, as a unit of the posterior: what they say of the effects and of the strangers of
motion, all else integrated out with its prior.

A null is made of the moves themselves: what all hypotheses together leave of each, by the sizes
that the others give, with its sign by lot. That leaves the hand as it is, and takes away what it
has in common with an effect [ter Braak, Permutation versus bootstrap significance tests (1992)].
"""
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ..experiment import inertial_fit, turns
from ..experiment.attitude_fit import NominalSensor
from ..experiment.gram import Products
from ..experiment.session import MOST_BAD
from ..experiment.signal_measures import MEDIAN_OF_SQUARE
from ..experiment.terms import Design
from .detect import saturation
from .evidence import Levels

SLOW = 5  # frequencies that a way is in, and its mean
# ms: a hand trembles at 10 Hz at most, of which this is a radian; buffers and drivers that read in
# turns are some samples behind, a tenth of a second at most (GAP: a gyro 40 to 80 ms late).
LINEAR_MS, MOST_LATE_MS = 15.0, 150.0
NO_LEVELS = Levels(1.0, 1.0, 1.0, 1.0)  # of noise to choose from: the moves' own spectra are taken
# A hand moves with the least jerk [Flash & Hogan, J. Neurosci. 5 (1985) 1688]: 96 % of the square
# of such a move's acceleration is in its first four cosines.
CARRIED = 4
FIRST_HZ, OCTAVE = 0.3, 1.6  # of the bands of the tremor
FEWEST = 4  # values for a level of its own


@dataclass(frozen=True, eq=False)
class MovesUnit:
    """What scored_sets.Model asks of a unit, over the hypotheses' columns (K,): gram
    (Products), logdet (1,), silent (K,), energy (K,), designs; one point of a grid of levels.
    freedom: n moves, of which inner and left (n, K) are what they say of the columns as they are
    and as nulls are made of."""

    gram: Products
    inner: np.ndarray
    left: np.ndarray
    energy: np.ndarray
    designs: list
    silent: np.ndarray
    logdet: np.ndarray
    freedom: int

    between, turns, apart, within, rows = "", False, False, MappingProxyType({}), None
    grid, shape, coarse = ((0.0, 0.0),), (1, 1), np.array([0])

    def tried(self, likelihood, points=None):
        return self.coarse

    def around(self, point, reach=1):
        return self.coarse

    def statistics(self, signs=None, points=None):
        """(quadratic (1, R), projections (1, K, R)) of the moves as they are, or with their
        signs (n, R) drawn, at the one point of the grid; what no hypothesis changes is left out of
        the quadratic."""
        sums = self.inner.sum(axis=0)[:, None] if signs is None else self.left.T @ signs
        return np.zeros((1, sums.shape[1])), sums[None]

    def draw(self, index, generator, number):
        return generator.choice([-1.0, 1.0], (self.freedom, number))


def unit(gram, inner, left, columns, nuisance, prior, energy, designs, varying):
    """MovesUnit of the products of n moves: gram (n, k, k), inner and left (n, k); columns,
    nuisance: indices of the hypotheses' and of the other columns, of prior (k,); varying (K,):
    standard deviation of what each hypothesis' column is more or less in this session."""
    total = gram.sum(axis=0)
    block = total[np.ix_(nuisance, nuisance)] + np.diag(prior[nuisance] ** -2.0)
    taken = np.linalg.solve(block, total[np.ix_(nuisance, columns)])
    own = total[np.ix_(columns, columns)] - total[np.ix_(columns, nuisance)] @ taken
    inner, left = (sums[:, columns] - sums[:, nuisance] @ taken for sums in (inner, left))
    part = own * varying
    share = np.linalg.solve(np.eye(len(own)) + varying[:, None] * part, varying[:, None] * own)
    own = own - part @ share
    inner, left = (sums - (sums * varying) @ share for sums in (inner, left))
    power = np.diag(own)
    return MovesUnit(Products(own[None]), inner, left, energy, designs,
                     power <= 1e-9 * max(power.max(), 1e-300), np.zeros(1), len(gram))


def designs(prior):
    """list of Design of Move's columns that compete, in their order; prior: inertial_fit's."""
    designs, start = [], 0
    for effect, variant, axes in inertial_fit.COMPETING:
        part = slice(start, start + len(axes))
        keys = ["xyz"[a] for a in axes] if effect == "lever_arm" else [
            "tau"] if effect == "filter_lag" else ["%s%d" % ("xyz"[a], k)
                                                   for k, a in enumerate(axes)]
        designs.append(Design(effect, variant, keys, axes, np.zeros((0, len(axes))), prior[part]))
        start += len(axes)
    return designs


def moves(sessions, models, turned):
    """list of inertial_fit.Move. sessions: list of blocks.Session, the first len(models) with
    poses; models: their NominalSensor; turned: their calibrated turns."""
    unlagged = _moves(sessions, models, turned)
    late = _way_lag(unlagged)
    return _moves(sessions, models, turned, late) if late else unlagged


def _way_lag(moves):
    """ms: how late the accelerometer is behind the gyro by the slowest frequencies of each move
    that turns the box over, the median of all; nil where that is no more than a column of its
    derivative shows as well."""
    lags = []
    for move in moves:
        slow = slice(0, SLOW)
        column, y = move.table[slow, :, inertial_fit.LAG], move.y[slow]
        if not move.flat:
            lags.append(float((column * y).sum() / max(float((column ** 2).sum()), 1e-300)))
    late = float(np.median(lags)) if lags else 0.0
    return float(np.clip(late, -MOST_LATE_MS, MOST_LATE_MS)) if abs(late) > LINEAR_MS else 0.0


def _moves(sessions, models, turned, lag_ms=0.0):
    moves = []
    for number, session in enumerate(sessions):
        if number < len(models):
            chosen, sensor, runs = turned[number], models[number], session.runs
        else:
            chosen, sensor, runs = _driven(session, models, moves)
        if not chosen:
            continue
        course, white = _course(session.t_s), _white(session.capture, runs)
        railed = saturation.railed(session)
        moves += [inertial_fit.move(turn, session.capture, sensor, course, number,
                                    number < len(models), white, lag_ms)
                  for turn in chosen if railed[turn.first:turn.last].mean() <= MOST_BAD]
    return moves


def _driven(session, models, known):
    """(turns, NominalSensor, runs) of a session without poses: calibrated by the others."""
    runs = session.runs
    if len(runs) < 2 or not known:
        return [], None, []
    scale = 1000.0 / session.capture.meta["accel_lsb_per_g"]
    sensor = NominalSensor(np.mean([m.matrix for m in models], axis=0),
                           np.mean([m.offset for m in models], axis=0), None)
    felt = sensor.corrected(np.array([session.capture.accel[a:b].mean(axis=0) * scale
                                      for _, a, b in runs]))
    up = felt / np.linalg.norm(felt, axis=1)[:, None]
    bias = np.array([session.capture.gyro[a:b].mean(axis=0) for _, a, b in runs]
                    ) / session.capture.meta["gyro_lsb_per_dps"]
    matrix = np.mean([m.turn.matrix for m in known], axis=0)
    driven = [turns.between(session, up, 0.5 * (bias[place] + bias[place + 1]), place)
              for place in range(len(runs) - 1)]
    driven = [turn.corrected(matrix, np.zeros(3)) for turn in driven if turn.usable(session.rate)]
    return driven, sensor, runs


def _course(t):
    """(HATS, n) straight pieces over a session."""
    u = (t - t[0]) / max(t[-1] - t[0], 1e-9) * (inertial_fit.HATS - 1)
    return np.clip(1.0 - np.abs(u - np.arange(inertial_fit.HATS)[:, None]), 0.0, None)


def _white(capture, runs):
    """mg: standard deviation of the accelerometer's mean over one second, of all axes."""
    differences = np.concatenate([np.diff(capture.accel[a:b].astype(float), axis=0)
                                  for _, a, b in runs if b - a > 2])
    # The mean of a squared difference of two normal samples is twice their variance; rounding
    # adds a twelfth.
    counts = np.sqrt(np.median(differences ** 2, axis=0) / MEDIAN_OF_SQUARE / 2.0 + 1.0 / 12.0)
    return float(counts.mean()) * 1000.0 / capture.meta["accel_lsb_per_g"] / np.sqrt(
        capture.meta["rate_hz"])


def bands(move):
    """(n,) band of each frequency and (n,) what a level is multiplied with there."""
    k = np.arange(len(move.y))
    hz = k / (2.0 * move.seconds)
    band = 1 + CARRIED + np.maximum(0, np.log(np.maximum(hz, FIRST_HZ) / FIRST_HZ)
                                    / np.log(OCTAVE)).astype(int)
    band[:CARRIED + 1] = np.arange(CARRIED + 1)
    weight = np.ones(len(k))
    weight[1:CARRIED + 1] = len(k) / move.seconds ** 4
    weight[0] = len(k)
    return band, weight


def white(move):
    """mg²: of the sensor in one bin."""
    return move.white ** 2 / move.bin_s


def spectra(moves, squares, weights):
    """list of (n, 3) variances, one of each move. squares: of what is unexplained of each (n, 3);
    weights (moves,): how far each is believed. The lowest four frequencies of a move are how it
    was carried (metres, whatever its length), those above how it trembled (a density), the mean
    how well gravity is known on the way."""
    groups = {}
    for number, move in enumerate(moves):
        groups.setdefault((move.session, move.flat), []).append(number)
    variances = [None] * len(moves)
    for members in groups.values():
        flat = moves[members[0]].flat
        sums = {}
        for number in members:
            band, weight = bands(moves[number])
            square = squares[number]
            if flat:  # no way is onwards
                square = np.stack([0.5 * (square[:, 0] + square[:, 1])] * 2 + [square[:, 2]], 1)
            excess = (square - white(moves[number])) / weight[:, None]
            counted = np.column_stack([excess, np.ones(len(band))])
            first = np.flatnonzero(np.diff(band, prepend=-1))  # in the order of frequency
            for b, total in zip(band[first].tolist(), np.add.reduceat(counted, first)):
                sums[b] = sums.get(b, 0.0) + weights[number] * total
        level = _levels(sums)
        for number in members:
            band, weight = bands(moves[number])
            levels = np.stack([level[int(b)] for b in band])
            # No level is below the sensor's own noise.
            variances[number] = white(moves[number]) + np.maximum(levels, 0.0) * weight[:, None]
    return variances


def _levels(sums):
    """{band: (3,)}; bands with too little in them are joined with the one before."""
    levels, before = {}, None
    for b in sorted(sums):
        total = sums[b].copy()
        if total[3] < FEWEST and before is not None and b > CARRIED + 1:
            total += before
        levels[b] = total[:3] / max(total[3], 1e-9)
        before = total
    return levels
