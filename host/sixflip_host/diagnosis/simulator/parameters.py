"""Layer two: the numbers to set. Bias, scale and misalignment of the simulator and of the real
sensor side by side, each with its interval (delay, smoothness and clock: timing.py).

Two logs of one motion give the difference directly; logs of different motions give each sensor by
its own rests and moves, and the difference with the sum of both covariances.
"""
from dataclasses import dataclass, replace

import numpy as np

from sixflip import STANDARD_G

from ...experiment.noise_arrays import flicker_of_mean, flicker_of_sizes
from .. import odds
from . import convention_findings
from .alignment import errors
from .sensor_axes import DEG, SHAPE

# Some thirty numbers are compared: at this many standard errors one log pair in 500 shows a
# difference that is none (Bonferroni, normal).
DIFFERS = 4.0
# Times the noise, root mean square, of a gap from which on numbers that do not differ by
# themselves do so together, and less than which they leave; how many of them at most.
TOGETHER, FEW = 1.5, 4
# Cosine between an axis and the one line that what does not turn moves along, which then tells
# the scale of the axis: what is across it is no more than twice what is along.
ALONG = 0.45
BRIEF_S = 1.0  # of rests of any length: what flickers faster fades within the shortest of them
FOLLOWS = 0.5  # of the power of a channel, that may be left where its scale is told
MG = 1000.0 / STANDARD_G


@dataclass(frozen=True)
class Parameter:
    """name; sensor accel, gyro or device; axis "x", "xy" (row, column) or ""; unit; real and
    simulated: values with intervals (low, high) at 90 %, None where a log cannot say; difference
    real less simulated with its interval; differs; set_to: the simulator's value to set; how: what
    to do in words, of a number that simulators have no field for; least: as of compared(); form
    (low_pass.FORMS)."""

    name: str
    sensor: str
    axis: str
    unit: str
    real: float
    real_interval: tuple
    simulated: float
    simulated_interval: tuple
    difference: float
    difference_interval: tuple
    differs: bool
    set_to: float
    how: str = ""
    least: float = 0.0
    form: str = ""


def compared(name, sensor, axis, unit, real, real_sigma, sim, sim_sigma, difference=None,
             sigma=None, least=0.0, apart=None):
    """Parameter from values and standard errors; difference: where it is known better than by
    the two values; least: what no log of whole counts can tell from 0, or what such a number
    differs from itself by; apart: standard errors between the two, where that is not the
    difference over its own."""
    if difference is None:
        difference = real - sim
        sigma = float(np.hypot(real_sigma, sim_sigma))
    sigma = float(np.hypot(sigma, least))
    differs = bool(apart > DIFFERS if apart is not None else abs(difference) > DIFFERS * sigma)
    shown = [x if np.isfinite(s) else None for x, s in ((real, real_sigma), (sim, sim_sigma))]
    return Parameter(name, sensor, axis, unit, _number(shown[0]), _span(real, real_sigma),
                     _number(shown[1]), _span(sim, sim_sigma), float(difference),
                     _span(difference, sigma), differs,
                     to_set(sim, sim_sigma, difference) if differs and sim is not None else None,
                     least=least)


def to_set(sim, sim_sigma, difference):
    """The simulator's own value and the difference; a value that its log does not show to be
    other than nothing is taken for the nothing that simulators have by default."""
    own = sim if sim_sigma <= 0 or abs(sim) > DIFFERS * sim_sigma else 0.0
    return _number(own + difference)


def _number(x):
    return None if x is None or not np.isfinite(x) else float(x)


def _span(x, sigma):
    if x is None or not np.isfinite(x) or not np.isfinite(sigma):
        return None
    return float(x - odds.Z_90 * sigma), float(x + odds.Z_90 * sigma)


