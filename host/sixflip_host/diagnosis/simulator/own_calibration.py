"""A log's own sensor by its own rests and moves: |force| is gravity at every rest, and the turn
between two rests takes gravity before to gravity after [Tedaldi et al., ICRA 2014].

Maximum a posteriori with priors of datasheet size, so that a log with two rests is answered as
honestly as one with twenty: what it cannot see keeps its prior's interval. So does a sensor that
the priors find impossible: windows of a flying drone that look still are no rests.
"""
from dataclasses import dataclass, field, replace

import numpy as np

from ...capture.attitude import carried, rotations
from ..detect.wrong_scale import RANGES, SOUND_ACCEL
from . import gravity_directions, log_rests, own_rests, single_log, traces
from .hypotheses import BIAS, SHAPE

ROUNDS = 8  # Gauss-Newton steps of the moves' fit: after five the next change a matrix by 1e-9
# Of gravity carried over a move: 0.2 % of nonlinearity on half a turn [MPU-6000 PS, table 6.1].
CARRY_RAD = np.radians(0.3)
# Of Student's t [Lange et al., J. Am. Stat. Assoc. 84 (1989), 881], and of what is known of
# CARRY_RAD before a look at the moves.
FREEDOM = 4.0
# Of what two logs read at rest, in g: standard errors between their means, and by how much a floor
# leans, a degree.
APART, LEANS = 4.0, 0.0175
UNKNOWN = 0.9  # of its prior width: what a bias has that no rest tells


@dataclass(frozen=True)
class OwnSensor:
    """true force = accel (force - bias), accel (3, 3) symmetric (its turn cannot be seen) but for
    what turned_in_box knows of it, turned (3,) rad; true
    rate = gyro (rate - bias at rest); sigmas of accel (3, 3), bias (3,), gyro (3, 3); gyro_bias
    (3,) rad/s with its sigma (infinite without a rest); flicker: that of its Trace; full_scale
    {sensor: how many times too large it reads by a full scale that its log does not state}."""

    accel: np.ndarray
    bias: np.ndarray
    gyro: np.ndarray
    accel_sigma: np.ndarray
    bias_sigma: np.ndarray
    gyro_sigma: np.ndarray
    gyro_bias: np.ndarray
    gyro_bias_sigma: np.ndarray
    flicker: dict
    full_scale: dict = field(default_factory=lambda: {"accel": 1.0, "gyro": 1.0})
    turned: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def turns(self):
        """How many times as far as gravity its gyro turns."""
        return 1.0 / float(np.diag(self.gyro).mean())

    def applied(self, trace):
        """The Trace as this sensor's true force and rate."""
        line = traces.rest_line(trace, trace.rate) if trace.rests else self.gyro_bias
        return replace(trace, force=(trace.force - self.bias) @ self.accel.T,
                       rate=(trace.rate - line) @ self.gyro.T)


def fitted(trace):
    """OwnSensor of a Trace with a gyro, else None; of one that never rests nothing is known but
    about where its gyro's bias is."""
    if trace.rate is None:
        return None
    if not trace.rests:
        levelled = log_rests.levelled(trace.t, trace.force, trace.rate, trace.rate_hz, trace.g)
        bias = trace.rate.mean(axis=0) if levelled is None else levelled[1]
        unknown = np.full((3, 3), SHAPE)
        return OwnSensor(np.eye(3), np.zeros(3), np.eye(3), unknown, np.full(3, BIAS["accel"]),
                         unknown, bias, np.full(3, np.inf), trace.flicker)
    means = trace.rest_means(trace.force)
    norms = np.linalg.norm(means, axis=1)
    at_rest, full_scale = own_rests.unknown(means), {"accel": 1.0, "gyro": 1.0}
    for times, near in ((1.0, 0.3), *((k, SOUND_ACCEL) for k in RANGES)):
        if np.all(np.abs(norms / times / trace.g - 1.0) < near):
            at_rest, full_scale["accel"] = own_rests.by_norm(means / times, trace.g), times
    gyro, gyro_sigma = np.eye(3), np.full((3, 3), SHAPE)
    if np.all(norms > 0.3 * trace.g):
        rate = trace.rate - traces.rest_line(trace, trace.rate)
        ups = np.array([own_rests.up_of(mean, at_rest.p)[0] for mean in at_rest.means])
        times = full_scale["gyro"] = gravity_directions.full_scale(trace, ups)
        at_rest, gyro, gyro_sigma = by_carry(trace, rate / times, at_rest)
        gyro, gyro_sigma = gyro / times, gyro_sigma / times
    (accel, bias), (accel_sigma, bias_sigma) = own_rests.matrix_of(at_rest.p), at_rest.sigma
    times = full_scale["accel"]
    accel, accel_sigma, bias, bias_sigma = (
        accel / times, accel_sigma / times, bias * times, bias_sigma * times)
    biases = trace.rest_means(trace.rate)
    spread = biases.std(axis=0, ddof=1) / np.sqrt(len(biases)) if len(biases) > 2 else \
        np.hypot(0.001, trace.noise_of_rests("gyro"))
    return OwnSensor(accel, bias, gyro, accel_sigma, bias_sigma, gyro_sigma, biases.mean(axis=0),
                     np.maximum(spread, trace.quantum[1] / np.sqrt(12.0)), trace.flicker,
                     full_scale)


