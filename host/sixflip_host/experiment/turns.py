"""The turn of the box in each move: gravity before and after against the gyro's rate integrated.

With R(t) the attitude since the start of a move, an error e(t) of the rate turns the end by
phi = int R(t) e(t) dt, and gravity carried back to the start is off by phi x up [Tedaldi et al.,
ICRA 2014, eq. 13-18, linearised]. Flips of one face also say that the turn was half a circle.
Everything is divided by the length of the move, so that it is in deg/s, as the effects are. Turns
are values: to take something out of their rates is to make other turns.
"""
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..capture.attitude import carried, rotations
from . import blocks
from .projection import cross, lateral_basis
from .session import ReadOnlyArrays

# Fits that begin with what the one before left: what a scale of 3 % leaves after the first is its
# square, 0.1 %, and after the second less than a hand's error of a turn.
ROUNDS = 2
PULL_DPS = 0.1  # deg/s per g, typical (effects/typical.py: g_sensitivity)
# Of a turn: a hand is not faster; over more than a minute a bias that is off by 0.01 deg/s turns
# the end by as much as a hand does (METHOD section 2); less than that is no turn to another pose.
SHORTEST_S, LONGEST_S, LEAST_DEG = 0.3, 60.0, 20.0
WHOLE = 0.7  # samples: half of one that is missing, and what the stamps of both ends scatter by
LEAST_STEP = 0.05  # periods between two samples, whatever their stamps


@dataclass(frozen=True, eq=False)
class Turn(ReadOnlyArrays):
    """One move from rest to rest over n samples, arrays read only.

    first, last: which samples (last exclusive); t (n,) s; rate (n, 3) deg/s about the bias;
    middle (n - 1, 3): between two samples, as corrected so far: middle = matrix rate - shift
    (3, 3), deg/s (3,); before, after (3,): up of the rests; flip: of one face, by its label;
    temperature (n - 1,) degC or None; wander (3,) deg/s: how far the bias may be off;
    railed: a sample was cut off; attitude (n - 1, 3, 3): at each sample since the start, and
    end (3, 3).
    """

    first: int
    last: int
    t: np.ndarray
    rate: np.ndarray
    middle: np.ndarray
    before: np.ndarray
    after: np.ndarray
    flip: bool
    temperature: np.ndarray | None
    wander: np.ndarray
    railed: bool
    matrix: np.ndarray
    shift: np.ndarray
    attitude: np.ndarray | None = None
    end: np.ndarray | None = None

    @cached_property
    def dt(self):
        return np.diff(self.t)

    @cached_property
    def shown(self):
        """(2 or 3, n - 1, 3): by how much what is observed of it grows with the rate between two
        samples, about each axis."""
        return np.tensordot(rows(self, lateral_basis(self.before)),
                            self.attitude * self.dt[:, None, None], axes=(1, 1))

    @property
    def seconds(self):
        return float(self.t[-1] - self.t[0])

    @property
    def turned(self):
        """Degrees of path."""
        return float((np.linalg.norm(self.middle, axis=1) * self.dt).sum())

    def integrated(self, matrix=None):
        """The turn with its attitude, of the rates as they are or turned by a matrix (3, 3)."""
        rate = self.middle if matrix is None else self.middle @ matrix.T
        way = carried(rotations(np.radians(rate) * self.dt[:, None]))
        return replace(self, attitude=way[:-1], end=way[-1])

    def corrected(self, matrix, shift):
        """The turn with matrix (3, 3) and shift (3,) deg/s taken out of its rates."""
        return replace(self, middle=self.middle @ matrix.T - shift, matrix=matrix @ self.matrix,
                       shift=matrix @ self.shift + shift).integrated()

    def read_as(self, middle):
        """The turn with other rates (n - 1, 3) deg/s."""
        return replace(self, middle=middle).integrated()

    def off(self):
        """Degrees between gravity before and gravity after, carried back."""
        cosine = np.clip(self.before @ self.end @ self.after, -1.0, 1.0)
        return float(np.degrees(np.arccos(cosine)))

    def usable(self, rate_hz):
        """True when it is neither cut off nor has gaps, and is long and far enough."""
        gaps = self.dt.max() if len(self.t) > 1 else 1.0
        return (not self.railed and gaps <= 5.0 / rate_hz and self.turned >= LEAST_DEG
                and SHORTEST_S <= self.seconds <= LONGEST_S)


def between(session, up, bias, place, wander=None):
    """Turn from a placement of a Session to the next, not integrated. up (placements, 3): unit
    vectors against gravity; bias (3,) deg/s; wander as Turn has it."""
    move = blocks.move_after(session, place)
    t = _even(session.t_s[move.first:move.end], session.period_s, session.uneven)
    rate = session.capture.gyro[move.first:move.end] / session.capture.meta[
        "gyro_lsb_per_dps"] - bias
    temperature = None if session.thermometer is None else session.thermometer.at(t[1:])
    return Turn(move.first, move.end, t, rate, 0.5 * (rate[1:] + rate[:-1]), up[place],
                up[place + 1], session.labelled and move.flip, temperature,
                np.zeros(3) if wander is None else wander, move.railed, np.eye(3), np.zeros(3))


def _even(t, period_s, uneven=False):
    """Times t (n,) s without what the stamps scatter by: spaced evenly where as many samples came
    as so much time takes; else, where some are missing or the samples are uneven themselves, as
    stamped, and none at the same time."""
    if not uneven and abs((t[-1] - t[0]) / period_s - (len(t) - 1)) < WHOLE:
        return np.linspace(t[0], t[-1], len(t))
    least = LEAST_STEP * period_s * np.arange(len(t))
    return np.maximum.accumulate(t - least) + least