def shapes(real, sim, fits, usable, rounded=None, beside=False):
    """Bias, scale, misalignment; real, sim: OwnSensor or None; fits {sensor: SensorFit} of one
    motion or {}; usable {sensor: bool}: its conventions leave its numbers what they are; rounded
    {sensor: m/s2 or rad/s}, by which a simulator without noise errs the same way again and again;
    beside: the fits have effects besides, which what is read at rest has in it."""
    numbers = []
    for kind in ("accel", "gyro"):
        if not usable.get(kind) or real is None or sim is None:
            continue
        scale = MG if kind == "accel" else DEG
        unit = "mg" if kind == "accel" else "°/s"
        values = [own(x, kind) for x in (real, sim)]
        fit = fits[kind].fit if kind in fits else None
        # simulator = (1 + E) real + b, so real = (1 + more) simulator - (1 + more) b
        more = None if fit is None else np.linalg.inv(
            np.eye(3) + fit.axes.T @ fit.shape @ fit.axes) - np.eye(3)
        shift = None if fit is None else -(np.eye(3) + more) @ fit.axes.T @ fit.bias / fit.unit
        told, across, coarse = np.ones(3, bool), np.zeros(3, bool), np.zeros(3)
        if fit is not None:
            # Errors turn with their numbers into the real sensor's axes; of one that no channel of
            # the simulator answers to nothing is known.
            turn, share = np.abs(fit.axes), fit.axes ** 2
            silent = np.where(turn.any(axis=0), 0.0, np.inf)
            bias_sigma = np.sqrt(share.T @ fit.bias_sigma ** 2) + silent
            shape_sigma = np.sqrt(share.T @ fit.shape_sigma ** 2 @ share) + (
                silent[:, None] + silent)
            across = _across(fits[kind].hypothesis)
            told, coarse = _follows(fits[kind]), (rounded or {}).get(kind, 0.0) / np.maximum(
                fits[kind].pair.simulated(kind).std(axis=0) @ turn, 1e-12)
            # What wanders in either log has a part of any reading's course in it.
            shape_sigma = np.hypot(shape_sigma, np.hypot(
                real.flicker[kind], sim.flicker[kind]) * flicker_of_sizes(
                    fits[kind].pair.t, scale * fits[kind].pair.real(kind)[:, None]))
        for i, axis in enumerate("xyz"):
            pair = (None, None) if fit is None else (shift[i] * scale,
                                                     bias_sigma[i] * scale / fit.unit)
            (a, sa), (b, sb) = [(v[0][i] * scale, v[1][i] * scale) for v in values]
            if fit is not None and not (told[i] or across[i]):
                # A matrix that follows what the simulator lacks moves gravity by any amount: what
                # the two read on the average is known, and no better than a bias without it.
                apart, sigma = means_apart(fits[kind], i, scale)
                pair = apart, np.hypot(sigma, pair[1])
            elif kind == "gyro" and fit is not None and not beside and np.isfinite(sa + sb):
                # What is read at rest and what the motion leaves are two measurements of it.
                pair = weighed(pair, (a - b, float(np.hypot(sa, sb))))
            numbers.append(compared("bias", kind, axis, unit, a, sa, b, sb, *pair,
                                    least=flickers(real, sim, kind, fit and fits[kind].pair)))
        if fit is None and not usable.get("accel"):
            continue  # by its own moves a gyro is known by where the accelerometer finds gravity
        for i in range(3):
            for j in range(3):
                size = 100.0 if i == j else DEG
                pair = (None, None) if fit is None else (more[i, j] * size,
                                                         shape_sigma[i, j] * size)
                (a, sa), (b, sb) = [(v[2][i, j] * size, v[3][i, j] * size) for v in values]
                # Along one line a channel that is across it and reads nothing tells how it lies.
                if across[j] or not told[i] and (i == j or not across[i]):
                    continue
                if fit is None and kind == "accel" and i > j and not real.turned.any():
                    continue  # a turn of the whole accelerometer cannot be seen by rests alone
                numbers.append(compared("scale" if i == j else "misalignment", kind,
                                        "xyz"[i] + ("" if i == j else "xyz"[j]),
                                        "%" if i == j else "°", a, sa, b, sb, *pair,
                                        least=size * coarse[j]))
    return numbers


def flickers(real, sim, kind, pair=None):
    """By how much, mg or deg/s (standard deviation), the biases of two OwnSensors differ although
    they are of one part: each log has flicker of its own. Of those of one motion, a Pair, it is
    that of their means; of others of whatever rests they have."""
    seconds = BRIEF_S if pair is None else float(np.ptp(pair.t))
    return float(np.hypot(real.flicker[kind], sim.flicker[kind])) * flicker_of_mean(seconds)


