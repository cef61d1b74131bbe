"""Turns that end far from where gravity says: all of them, where a gyro's axes are swapped; or
some while the others do not, as where samples were lost.

What is left across gravity of each turn, degrees, is either of one kind, normal or with the
heavier tails of a hand (Student's t), or of that kind and of a far larger one for a share of them.
Each is judged by its likelihood with scale, misalignment and bias integrated out [Laplace's
method; Kass & Raftery, J. Am. Stat. Assoc. 90 (1995) 773]: in a session with few turns these bend
to most of them, and the turn that they do not bend to is not far off for that.
"""
from dataclasses import dataclass

import numpy as np
from scipy import special

from sixflip import STANDARD_G

from ..experiment import turns
from .detect import axis_order, wrong_scale
from .detect.detection import Finding, present
from .moves_fit import FREEDOM
from .simulator import alignment
from .simulator.hypotheses import lever_columns
from .simulator.traces import Motion

LEVELS_DEG = tuple(0.03 * 1.35 ** k for k in range(23))  # of turns that are alike
FAR_DEG, FAR_TIMES = (5.0, 15.0, 45.0), 5.0  # a tenth of a second that is lost, and more
SHARES = (0.01, 0.03, 0.1, 0.3)  # tried, of turns that are far off
TAILS = (FREEDOM, 1e6)  # degrees of freedom of turns that are alike; so many are normal
ROUNDS = 8  # of weighting turns by how far they are off
WRONG_DEG = 25.0  # of a turn's end: as of a label that gravity contradicts (session.FAR_OFF_DEG)
# Of what moves all the while: band and grid of its course, and the share of what the force does
# that a wrong order leaves unexplained and that the right one explains: 0.11 to 0.46 and 0.84 to
# 1.00 of logs of hands, gimbals and turntables. Who walks sways as he leans, so that a wrong order
# explains 0.50 to 0.75 of three gaits and a stair, where the right one explains 0.1 to 0.4.
SLOW_HZ, COURSE_HZ, WRONG, RIGHT = 1.0, 20.0, 0.5, 0.8
OFF_DEG = 6.0  # of a turn's end by a gyro not yet calibrated: a few percent of a half turn


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


@dataclass(frozen=True, eq=False)
class Kinds:
    """Densities of turns, D at once: level (D,) degrees, tail (D,) degrees of freedom of turns
    that are alike; share (D,) of them that are far_deg (D,) off instead, 0: none."""

    level: np.ndarray
    tail: np.ndarray
    far_deg: np.ndarray
    share: np.ndarray

    def of(self, left, known):
        """(log density (D, n), precision (D, n, 2) with which each turn counts, chance (D, n) that
        it is far off) of what is left (D, n, 2), degrees; known (n, 2) deg^2."""
        near, precision = _student(left, known, self.level, self.tail)
        if not self.share.any():
            return near, precision, np.zeros_like(near)
        normal = np.full_like(self.tail, TAILS[-1])
        off, off_precision = _student(left, known, self.far_deg, normal)
        share = self.share[:, None]
        near, off = near + np.log1p(-share), off + np.log(share)
        chance = special.expit(off - near)
        return (np.logaddexp(near, off),
                precision + chance[..., None] * (off_precision - precision), chance)


def nats(sessions):
    """(nats, number of turns) by which some turns of sessions (list of Ends) being far off is
    likelier than all being alike."""
    alike = [(level, tail, 1.0, 0.0) for level in LEVELS_DEG + FAR_DEG for tail in TAILS]
    apart = [(level, tail, far, share) for level in LEVELS_DEG for far in FAR_DEG
             if far >= FAR_TIMES * level for tail in TAILS for share in SHARES]
    usual, _ = _likelihoods(sessions, Kinds(*np.array(alike).T))
    nats, number = _likelihoods(sessions, Kinds(*np.array(apart).T))
    best = int(nats.argmax())
    return (float(nats[best] - usual.max() - np.log(len(SHARES) * len(FAR_DEG))),
            float(number[best]))


def _student(left, known, level, tail):
    """(log density (D, n), precision (D, n, 2)) of Student's t in two dimensions."""
    variance = known + level[:, None, None] ** 2
    square, tail = (left ** 2 / variance).sum(axis=2), tail[:, None]
    value = -0.5 * (tail + 2.0) * np.log1p(square / tail) - 0.5 * np.log(variance).sum(axis=2)
    return value, ((tail + 2.0) / (tail + square))[..., None] / variance


def _likelihoods(sessions, kinds):
    """(log likelihood (D,), expected number (D,) of turns far off) of Kinds, with what is unknown
    of each session integrated out."""
    total, number = np.zeros(len(kinds.level)), np.zeros(len(kinds.level))
    for session in sessions:
        columns = session.columns.reshape(session.off.size, -1)
        precision = np.broadcast_to(1.0 / session.known, (len(total), *session.known.shape))
        for _ in range(ROUNDS):
            weighted = _weighted(columns, precision)
            inner = (weighted @ session.off.ravel())[..., None]
            theta = np.linalg.solve(weighted @ columns, inner)
            left = session.off - (columns @ theta).reshape(precision.shape)
            value, precision, chance = kinds.of(left, session.known)
        total += value.sum(axis=1) - 0.5 * np.linalg.slogdet(
            _weighted(columns, precision) @ columns)[1]
        number += chance.sum(axis=1)
    return total, number


def _weighted(columns, precision):
    """(D, p, 2 n) of columns (2 n, p) and precision (D, n, 2)."""
    return columns.T * precision.reshape(len(precision), 1, -1)


