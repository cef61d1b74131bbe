"""How well a hypothesis on the simulator's output predicts it: marginal likelihood with every
coefficient integrated over its prior, on the same samples for all hypotheses.

Linear in the coefficients, noise of each channel by maximum likelihood; neighbouring samples are
not independent, so the likelihood counts as many samples as its residual has independent ones.
Source: Bishop, Pattern Recognition and Machine Learning (2006), section 3.5.
"""
from dataclasses import dataclass

import numpy as np

from ...experiment.projection import MOST_ROWS, regression
from ..detect.wrong_scale import WIDEST
from . import sensor_axes
from .hypotheses import BIAS, DELAY_S, FREE, SHAPE
from .sensor_axes import DEAD

# Nats that a heading costs, which may be any: 4 % of misalignment tell so many of them apart.
HEADING = float(np.log(2.0 * np.pi / (np.sqrt(2.0 * np.pi) * SHAPE)))
LEAST_FACTOR = 1e-3  # of a channel: it reads nothing; with the other sign it is another axis
ODD = 0.01  # share of the logs whose header says another full scale than the part has, or none
# Of a delay: the columns of the slope and the bend foretell so little to 1e-7 of a wave of 10 Hz.
SETTLED_S = 1e-4
POINTS = 6  # off by 1e-3 at the end of the widest band, eight rows a period


@dataclass(frozen=True)
class Fit:
    """One hypothesis fitted. log: marginal log likelihood; bias (3,): simulator = S (1 + E) ·
    signal + bias + columns · extra; axes (3, 3) and unit: S; extra (k,) with its sigma; delay_s of
    the simulator against the signal, and its sigma; smooth_s2: half the square of the time
    constant by which the simulator is smoother than the signal (negative: less smooth); shape
    (3, 3): E, with its sigma; left (n, 3): what is not predicted, None of one of many fits."""

    hypothesis: object
    name: str
    log: float
    bias: np.ndarray
    axes: np.ndarray
    unit: float
    extra: np.ndarray
    extra_sigma: np.ndarray
    delay_s: float
    delay_sigma_s: float
    smooth_s2: float
    smooth_sigma_s2: float
    shape: np.ndarray
    shape_sigma: np.ndarray
    bias_sigma: np.ndarray
    left: np.ndarray


def names(fit, kind, live):
    """What a Fit says the simulator does other than a sensor: () is healthy."""
    deviations = [] if fit.name == "healthy" else [fit.name or "unknown"]
    answers = live & fit.axes.any(axis=1)
    if (live & ~answers).any():
        deviations.append("constant_channel")
    turned = not np.array_equal(fit.axes[answers], np.eye(3)[answers])
    if turned and not fit.name.startswith("world_frame"):
        deviations.append(sensor_axes.name_of(fit.axes, kind, live))
    if fit.unit != 1.0:
        deviations.append(kind + "_unit")
    return tuple(deviations)


def fits(hypothesis, measured, kind, grid_hz, inflation=1.0, own=None, live=None,
         rows=None, noise_bends=(0.0, 0.0), swapped=None, most=MOST_ROWS):
    """Fits of a Hypothesis, one for each S that may be: none, the nearest signed permutation and
    unit, and swapped (3, 3), that of the other sensor or None, without what they leave; measured
    (n, 3); own (columns (n, q), sizes (q,)): what the real sensor adds of itself to each channel;
    live (3,): channels that are not constant; rows (n,): the noise of each sample, in units of the
    average; noise_bends: bends() of the noise, none where no smoother fit is weighed for what it
    takes away; most: rows that a fit looks at."""
    live = np.ones(3, bool) if live is None else live
    every_fit = []
    for axes, unit in sensor_axes.candidates(hypothesis, measured, kind, live, swapped, own):
        def fitted(axes, unit=unit):
            return fit_one(hypothesis, measured, axes, unit, grid_hz, kind, inflation, own, live,
                           rows, left=False, noise_bends=noise_bends, most=most)
        fit = fitted(axes)
        if sensor_axes.is_mounted(axes) and not hypothesis.heading:
            fit = fitted(sensor_axes.nearest_turn((np.eye(3) + fit.shape) @ axes))
        every_fit.append(fit)
    return every_fit


