"""The accelerometer in motion: what it reads on the way from one rest to the next, less gravity.

The gyro, as the rests and turns have calibrated it, says where gravity is on the way; gravity at
both ends pins it. What is left is seen from the table, as frequencies over the move (a cosine
transform): the hand's own acceleration is large there and can be anything, but its mean is zero,
for the box rests at both ends; and what is fixed to the box or to the sensor turns with it.
"""
import numpy as np

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS
from sixflip_sim.effects.moment import Moment

from ..capture.attitude import _rotation
from . import noise_arrays, projection, terms

EFFECT_NAMES = ("lever_arm", "filter_lag")
EACH = (0, 1, 2)
# What competes in motion, in the order of Move's columns: effect, variant, axis of each column.
# Without a name: what is read along each axis with the size of the rate, with each rate, with
# their products, with their changes, and a scale that the size of the rate changes.
COMPETING = (("lever_arm", "", EACH), ("filter_lag", "", (0,)), ("~motion", "speed", EACH),
             ("~motion", "rates", EACH * 3), ("~motion", "squares", EACH * 6),
             ("~motion", "changes", EACH * 3), ("~motion", "scale", EACH))
EFFECTS_NUMBER = 4  # columns of those with a name
COMPETING_NUMBER = sum(len(axes) for _, _, axes in COMPETING)
FAST_DPS, FAST_DPS2 = 100.0, 300.0  # a hand's rate, and its change
BIN_S, FEWEST_BINS, MOST_BINS = 0.1, 12, 60
FLAT_DEG = 15.0  # a move that leaves the vertical where it was, in the box
HATS = 4  # of the bias's course over a session
HABITS = 4  # cosines that hands have in common when they turn a box over
BENDS = 39  # columns of what bends with the attitude, or remembers the one before
PRIOR_METRES, PRIOR_CM, PRIOR_MG = 0.1, 10.0, 5.0
BIAS_MG, STRANGE_BIAS_MG = 10.0, 60.0  # a session calibrated by its own poses, or by others'
HAND_CM, WHEELS_CM = 0.3, 0.03  # how well the same hand, the same axle hold their centre
MG_PER_METRE_S2 = 1000.0 / 9.80665
SMALL_DEG = 10.0


class Move:
    """y (n, 3) mg, columns (n, 3, k) of all sessions and local (n, 3, l) of each, over the
    frequencies 0 ... n - 1 of the move, along (onwards, axis, up); flat; seconds; bin_s; felt
    (samples, 3) g, moment of the samples, seen: how these become those. Of the session: session
    (number), white (mg of a second), by_hand."""

    def __init__(self, turn, session, nominal, course):
        """turn: turns.Turn, integrated; course (4, samples): hats over the session."""
        capture = session.capture
        part = slice(turn.first, turn.last)
        rate = turn.rate @ turn.matrix.T - turn.shift
        body = pinned(turn)
        felt = np.einsum("nji,j->ni", body, turn.before)
        measured = nominal.corrected(capture.accel[part] * (
            1000.0 / capture.meta["accel_lsb_per_g"]))
        frame = self._frame(turn, body, rate)
        share = path(turn)
        self.felt = felt
        seen = self.seen = _Seen(body, frame, share, len(share))
        self.seconds, self.bin_s = turn.seconds, turn.seconds / seen.n
        self.y = seen.of(1000.0 * (measured - felt)[:, :, None])[:, :, 0]
        m = Moment(np.exp, np.sin, np.floor, noise_arrays.gauss)
        m.f, m.w = tuple(felt.T), tuple(rate.T)
        m.w_rate = tuple(np.gradient(rate, turn.t, axis=0).T)
        self.moment = m
        own = seen.of(np.concatenate([spread(name, m) for name in EFFECT_NAMES], axis=2))
        edge = own[:, :, :3] @ frame.T * (not self.flat)
        memory = np.zeros((len(felt), 3, 3))
        for i in range(3):
            memory[:, i, i] = felt[0, i] - felt[:, i]
        static = seen.held(np.concatenate([_orientation(felt), memory], axis=2))
        bias = np.zeros((len(felt), 3, 3 * HATS))
        for i in range(3):
            bias[:, i, i::3] = course[:, part].T
        self.local = np.concatenate([own[:, :, :3], seen.held(bias)], axis=2)
        strange = seen.of(_of_motion(felt, rate, np.stack(m.w_rate, 1)))
        self.columns = np.concatenate([own, strange, edge, self._habits(seen.n), static], axis=2)

    def _frame(self, turn, body, rate):
        """(3, 3): onwards, axis, up as rows in the frame of the start; fills flat."""
        up = turn.before
        leaned = np.einsum("nji,j->ni", body, up) @ up
        self.flat = bool(leaned.min() > np.cos(np.radians(FLAT_DEG)))
        turned = (np.einsum("nij,nj->ni", body[1:], 0.5 * (rate[1:] + rate[:-1]))
                  * turn.dt[:, None]).sum(axis=0)
        axis = turned - up * (turned @ up)
        size = np.linalg.norm(axis)
        axis = axis / size if size > SMALL_DEG else projection.lateral_basis(up)[0]
        return np.stack([np.cross(axis, up), axis, up])

    def _habits(self, n):
        """Up and down, and onwards, in the same way whenever a box is turned over: metres."""
        out = np.zeros((n, 3, 2 * HABITS))
        if not self.flat:
            size = MG_PER_METRE_S2 * (np.pi / self.seconds) ** 2 * np.sqrt(n / 2.0)
            for k in range(1, HABITS + 1):
                out[k, 2, k - 1] = out[k, 0, HABITS + k - 1] = size
        return out