def swapped(sessions, nominal):
    """Finding of gyro axes that are swapped or inverted, or None; its read (3, 3) takes what is
    true to what is read."""
    # A turn about the vertical looks the same to gravity whichever way the axes point.
    leaning = (turn for s, m in zip(sessions, nominal) for turn in turns.integrated(
        [move for move in turns.usable_moves(s, m.up) if move.before @ move.after < 0.8], s, m.up))
    chosen = [turn for _, turn in zip(range(10), leaning)]
    plain = np.array([t.off() for t in chosen])
    if len(chosen) < 3 or plain.mean() < WRONG_DEG:  # the plain order does: no other is tried
        return None
    # Nor is the plain order in a range that is not the header's another order.
    plain = min([plain, *(np.array([t.integrated(np.eye(3) / times).off() for t in chosen])
                          for times in wrong_scale.RANGES)], key=np.sum)
    if plain.mean() < WRONG_DEG:
        return None
    off, matrix = min(((np.array([t.integrated(order).off() for t in chosen]), order)
                       for order in axis_order.SIGNED), key=lambda pair: pair[0].mean())
    score = order_nats(off, plain)
    if not present(score):
        return None
    # What register i carries: true = matrix · read.
    return _of_order(matrix.T, sessions, score, axis_order.explained(plain, off), len(plain))


def swapped_on_the_way(sessions):
    """[Finding] of gyro axes that are swapped or inverted by what turns all the while, of sessions
    that hardly rest: what turns by w carries gravity g along by dg/dt = -w x g, whichever of its
    axes are called what; the force has what an arm to the point it is turned about adds besides,
    and what a hand or a robot does is noise. Where the plain order explains most of what the force
    does no other is tried."""
    logs = [_course(session.capture) for session in sessions]
    if None in logs or not logs:
        return []
    still, sound = (sum(_left(*log, order)[1] for log in logs) for order in (
        np.zeros((3, 3)), np.eye(3)))
    if not still > 0.0 or sound < (1.0 - WRONG) * still:
        return []
    each = [[_left(*log, order) for log in logs] for order in axis_order.SIGNED]
    power = np.array([sum(squares for _, squares in own) for own in each])
    best = int(power.argmin())
    if power[best] > min(0.5 * sound, (1.0 - RIGHT) * still):
        return []
    number = sum(left.size / alignment.independent(left) for left, _ in each[best])
    nats = -0.5 * number * np.log(power / still)
    # Of orders that nothing tells apart, as of what turns about one axis, the one with the fewest.
    order = min((order for own, order in zip(nats, axis_order.SIGNED) if not present(
        nats[best] - own)), key=lambda order: len(axis_order.sources(order.T)))
    score = float(nats[best] - max(0.0, -0.5 * number * np.log(sound / still)) - np.log(
        len(axis_order.SIGNED)))
    if not present(score):
        return []
    return [_of_order(order.T, sessions, score, 1.0 - power[best] / sound, number)]


def _of_order(read, sessions, score, share, number):
    """The Finding of a gyro that reads `read` (3, 3) of what the accelerometer tells."""
    sensor, order = axis_order.whose(read, any(s.labelled for s in sessions))
    value = axis_order.sources(order)
    return Finding("axis_swap", sensor, sorted(value), value, "axis", score, "orientation",
                   "axes are swapped or inverted against the %s's" % (
                       "gyro" if sensor == "accel" else "accelerometer"),
                   {k: (v, v) for k, v in value.items()}, share=float(share), number=number,
                   read=read)


def _course(capture):
    """((n, 3) g/s, (n, 3) g, (n, 3) rad/s): how the force of a Capture changes, the force and the
    turn rate of what is slow enough that a gyro of 40 ms delay still goes with it; or None."""
    if capture.gyro is None or capture.accel is None or len(capture) < 2:
        return None
    t = (capture.t_us - capture.t_us[0]) * 1e-6
    if t[-1] < alignment.LEAST_S:
        return None
    rate_hz, at = (len(t) - 1) / t[-1], np.arange(0.0, t[-1], 1.0 / COURSE_HZ)
    turned = np.radians(capture.gyro / capture.meta["gyro_lsb_per_dps"])
    force, rate = (np.stack([np.interp(at, t, x) for x in alignment.smooth(
        values, rate_hz, SLOW_HZ).T], 1) for values in (
            capture.accel / capture.meta["accel_lsb_per_g"], turned - np.median(turned, axis=0)))
    return np.gradient(force, axis=0) * COURSE_HZ, force, rate


def _left(change, force, rate, order):
    """((n, 3), sum of its squares) of a _course() that turns by order · rate, beside its gyro's
    bias and an arm, m."""
    turns = rate @ order.T
    arms = lever_columns(Motion(None, None, turns, np.gradient(turns, axis=0) * COURSE_HZ, None,
                                None)) / STANDARD_G
    columns = [np.cross(axis, force) for axis in np.eye(3)]
    if order.any():
        columns += [np.gradient(arms[:, :, k], axis=0) * COURSE_HZ + np.cross(turns, arms[:, :, k])
                    for k in range(3)]
    design = np.stack(columns, 2).reshape(change.size, -1)
    left = (change + np.cross(turns, force)).ravel()
    left = left - design @ np.linalg.lstsq(design, left, rcond=None)[0]
    return left.reshape(change.shape), float((left ** 2).sum())


def order_nats(off, plain):
    """Log likelihood ratio (nats) of turns whose ends are off (n,) degrees in an order of the
    axes, as a direction normal about the right one, against the plain order's (n,), and against
    ends that lie anywhere on the sphere."""
    def likelihood(degrees):
        return float((-0.5 * (degrees / OFF_DEG) ** 2
                      - np.log(2.0 * np.pi * np.radians(OFF_DEG) ** 2)).sum())
    anywhere = -len(off) * np.log(4.0 * np.pi)
    return likelihood(off) - max(likelihood(plain), anywhere) - np.log(len(axis_order.SIGNED))
