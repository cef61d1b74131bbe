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
from . import gravity_directions, log_rests, traces
from .hypotheses import BIAS, SHAPE

ROUNDS = 8  # Gauss-Newton steps of the moves' fit: after five the next change a matrix by 1e-9
STEPS, SMALL = 60, 1e-6  # of the rests' fit at most; standard errors that ends it
CARRY_RAD = np.radians(0.3)  # of a placement's tilt by handling, and of the attitude carried
FREEDOM = 4.0  # of Student's t [Lange et al., J. Am. Stat. Assoc. 84 (1989), 881]
MEDIAN_OF_TWO = np.log(2.0)  # of half the sum of two squares of unit variance
# Of what two logs read at rest, in g: standard errors between their means, and by how much a floor
# leans, a degree.
APART, LEANS = 4.0, 0.0175
UNKNOWN = 0.9  # of its prior width: what a bias has that no rest tells
NORM = 0.005  # m/s2: how well |force| repeats between rests, 0.5 mg with flicker and rounding
# Times NORM, that |force| may repeat worse, doubled each time: to 0.5 g, where the windows are no
# rests but pieces of a flight.
WORSE = 2.0 ** np.arange(11)
# Prior standard deviations beyond which a sensor is none: by 46 degrees another axis is nearer,
# and 80 % of scale or 1.6 g of offset are a convention, or a fit to what are no rests.
IMPOSSIBLE = 20.0


@dataclass(frozen=True)
class OwnSensor:
    """true force = accel (force - bias), accel (3, 3) symmetric (its turn cannot be seen); true
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
    accel, bias = np.eye(3), np.zeros(3)
    accel_sigma, bias_sigma = np.full((3, 3), SHAPE), np.full(3, BIAS["accel"])
    full_scale = {"accel": 1.0, "gyro": 1.0}
    for times, near in ((1.0, 0.3), *((k, SOUND_ACCEL) for k in RANGES)):
        if np.all(np.abs(norms / times / trace.g - 1.0) < near):
            accel, bias, accel_sigma, bias_sigma = by_norm(means / times, trace.g)
            accel, accel_sigma = accel / times, accel_sigma / times
            bias, bias_sigma, full_scale["accel"] = bias * times, bias_sigma * times, times
    rate = trace.rate - traces.rest_line(trace, trace.rate)
    ups = (means - bias) @ accel.T
    ups /= np.maximum(np.linalg.norm(ups, axis=1), 1e-9)[:, None]
    gyro, gyro_sigma = np.eye(3), np.full((3, 3), SHAPE)
    if np.all(norms > 0.3 * trace.g):
        times = full_scale["gyro"] = gravity_directions.full_scale(trace, ups)
        gyro, gyro_sigma = (x / times for x in by_carry(
            trace, rate / times, ups, bias_sigma / full_scale["accel"] / trace.g))
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
    or where their biases are known."""
    if np.minimum(own_real.bias_sigma, own_sim.bias_sigma).max() < UNKNOWN * BIAS["accel"]:
        return None
    means = [trace.rest_means(trace.force) / trace.g for trace in (real, sim)]
    off = np.median(means[0], axis=0) - np.median(means[1], axis=0)
    scatter = np.sqrt(sum(m.var(axis=0) / len(m) for m in means))
    return 1000.0 * off if (np.abs(off) > APART * scatter + LEANS).any() else None


SYMMETRIC = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def by_norm(means, g):
    """(matrix, bias, their sigmas) that make |matrix (mean - bias)| = g.

    How well |force| repeats is not known either: it has a half-Cauchy prior about NORM [Gelman,
    Bayesian Analysis 1 (2006), 515], and the answer is the mean over it by how likely each makes
    the rests [Laplace's approximation: Bishop (2006), section 4.4]. Rests are weighed by Student's
    t besides.
    """
    prior = np.concatenate([np.full(6, SHAPE), np.full(3, BIAS["accel"])])
    p, logs, places, inverses = np.zeros(9), [], [], []
    for worse in WORSE[::-1]:
        p, gram, log = likeliest(p, means, g, NORM * worse, prior)
        logs.append(log - 0.5 * np.linalg.slogdet(gram)[1] - np.log(worse + 1.0 / worse))
        places.append(p)
        inverses.append(np.linalg.inv(gram))
    weights = np.exp(np.array(logs) - max(logs))
    weights /= weights.sum()
    p = weights @ places
    apart = np.array(places) - p
    covariance = np.einsum("k,kij->ij", weights, inverses) + (weights * apart.T) @ apart
    spread = np.sqrt(np.diag(covariance))
    if (np.abs(p) > IMPOSSIBLE * prior).any():
        p, spread = np.zeros(9), prior
    matrix, bias = matrix_of(p)
    sigma = np.zeros((3, 3))
    for k, (i, j) in enumerate(SYMMETRIC):
        sigma[i, j] = sigma[j, i] = spread[k]
    return matrix, bias, sigma, spread[6:]