def lies_otherwise(real, sim, own_real, own_sim):
    """(3,) mg by which two Traces of different motions, with their OwnSensors, read otherwise at
    rest where that is more than their rests scatter by and a floor leans: how it lies, or a bias,
    which what lies in one attitude all the while does not tell apart. None where they read alike,
    or where they lie in several attitudes and their biases are known: what drives up and down
    shows its bias, and not whether it was mounted so."""
    means = [trace.rest_means(trace.force) / trace.g for trace in (real, sim)]
    ups = [m / np.maximum(np.linalg.norm(m, axis=1), 1e-9)[:, None] for m in means]
    several = any((np.abs(u - np.median(u, axis=0)) > LEANS).any() for u in ups)
    if several and np.minimum(own_real.bias_sigma, own_sim.bias_sigma).max() \
            < UNKNOWN * BIAS["accel"]:
        return None
    off = np.median(means[0], axis=0) - np.median(means[1], axis=0)
    scatter = np.sqrt(sum(m.var(axis=0) / len(m) for m in means))
    return 1000.0 * off if (np.abs(off) > APART * scatter + LEANS).any() else None


def by_carry(trace, rate, at_rest):
    """(AtRest, gyro matrix (3, 3), its sigma (3, 3)) by gravity before and after each move.

    What AtRest leaves open of the accelerometer, of six faces all of its misalignment, and of
    rests that lie alike its bias, turns gravity at every rest and would pass for the gyro's: it is
    fitted with the gyro's matrix, and so known better. Over bumps the samples lie too far apart:
    how much that matters is what every second of them makes of the same move. Moves are weighed by
    Student's t besides; one in which the gyro was cut off turned farther than it says.
    """
    cut = single_log.gyro_cut_off(trace)
    accel, gyro, wider = at_rest.p, np.zeros(9), 1.0
    prior = np.zeros((18, 18))
    prior[:9, :9] = np.linalg.inv(at_rest.covariance)
    prior[9:, 9:] = np.eye(9) * SHAPE ** -2.0
    coarse = [CARRY_RAD + astray(trace, rate, own_rests.up_of(at_rest.means[k], accel)[0], k)
              for k in range(len(trace.rests) - 1)]
    for _ in range(ROUNDS):
        matrix = np.eye(3) + gyro.reshape(3, 3)
        ups, slopes = zip(*[own_rests.up_of(mean, accel) for mean in at_rest.means])
        gram, off = prior.copy(), []
        right = -prior @ np.concatenate([accel - at_rest.p, gyro])
        for k in range(len(trace.rests) - 1):
            first, last = trace.rests[k][1] - 1, trace.rests[k + 1][0]
            if cut[first:last].any():
                continue
            true = rate[first:last + 1] @ matrix.T
            dt = np.diff(trace.t[first:last + 1])[:, None]
            middle = 0.5 * (true[1:] + true[:-1])
            turns = carried(rotations(middle * dt))
            raw = 0.5 * (rate[first + 1:last + 1] + rate[first:last]) * dt
            # d(turn) = sum over samples of R(t) dM w dt, in the frame of the start
            spread = np.einsum("nij,nk->ijk", turns[:-1], raw).reshape(3, 9)
            x, y, z = ups[k]
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            jacobian = np.hstack([slopes[k] - turns[-1] @ slopes[k + 1], cross @ spread])
            left = turns[-1] @ ups[k + 1] - ups[k]
            if np.linalg.norm(left) > 0.5:
                continue  # a convention, not a parameter
            square = (left ** 2).sum() / coarse[k] ** 2
            heard = (FREEDOM + 2.0) / (FREEDOM + square / wider ** 2)
            off.append(heard * square)
            weight = heard / (wider * coarse[k]) ** 2
            gram += weight * jacobian.T @ jacobian
            right += weight * jacobian.T @ left
        covariance = np.linalg.inv(gram)
        step = covariance @ right
        accel, gyro = accel + step[:9], gyro + step[9:]
        # How well gravity is carried is told by what the numbers leave, less what they take up
        # [inverse gamma prior: Gelman et al., Bayesian Data Analysis (2013), section 2.6].
        taken = len(gram) - np.trace(covariance @ prior)
        wider = np.sqrt((FREEDOM + sum(off)) / (FREEDOM + max(2.0 * len(off) - taken, 0.0)))
    if (np.abs(gyro) > own_rests.IMPOSSIBLE * SHAPE).any():
        return at_rest, np.eye(3), np.full((3, 3), SHAPE)
    return own_rests.AtRest(at_rest.means, accel, covariance[:9, :9]), np.eye(
        3) + gyro.reshape(3, 3), np.sqrt(np.diag(covariance)[9:]).reshape(3, 3)


def astray(trace, rate, up, k):
    """Angle (rad) between where the whole gyro and every second of its samples carry a
    direction in the k-th move."""
    first, last = trace.rests[k][1] - 1, trace.rests[k + 1][0]
    ends = []
    for every in (1, 2):
        t, w = trace.t[first:last + 1:every], rate[first:last + 1:every]
        steps = 0.5 * (w[1:] + w[:-1]) * np.diff(t)[:, None]
        ends.append(carried(rotations(steps))[-1].T @ up)
    return float(np.linalg.norm(ends[0] - ends[1]))