def priors(chip):
    """(k,) standard deviations of Move.columns' coefficients; of the effects ten times the
    typical size, as everywhere."""
    effect = [10.0 * typical.size(name, chip, "accel")[0] for name in EFFECT_NAMES
              for _ in EFFECTS[name].keys]
    strange = [PRIOR_MG] * (COMPETING_NUMBER - EFFECTS_NUMBER)
    return np.concatenate([effect, strange, [PRIOR_CM] * 3, [PRIOR_METRES] * (2 * HABITS),
                           [PRIOR_MG] * BENDS])


def local_priors(by_hand):
    """(k,) standard deviations of Move.local's coefficients: where hand or wheels turn the box
    in this session, and the course of the bias."""
    centre, bias = (HAND_CM, BIAS_MG) if by_hand else (WHEELS_CM, STRANGE_BIAS_MG)
    return np.concatenate([[centre] * 3, [bias] * (3 * HATS)])


def spread(name, moment):
    """(n, 3, keys): the effect's terms over the samples of a move, mg."""
    effect = EFFECTS[name]("accel", {})
    out = np.zeros((len(moment.f[0]), 3, len(effect.keys)))
    for key, axis, value in effect.terms(moment):
        out[:, axis, effect.keys.index(key)] = value
    return out


def path(turn):
    """(n,) share of the way turned so far."""
    steps = np.linalg.norm(turn.middle, axis=1) * turn.dt
    return np.concatenate([[0.0], np.cumsum(steps)]) / max(steps.sum(), 1e-9)


def pinned(turn):
    """(n, 3, 3): attitude at each sample since the start, gravity right at both ends."""
    body = np.concatenate([turn.attitude, turn.end[None]])
    carried = turn.end @ turn.after
    off = np.cross(carried, turn.before)
    size = np.linalg.norm(off)
    if size < 1e-12:
        return body
    angle = np.arctan2(size, carried @ turn.before)
    return _rotation(np.outer(path(turn), off / size * angle)) @ body


class _Seen:
    """Accelerations in the body as the move's frequencies."""

    def __init__(self, body, frame, share, samples):
        self.n = int(np.clip(samples // 5, FEWEST_BINS, MOST_BINS))
        self.turned = frame @ body  # (samples, 3, 3)
        self.share = share
        self.edges = np.linspace(0, samples, self.n + 1).astype(int)
        self.counts = np.diff(self.edges)[:, None, None]
        k = np.arange(self.n)
        self.cosines = np.sqrt(2.0 / self.n) * np.cos(
            np.pi / self.n * (k[None, :] + 0.5) * k[:, None])
        self.cosines[0] /= np.sqrt(2.0)

    def held(self, values):
        """of() what is there at rest, too: across gravity that was taken for its attitude."""
        table = self.turned @ values
        share = self.share[:, None, None]
        table[:, :2] -= ((1.0 - share) * table[0] + share * table[-1])[:, :2]
        return self._frequencies(table)

    def of(self, values):
        """(n, 3, k) from (samples, 3, k) in the body."""
        return self._frequencies(self.turned @ values)

    def _frequencies(self, table):
        means = np.add.reduceat(table, self.edges[:-1], axis=0) / self.counts
        return np.tensordot(self.cosines, means, axes=1)


def _of_motion(felt, rate, change):
    """(n, 3, k): functions of the rate (n, 3) deg/s and its change that no name has, mg on each
    axis, in the order of COMPETING."""
    w, faster = rate / FAST_DPS, change / FAST_DPS2
    speed = np.linalg.norm(w, axis=1)
    pairs = [w[:, i] * w[:, j] for i in range(3) for j in range(i + 1)]
    functions = [speed, *w.T, *pairs, *faster.T]
    out = np.zeros((len(w), 3, 3 * len(functions) + 3))
    for number, values in enumerate(functions):
        for axis in range(3):
            out[:, axis, 3 * number + axis] = values
    for axis in range(3):
        out[:, axis, 3 * len(functions) + axis] = felt[:, axis] * speed
    return out


def _orientation(felt):
    """(n, 3, 36): harmonics of degree 2 and 3 on each axis, mg."""
    harmonics = terms.harmonics(felt, "accel")
    out = np.zeros((len(felt), 3, 3 * len(harmonics)))
    for number, values in enumerate(harmonics):
        for i in range(3):
            out[:, i, 3 * number + i] = values
    return out
