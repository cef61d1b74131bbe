"""The accelerometer in motion: what it reads on the way from one rest to the next, less gravity.

The gyro, as the rests and turns have calibrated it, says where gravity is on the way, and gravity
at the rests before and after corrects it at both ends. What is left of the readings is expressed
in the frame of the table, as frequencies over the move (a cosine transform). The hand's own
acceleration is large there and may have any course, but its mean is zero, since the box rests at
both ends; what is fixed to the box or to the sensor turns with it, and is told from it by that."""
from dataclasses import dataclass

import numpy as np

from sixflip import STANDARD_G
from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

from ..capture.attitude import levelled
from . import noise_arrays, projection, terms
from .turns import Turn

EFFECT_NAMES = ("lever_arm", "filter_lag")
EACH = (0, 1, 2)  # x y z
# What competes in motion, in the order of Move's columns: effect, variant, axis of each column.
# Without a name: what is read along each axis with the size of the rate, with each rate, with
# their products, with their changes, and a scale that the size of the rate changes.
COMPETING = (("lever_arm", "", EACH), ("filter_lag", "", (0,)), ("motion", "speed", EACH),
             ("motion", "rates", EACH * 3), ("motion", "squares", EACH * 6),
             ("motion", "changes", EACH * 3), ("motion", "scale", EACH))
EFFECTS_NUMBER, LAG = 4, 3  # columns with a name; that of the accelerometer behind the gyro
COMPETING_NUMBER = sum(len(axes) for _, _, axes in COMPETING)
# deg/s and deg/s2 of a hand that turns a box over in one to two seconds: the nameless functions
# are in units of them, so that PRIOR_MG is what one of them adds in a quick move.
FAST_DPS, FAST_DPS2 = 100.0, 300.0
FEWEST_BINS, MOST_BINS = 12, 60  # five samples each in between: a hand moves below 10 Hz
# A move that leaves the vertical within so many degrees of where it was in the box is a turn on
# the table: there a hand does not lift the box, and the board takes what leans as little for a
# face.
FLAT_DEG = 15.0
HATS = 4  # of the bias's course over a session: a straight line, or one that bends twice
# Cosines that hands have in common when they turn a box: most of a way is in four of them
# (moves_unit.py), but what is alike in all moves is as strong evidence in the faster ones.
HABITS = 10
# A hand turns a box smoothly: at 13 % of the time it is 2 % of the way [Flash and Hogan, J.
# Neuroscience 5 (1985) 1688, equation 9: the way of least jerk].
TURNED, BY_THEN = 0.02, 0.13
BENDS = 54  # columns of what bends with the attitude, or remembers the one before
# Of an axis by itself, which a move takes through all that it may feel: degrees beyond the
# harmonics', and how wide the knee between up and down may be, in g.
OWN_DEGREES, KNEE_G = (4, 5, 6), 0.1
# Standard deviations: of a hand's way, of a centre of turning in a box as large as a hand, and of
# what has no name (strangers.SCALE: as large as the library's effects are).
PRIOR_METRES, PRIOR_CM, PRIOR_MG = 0.1, 10.0, 5.0
# mg of the bias in a session that is calibrated by its own poses, which leaves a warm-up of it
# (typical.py: 4 mg), or by another session's: the zero level of a part moves by tens.
BIAS_MG, STRANGE_BIAS_MG = 10.0, 60.0
# cm, how well the same hand, the same axle hold their centre of turning from move to move. Less
# would claim a lever arm where a hand only turns about another point, more would hide a small one.
HAND_CM, WHEELS_CM = 0.3, 0.03
MG_PER_METRE_S2 = 1000.0 / STANDARD_G  # mg
SMALL_DEG = 10.0  # of turning: in less the axis is as much the hand's wobble as the turn's


@dataclass(frozen=True, eq=False)
class Move:
    """One move of a session: turn (turns.Turn, integrated), session (its number), by_hand, white
    (mg of a second); flat: the vertical stays where it was in the box; seconds, bin_s; over the
    frequencies 0 ... n - 1, along (onwards, axis, up): y (n, 3) mg and table (n, 3, k + l), the
    first `shared` of whose columns all sessions have, the others each session for itself."""

    turn: Turn
    session: int
    by_hand: bool
    white: float
    flat: bool
    seconds: float
    bin_s: float
    y: np.ndarray
    table: np.ndarray
    shared: int

    @property
    def columns(self):
        return self.table[:, :, :self.shared]