def likeliest(p, means, g, scale, prior):
    """(parameters (9,), their information (9, 9), log posterior but for a constant) where |force|
    repeats to so much (m/s2); by steps from p that are shortened until they make it likelier
    [Levenberg, Q. Appl. Math. 2 (1944), 164]."""
    def looked_at(p):
        matrix, bias = matrix_of(p)
        true = (means - bias) @ matrix.T
        size = np.linalg.norm(true, axis=1)
        unit = true / np.maximum(size, 1e-9)[:, None]
        jacobian = np.empty((len(means), 9))
        for k, (i, j) in enumerate(SYMMETRIC):
            change = np.zeros((3, 3))
            change[i, j] = change[j, i] = 1.0
            jacobian[:, k] = (unit * ((means - bias) @ change.T)).sum(axis=1)
        jacobian[:, 6:] = -unit @ matrix
        off = (g - size) / scale
        log = -0.5 * (FREEDOM + 1.0) * np.log1p(off ** 2 / FREEDOM).sum() - len(off) * np.log(
            scale) - 0.5 * ((p / prior) ** 2).sum()
        return jacobian / scale, off, log

    jacobian, off, log = looked_at(p)
    damping = 1e-3
    for _ in range(STEPS):
        weight = (FREEDOM + 1.0) / (FREEDOM + off ** 2)
        gram = (jacobian.T * weight) @ jacobian + np.diag(prior ** -2.0)
        step = np.linalg.solve(gram + damping * np.diag(np.diag(gram)),
                               jacobian.T @ (weight * off) - p / prior ** 2)
        tried = looked_at(p + step)
        if tried[2] < log:
            damping *= 10.0
        else:
            p, damping = p + step, damping / 10.0
            jacobian, off, log = tried
        if step @ gram @ step < SMALL ** 2 or damping > 1e12:
            break
    # What Student's t says of its place on average [Lange et al. (1989), section 4].
    known = (FREEDOM + 1.0) / (FREEDOM + 3.0)
    return p, known * jacobian.T @ jacobian + np.diag(prior ** -2.0), log


def matrix_of(p):
    """((3, 3) symmetric matrix, (3,) bias) of nine parameters, zero for a sensor without error."""
    matrix = np.eye(3)
    for value, (i, j) in zip(p, SYMMETRIC):
        matrix[i, j] += value
        if i != j:
            matrix[j, i] += value
    return matrix, p[6:]


def by_carry(trace, rate, ups, tilt):
    """(matrix (3, 3), sigma (3, 3)) of the gyro by gravity before and after each move.

    tilt (3,): how far the direction of gravity in the sensor may be off, the same at every rest,
    since a log whose rests lie alike does not show the accelerometer's bias; it turns with the
    robot and would pass for a scale of the gyro. Over bumps the samples lie too far apart: how
    much that matters is what every second of them makes of the same move. Moves are weighed by
    Student's t besides.
    """
    coarse = [CARRY_RAD + astray(trace, rate, ups[k], k) for k in range(len(trace.rests) - 1)]
    prior = np.concatenate([np.full(9, SHAPE), np.maximum(tilt, 1e-6)])
    p, wider = np.zeros(12), 1.0
    for _ in range(ROUNDS):
        matrix = np.eye(3) + p[:9].reshape(3, 3)
        gram, right, off = np.diag(prior ** -2.0), -p / prior ** 2, []
        for k in range(len(trace.rests) - 1):
            first, last = trace.rests[k][1] - 1, trace.rests[k + 1][0]
            true = rate[first:last + 1] @ matrix.T
            dt = np.diff(trace.t[first:last + 1])[:, None]
            middle = 0.5 * (true[1:] + true[:-1])
            turns = carried(rotations(middle * dt))
            raw = 0.5 * (rate[first + 1:last + 1] + rate[first:last]) * dt
            # d(turn) = sum over samples of R(t) dM w dt, in the frame of the start
            spread = np.einsum("nij,nk->ijk", turns[:-1], raw).reshape(3, 9)
            before, after = ups[k] + p[9:], ups[k + 1] + p[9:]
            x, y, z = before
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            jacobian = np.hstack([cross @ spread, np.eye(3) - turns[-1]])
            left = turns[-1] @ after - before
            if np.linalg.norm(left) > 0.5:
                continue  # a convention, not a parameter
            size = (left ** 2).sum() / 2.0 / coarse[k] ** 2
            weight = (FREEDOM + 2.0) / (FREEDOM + 2.0 * size / wider ** 2) / (
                wider * coarse[k]) ** 2
            off.append(size)
            gram += weight * jacobian.T @ jacobian
            right += weight * jacobian.T @ left
        p = p + np.linalg.solve(gram, right)
        # Where gravity is carried worse than that, the intervals are as much wider.
        if off:
            wider = max(1.0, np.sqrt(np.median(off) / MEDIAN_OF_TWO))
    spread = np.sqrt(np.diag(np.linalg.inv(gram)))
    if (np.abs(p[:9]) > IMPOSSIBLE * SHAPE).any():
        p, spread = np.zeros(12), prior
    return np.eye(3) + p[:9].reshape(3, 3), spread[:9].reshape(3, 3)


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