def means_apart(sensor_fit, axis, scale):
    """(difference, standard error) of the mean of a real channel less that of the simulator's."""
    fit, pair, kind = sensor_fit.fit, sensor_fit.pair, sensor_fit.kind
    off = scale * (pair.real(kind) - pair.simulated(kind) @ fit.axes / fit.unit)[:, axis]
    silent = 0.0 if fit.axes[:, axis].any() else np.inf
    return float(off.mean()), float(errors(np.ones((len(off), 1)), off - off.mean())[0]) + silent


def weighed(one, other):
    """(value, standard error) of a number that was measured twice, each (value, standard error):
    by their inverse variances, and where they are further apart than those say as much less sure
    [Birge, Phys. Rev. 40 (1932), 207]."""
    total = one[1] ** -2.0 + other[1] ** -2.0
    apart = abs(one[0] - other[0]) / np.hypot(one[1], other[1])
    return ((one[0] * one[1] ** -2.0 + other[0] * other[1] ** -2.0) / total,
            max(1.0, apart) * total ** -0.5)


def _follows(sensor_fit):
    """(3,) bool: channels of the simulator that follow from the real log by more than half; what
    the others leave is none of their scale."""
    fit, measured = sensor_fit.fit, sensor_fit.pair.simulated(sensor_fit.kind)
    follow = fit.left.var(axis=0) < FOLLOWS * measured.var(axis=0)
    return (np.abs(fit.axes[follow]).sum(axis=0) > 0.5) if follow.any() else follow


def _across(hypothesis):
    """(3,) bool: axes along which nothing moved, of what does not turn."""
    sd = hypothesis.shape_sd
    return np.zeros(3, bool) if sd is None else sd.max(axis=0) < ALONG * SHAPE


def told(interval):
    """The keys of {key: 90 % interval} that differ from none, all where none does. An axis that
    has none of an effect is off by more than such an interval once in ten."""
    far = DIFFERS / odds.Z_90
    return [key for key, (low, high) in interval.items()
            if abs(high + low) > far * (high - low)] or list(interval)


def alone(parameter, difference, sigma):
    """The Parameter with the difference that it has where others are equal."""
    sigma = float(np.hypot(sigma, parameter.least))
    if abs(difference) <= DIFFERS * parameter.least:
        return parameter
    value, span = parameter.simulated, parameter.simulated_interval
    own = np.inf if span is None else (span[1] - span[0]) / 2.0 / odds.Z_90
    return replace(parameter, difference=float(difference),
                   difference_interval=_span(difference, sigma), differs=True,
                   set_to=None if value is None else to_set(value, own, difference))


def own(sensor, kind):
    """(bias, sigma, measured/true - 1, sigma) of an OwnSensor: what a simulator adds."""
    if kind == "accel":
        return (sensor.bias, sensor.bias_sigma, np.linalg.inv(sensor.accel) - np.eye(3),
                sensor.accel_sigma)
    return (sensor.gyro_bias, sensor.gyro_bias_sigma, np.linalg.inv(sensor.gyro) - np.eye(3),
            sensor.gyro_sigma)


def bias_sign(parameters):
    """Convention: the biases have the right size and the wrong sign (gz-sensors draws it)."""
    findings = []
    for kind in ("accel", "gyro"):
        own = [p for p in parameters if p.name == "bias" and p.sensor == kind]
        if len(own) < 3 or not any(p.differs for p in own) or any(
                None in (p.real_interval, p.simulated_interval) for p in own):
            continue
        sigma = [np.hypot(*[(s[1] - s[0]) / 2.0 / odds.Z_90 for s in (
            p.real_interval, p.simulated_interval)]) for p in own]
        large = [p for p, s in zip(own, sigma) if abs(p.real) > DIFFERS * s]
        turned = [p for p in large if p.differs and p.real * p.simulated < 0]
        equal = all(abs(abs(p.real) - abs(p.simulated)) < DIFFERS * s
                    for p, s in zip(own, sigma))
        if turned and equal and len(turned) == sum(p.differs for p in own):
            nats = 0.5 * sum((p.difference / s) ** 2 for p, s in zip(own, sigma))
            findings.append(convention_findings.finding(
                "bias_sign", kind, convention_findings.CERTAIN, nats, "turn its sign on " +
                " and ".join(p.axis for p in turned), value={p.axis: p.real for p in turned},
                unit=own[0].unit, interval_90={p.axis: p.real_interval for p in turned}))
    return findings