def move(turn, capture, nominal, course, session, by_hand, white, lag_ms=0.0):
    """Move of a turn; nominal: NominalSensor; course (4, samples): hats over the session; lag_ms:
    about how late the accelerometer is behind the gyro, see lagging()."""
    body, felt, rate = carried(turn)
    frame, flat = _frame(turn, body, rate)
    seen = Seen.of_turn(turn, body, rate)
    scale = 1000.0 / capture.meta["accel_lsb_per_g"]
    measured = nominal.corrected(capture.accel[turn.first:turn.last] * scale)
    y = seen.spectrum(1000.0 * (measured - felt)[:, :, None])[:, :, 0]
    m = moment(turn, felt, rate)
    effects = np.hstack([terms.columns_of(EFFECTS[name]("accel", {}), m, len(felt))[2]
                         for name in EFFECT_NAMES]).reshape(len(felt), 3, EFFECTS_NUMBER)
    if lag_ms:
        effects[:, :, LAG] = lagging(turn.t, felt, lag_ms)
    own = seen.spectrum(effects)
    edge = own[:, :, :3] @ frame.T * (not flat)
    # What bends with the attitude, and remembers the one before.
    static = seen.held([
        *terms.harmonics(felt, "accel"), np.abs(felt), np.hypot(felt, KNEE_G),
        *(felt ** degree for degree in OWN_DEGREES), felt[0] - felt])
    bias = seen.held(course[:, turn.first:turn.last])
    strange = seen.frequencies(seen.by_axis(_of_motion(felt, rate, np.stack(m.w_rate, 1))))
    shared = [own, strange, edge, seen.frequencies(_habits(turn, seen.share, flat)), static]
    return Move(turn, session, by_hand, white, flat, turn.seconds, turn.seconds / seen.n, y,
                np.concatenate([*shared, own[:, :, :3], bias], axis=2),
                sum(part.shape[2] for part in shared))


def carried(turn):
    """(body (n, 3, 3): attitude at each sample, felt (n, 3) g: what gravity is there, rate (n, 3)
    deg/s as the turn was corrected)."""
    body = pinned(turn)
    return (body, np.einsum("nji,j->ni", body, turn.before),
            turn.rate @ turn.matrix.T - turn.shift)


def moment(turn, felt, rate):
    """moment.Moment of a turn's samples; felt, rate as carried() has them."""
    m = noise_arrays.moment()
    m.f, m.w = tuple(felt.T), tuple(rate.T)
    m.w_rate = tuple(np.gradient(rate, turn.t, axis=0).T)
    return m


def _frame(turn, body, rate):
    """((3, 3): onwards, axis, up as rows in the frame of the start; whether it is flat)."""
    up = turn.before
    leaned = np.einsum("nji,j->ni", body, up) @ up
    turned = (np.einsum("nij,nj->ni", body[1:], 0.5 * (rate[1:] + rate[:-1]))
              * turn.dt[:, None]).sum(axis=0)
    axis = turned - up * (turned @ up)
    size = np.linalg.norm(axis)
    axis = axis / size if size > SMALL_DEG else projection.lateral_basis(up)[0]
    return np.stack([np.cross(axis, up), axis, up]), bool(
        leaned.min() > np.cos(np.radians(FLAT_DEG)))


def _habits(turn, share, flat):
    """(samples, 3, 3 HABITS) up and down, and onwards, in the same way whenever a box is turned
    over; up and down whenever it is turned on the table: metres. A hand waits before it turns the
    box and after, now longer, now shorter: the way lasts as long as the turn does."""
    since, until = np.interp([TURNED, 1.0 - TURNED], share, turn.t)
    seconds = (until - since) / (1.0 - 2.0 * BY_THEN)
    u = (turn.t - since) / seconds + BY_THEN
    k = np.arange(1, HABITS + 1)
    course = (MG_PER_METRE_S2 * (np.pi / seconds) ** 2 * np.cos(np.pi * k * u[:, None])
              * ((u >= 0.0) & (u <= 1.0))[:, None])
    columns = np.zeros((len(u), 3, 3 * HABITS))
    if flat:
        columns[:, 2, 2 * HABITS:] = course
    else:
        columns[:, 2, :HABITS] = columns[:, 0, HABITS:2 * HABITS] = course
    return columns