def usable_turns(session, up):
    """tuple of Turn, integrated: every usable one between neighbouring placements of a Session
    (of a part: of its own). up (placements, 3)."""
    return tuple(integrated(usable_moves(session, up), session, up))


def usable_moves(session, up):
    """[Turn] as usable_turns() has them, not integrated."""
    rest = _bias(session)
    pairs = [p for p in rest if p + 1 in rest]
    if not pairs:
        return []
    # A bias that changes from rest to rest is known to about half of that in between.
    wander = np.sqrt(np.mean([(rest[p + 1] - rest[p]) ** 2 for p in pairs], axis=0)) / 2.0
    # What drifts is halfway between the rests before and after.
    candidates = (between(session, up, 0.5 * (rest[p] + rest[p + 1]), p, wander) for p in pairs)
    return [turn for turn in candidates if turn.usable(session.rate)]


def integrated(moves, session, up):
    """The Turns of some of the usable_moves() of a Session, integrated one by one as they are
    asked for."""
    rest = _bias(session)
    if not rest:
        return iter(())
    pull = _pull(np.array(list(rest.values())), up[list(rest)])
    return (_without_pull(turn.integrated(), pull) for turn in moves)


def _bias(session):
    """{placement: (3,) deg/s}, what the gyro reads in the rests of a Session, in their order."""
    return {p: session.gyro[session.placement == p].mean(axis=0)
            for p in np.unique(session.placement).tolist()}


def _pull(bias, up):
    """(3, 3) deg/s per g of the gyro by gravity, from its bias (placements, 3) at rests in the
    directions up (placements, 3): least squares with a prior of PULL_DPS a coefficient, against
    what is left as noise."""
    x = up - up.mean(axis=0)
    y = bias - bias.mean(axis=0)
    pull = np.zeros((3, 3))
    for _ in range(ROUNDS):
        noise = np.mean((y - x @ pull) ** 2, axis=0)
        pull = np.stack([np.linalg.solve(x.T @ x + np.eye(3) * (n / PULL_DPS ** 2 + 1e-12),
                                         x.T @ y[:, k]) for k, n in enumerate(noise)], axis=1)
    return pull.T


def _without_pull(turn, pull):
    """The turn without what gravity does to the gyro on the way, beyond the mean of both ends."""
    felt = np.einsum("nji,j->ni", turn.attitude, turn.before)
    ends = 0.5 * (turn.before + turn.after)
    return turn.read_as(turn.middle - (felt - ends) @ pull.T)


def rows(turn, axis_vectors):
    """(2 or 3, 3): what a small rotation (start frame, deg) does to what is observed."""
    first, second = axis_vectors
    # phi x up along two directions across up; a flip's turn about up itself
    directions = [cross(turn.before, first), cross(turn.before, second)]
    if turn.flip:
        directions.append(turn.before)
    return np.array(directions) / turn.seconds


def observed(turn):
    """(2 or 3,) deg/s: gravity carried back less gravity before; the flip's turn less 180."""
    axis_vectors = lateral_basis(turn.before)
    back = turn.end @ turn.after - turn.before
    angles = [np.degrees(back @ v) for v in axis_vectors]
    if turn.flip:
        first, second = axis_vectors
        carried = turn.end @ first
        angle = np.degrees(np.arctan2(carried @ second, carried @ first))
        angles.append((angle % 360.0) - 180.0)
    return np.array(angles) / turn.seconds


def projected(turn, added):
    """(2 or 3, k): rates added (n, 3, k), deg/s, as what is observed."""
    return turn.shown.reshape(len(turn.shown), -1) @ added.reshape(-1, added.shape[2])


def projected_by_axis(turn, functions):
    """(2 or 3, 3k): k functions (n, 3) of each axis' own rate, deg/s, with a coefficient an axis:
    those of the first function first."""
    by_axis = turn.shown.transpose(2, 0, 1) @ np.stack(functions, 2).transpose(1, 0, 2)
    return by_axis.transpose(1, 2, 0).reshape(len(turn.shown), -1)


def wandering(chosen):
    """list of (2 or 3, 2 or 3): covariance of what is observed of each turn, by a bias that is
    not known between two rests."""
    parts = []
    for turn in chosen:
        constant = projected_by_axis(turn, [np.ones((len(turn.dt), 3))])
        parts.append(constant @ np.diag(turn.wander ** 2) @ constant.T)
    return parts


def nuisance(chosen):
    """Columns: scale and misalignment (9), bias (3)."""
    parts = []
    for turn in chosen:
        every = [*(np.repeat(turn.middle[:, j:j + 1], 3, axis=1) for j in range(3)),
                 np.ones((len(turn.dt), 3))]
        columns = projected_by_axis(turn, every)
        parts.append(np.hstack([columns[:, [3 * j + i for i in range(3) for j in range(3)]],
                                columns[:, 9:]]))
    return np.vstack(parts)


def calibrated(chosen):
    """(what is observed (m,), the turns) with the nominal scale, misalignment and bias taken
    out of the rates of all of them."""
    for _ in range(ROUNDS):
        y = np.concatenate([observed(turn) for turn in chosen])
        sizes = np.linalg.lstsq(nuisance(chosen), y, rcond=1e-9)[0]
        matrix = np.eye(3) - sizes[:9].reshape(3, 3)
        chosen = tuple(turn.corrected(matrix, sizes[9:]) for turn in chosen)
    return np.concatenate([observed(turn) for turn in chosen]), chosen