def fit_one(h, measured, axes, unit, grid_hz, kind, inflation, real_own, live, rows, left=True,
            noise_bends=(0.0, 0.0), most=MOST_ROWS):
    """The Fit of a Hypothesis with one S; left: with what it does not predict of every sample, and
    with errors that take account of that; one of many fits is compared by its evidence alone."""
    n = len(measured)
    delay, k = 0.0, h.columns.shape[2]
    target = measured / unit
    turned, variance = axes @ h.columns, None
    for last in (False, False, True):
        every = 1 if last and left else max(1, n // most)  # a few rows will do for the rest
        some = slice(None, None, every)
        signal = shifted(h.signal, delay * grid_hz) @ axes.T
        slope = -np.gradient(signal, axis=0) * grid_hz
        bend = -np.gradient(slope, axis=0) * grid_hz
        if h.behind is not None:
            bend = h.behind.bend(bend, grid_hz)
        columns = np.concatenate([shifted(turned, delay * grid_hz, every),
                                  slope[some, :, None], bend[some, :, None]], 2)
        mean = np.concatenate([h.mean, [-delay, 0.0]])
        sd = np.concatenate([h.sd, [DELAY_S, h.smooth_sd]])
        own = [signal[some], np.ones((len(columns), 1))]
        own_sd = [np.full(3, SHAPE) if h.shape_sd is None else h.shape_sd,
                  np.reshape(BIAS[kind] if h.bias_sd is None else h.bias_sd, (-1, 1))]
        if h.free is not None:
            scale = np.maximum(h.free.std(axis=0), 1e-9)
            own.append(h.free[some])
            own_sd.append(FREE * max(signal.std(), 1e-9) / scale)
        if real_own is not None:
            own.append(real_own[0][some])
            own_sd.append(real_own[1])
        widths = np.concatenate([np.broadcast_to(width, (3, np.shape(width)[-1]))
                                 for width in own_sd], axis=1)
        result = regression((target - signal)[some], np.concatenate(own, 1), widths, columns,
                            mean, sd, inflation, live, rows if rows is None else rows[some],
                            residuals=last and left, every=every, variance=variance)
        step, variance = float(np.clip(result.shared[k], -0.05, 0.05)), result.variance
        delay += step
        if not left and abs(step) < SETTLED_S:
            break
    log, beta, shared, sigma = result.log, result.own, result.shared, result.shared_sigma
    # Of a channel that reads a part of the signal only, the smoothing is that of the part.
    part = np.maximum(1.0 + np.diag(beta[:, :3]) + (shared[:h.scaled] if h.scaled else 0.0), DEAD)
    for weaker in (gains(h, beta, shared), smoothed(shared[k + 1] / part, noise_bends)):
        log += 0.5 * n / inflation * np.minimum(0.0, np.log(weaker))[live].sum()
    log -= live.sum() * n / inflation * np.log(unit) + HEADING * h.heading
    if h.name:
        log += of_factors(np.diag(beta[:, :3])[live], np.diag(widths[:, :3])[live],
                          h.name == "healthy" and unit == 1.0 and not h.shared)
    if h.constant:
        log += of_gravity(beta[:, 3], h.constant)
    return Fit(h, h.name, log, beta[:, 3] * unit, axes, unit, shared[:k], sigma[:k], delay,
               float(sigma[k]), float(shared[k + 1]), float(sigma[k + 1]),
               (np.eye(3) + beta[:, :3]) / h.full_scale - np.eye(3),
               result.own_sigma[:, :3] / h.full_scale, result.own_sigma[:, 3] * unit,
               result.left * unit if left else None)


def of_gravity(constant, g):
    """Nats by which the prior of a constant (3,) that is gravity is other than that of one whose
    parts are each of a width g: it is as long as g, up to scale and bias, whatever its direction.
    In another unit it is not, and with the unit what shakes the real log alone would shrink."""
    size, width = float(np.linalg.norm(constant)), np.hypot(SHAPE * g, BIAS["accel"])
    return float(-0.5 * ((size - g) / width) ** 2 - np.log(np.sqrt(2.0 * np.pi) * width)
                 - np.log(4.0 * np.pi * g ** 2)
                 + 0.5 * (size / g) ** 2 + 1.5 * np.log(2.0 * np.pi * g ** 2))


def of_factors(scale, width, odd):
    """Nats by which the prior of scales (k,), off from 1 as fitted, is other than that of a sum of
    such widths (k,): a scale is a factor, and half is as far from 1 as twice is. A unit or a wrong
    time step that the scale takes back would lie within some widths of it otherwise, whatever the
    factor. odd: the part may read any factor of all that it went through, as one whose full scale
    or header is wrong does, where nothing of the simulator's is and it does not share it."""
    factor = np.log(np.maximum(1.0 + scale, LEAST_FACTOR))
    known = width ** -2.0
    sound, widest = -0.5 * float(factor ** 2 @ known), np.log(WIDEST)
    if odd:
        common = np.clip(float(factor @ known) / known.sum(), -widest, widest)
        wide = np.sqrt(2.0 * np.pi / known.sum()) / (2.0 * widest)
        sound = float(np.logaddexp(np.log(1.0 - ODD) + sound, np.log(ODD * wide) - 0.5 * float(
            (factor - common) ** 2 @ known)))
    return sound + 0.5 * float(scale ** 2 @ known)


def gains(h, beta, shared):
    """(3,): by how much the real log's own noise would be in the prediction, as power, in its
    unit. Where that is less than in the reading itself, the fit may only have weakened a signal
    that is noisy in the real log; whether it has cannot be told from two logs [Fuller, Measurement
    Error Models (1987), section 1.1], so the better fit is not believed."""
    whole = np.eye(3) + beta[:, :3]
    if h.scaled:
        whole = whole + np.eye(3) * shared[:h.scaled]
    if h.copies and h.name == "":
        whole = whole + beta[:, 4:7]
    turned = beta[:, 7:10] if h.copies > 1 else np.zeros((3, 3))
    return np.maximum((whole ** 2).sum(axis=1) + (turned ** 2).sum(axis=1), 1e-12)


def bends(noise, grid_hz):
    """(mean product of noise (n, k) and its second derivative, mean square of that), each over the
    mean square of the noise, 1/s2 and 1/s4: how fast it is."""
    second = np.gradient(np.gradient(noise, axis=0), axis=0) * grid_hz ** 2
    power = max(float((noise ** 2).mean()), 1e-30)
    return float((noise * second).mean()) / power, float((second ** 2).mean()) / power


def smoothed(smooth_s2, noise_bends):
    """The power of a noise with such bends() after smoothing by so much (s2), over that before."""
    s = np.maximum(smooth_s2, 0.0)
    return np.maximum(1.0 + 2.0 * s * noise_bends[0] + s * s * noise_bends[1], 1e-12)


def shifted(x, rows, every=1):
    """x (n, …) later by so many rows, beyond its ends in a straight line (what is held there has a
    bend that nothing else comes near); of so many rows one. By Lagrange's polynomial through the
    POINTS around: half way between two rows a straight line is smoother than x is, as behind a
    pole of 16 Hz, and a log that is late was one that needs a low-pass."""
    if abs(rows) < 1e-6 or not x.size:
        return x[::every]
    n, number = len(x), min(POINTS, len(x))
    wanted = np.arange(0, n, every) - rows
    at = np.clip(wanted, 0, n - 1)
    beyond = wanted - at
    first = np.clip(at.astype(int) - (number // 2 - 1), 0, n - number)
    # All but those near the ends lie alike between their points: a few weights are those of all.
    alike, which = np.unique(np.round(at - first, 9), return_inverse=True)
    points, moved = range(number), 0.0
    for k in points:
        weight = np.prod([(alike - m) / (k - m) if m != k else np.ones(len(alike))
                          for m in points], axis=0)
        moved = moved + weight[which].reshape((-1,) + (1,) * (x.ndim - 1)) * x[first + k]
    for end, slope in ((beyond < 0.0, x[:2]), (beyond > 0.0, x[-2:])):
        if len(slope) == 2 and end.any():
            moved[end] += np.multiply.outer(beyond[end], slope[1] - slope[0])
    return moved