def priors(chip):
    """(k,) standard deviations of the coefficients of all sessions' columns; of the effects ten
    times the typical size, as everywhere."""
    effect = [10.0 * typical.size(name, chip, "accel")[0] for name in EFFECT_NAMES
              for _ in EFFECTS[name].keys]
    return np.concatenate([effect, [PRIOR_MG] * (COMPETING_NUMBER - EFFECTS_NUMBER),
                           [PRIOR_CM] * 3, [PRIOR_METRES] * (3 * HABITS), [PRIOR_MG] * BENDS])


def local_priors(by_hand):
    """(k,) standard deviations of the coefficients of a session's own columns: where hand or
    wheels turn the box in it, and the course of the bias."""
    centre, bias = (HAND_CM, BIAS_MG) if by_hand else (WHEELS_CM, STRANGE_BIAS_MG)
    return np.concatenate([[centre] * 3, [bias] * (3 * HATS)])


def lagging(t, felt, lag_ms):
    """(n, 3) mg a millisecond: what gravity felt (n, 3) g at times t (n,) s is more where it is
    read late by lag_ms: of a delay as long as a hand's tremor the derivative is no measure."""
    late = np.stack([np.interp(t - 0.001 * lag_ms, t, axis) for axis in felt.T], 1)
    return (late - felt) * (1000.0 / lag_ms)


def path(turn):
    """(n,) share of the way turned so far."""
    steps = np.linalg.norm(turn.middle, axis=1) * turn.dt
    return np.concatenate([[0.0], np.cumsum(steps)]) / max(steps.sum(), 1e-9)


def pinned(turn):
    """(n, 3, 3): attitude at each sample since the start, gravity right at both ends."""
    body = np.concatenate([turn.attitude, turn.end[None]])
    return levelled(body, turn.after, turn.before, path(turn))


@dataclass(frozen=True, eq=False)
class Seen:
    """Accelerations in the body as a move's n frequencies: turned (samples, 3, 3) into onwards,
    axis, up; share (samples,) of the way; edges (n + 1,) of the bins; cosines (n, n)."""

    n: int
    turned: np.ndarray
    share: np.ndarray
    edges: np.ndarray
    cosines: np.ndarray

    @classmethod
    def of_turn(cls, turn, body, rate):
        share = path(turn)
        n = int(np.clip(len(share) // 5, FEWEST_BINS, MOST_BINS))
        k = np.arange(n)
        cosines = np.sqrt(2.0 / n) * np.cos(np.pi / n * (k[None, :] + 0.5) * k[:, None])
        cosines[0] /= np.sqrt(2.0)
        return cls(n, _frame(turn, body, rate)[0] @ body, share,
                   np.linspace(0, len(share), n + 1).astype(int), cosines)

    def by_axis(self, functions):
        """(samples, 3, 3k) onwards, along the axis and up: functions as projection.by_axis() has
        them, each column of which is on one axis of the body only."""
        each = np.stack([np.broadcast_to(f.reshape(len(f), -1), (len(f), 3))
                         for f in functions], 1)
        return (self.turned[:, :, None] * each[:, None]).reshape(len(each), 3, -1)

    def held(self, functions):
        """(n, 3, 3k) of by_axis() of what is there at rest, too: across gravity that was taken for
        the attitude."""
        table = self.by_axis(functions)
        means, share = self._means(table), self._means(self.share)[:, None, None]
        means[:, :2] -= (1.0 - share) * table[0, :2] + share * table[-1, :2]
        return np.tensordot(self.cosines, means, axes=1)

    def spectrum(self, values):
        """(n, 3, k) from (samples, 3, k) in the body."""
        return self.frequencies(self.turned @ values)

    def frequencies(self, table):
        """(n, 3, k) from (samples, 3, k) onwards, along the axis and up."""
        return np.tensordot(self.cosines, self._means(table), axes=1)

    def _means(self, values):
        """(n, ...) means of values (samples, ...) in the bins."""
        return (np.add.reduceat(values, self.edges[:-1], axis=0).T / np.diff(self.edges)).T


def _of_motion(felt, rate, change):
    """Functions of the rate (n, 3) deg/s and its change that no name has, mg on each axis, in the
    order of COMPETING."""
    w, faster = rate / FAST_DPS, change / FAST_DPS2
    speed = np.linalg.norm(w, axis=1)
    pairs = [w[:, i] * w[:, j] for i in range(3) for j in range(i + 1)]
    return [speed, *w.T, *pairs, *faster.T, felt * speed[:, None]]
