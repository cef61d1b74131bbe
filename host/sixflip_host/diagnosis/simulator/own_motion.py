"""Logs of different motions side by side, and layer two of what is in time: the delay between the
sensors, the smoothness of each, and the clock.

Two logs of one motion give their differences. Of a log by itself it is its own motion that says
how late one sensor is behind the other: what the force is beside the gravity that the gyro carries
along, against how the sensor turns. What the hand or the wheels do besides is noise.
"""
from dataclasses import dataclass, replace
from math import erfc

import numpy as np

from ...experiment.projection import regression
from . import alignment as align_by
from . import (
    convention_findings,
    hypotheses,
    own_calibration,
    own_consistency,
    parameters,
    row_times,
    traces,
)
from .pairing import GRID_HZ, local_noise

ARM_M = 0.3  # prior of a lever arm in a log: of the sensor, and of the point it is turned about
BAND_HZ = align_by.BAND_HZ
FEWEST_MOVES = 8  # of which the jackknife takes one after the other away: it errs by a quarter
# Standard errors between two logs from which on they differ: 1 of 150,000 by chance (normal),
# since the errors of eight moves have heavier tails.
APART = 4.5
# An engine whose rates are half a physics step older than its forces (MuJoCo, Featherstone's
# semi-implicit step) differs from itself by as much at two step sizes of 1 and 2 ms.
LEAST_DELAY_MS = 0.5
LEAST_SMOOTH_MS2 = 3.0  # half the square of a time constant of 2.4 ms
# Quartz is within 50 ppm of its frequency (boards' crystals have 10 to 50 in their data sheets),
# and two logs have one each: so much is no simulator's fault, and nothing to set.
QUARTZ = 1e-4
LATE_SIGMA = 4.0  # standard errors from which on a delay is one: by chance in 1 of 16,000 (normal)


@dataclass(frozen=True)
class OwnMotion:
    """delay_s of the force behind the rate and its sigma, beside the arms that multiply dw/dt x
    and w x (w x) in the force."""

    delay_s: float
    delay_sigma_s: float


def fitted(trace, sensor):
    """OwnMotion of a Trace by its OwnSensor; None where it does not move."""
    true = sensor.applied(trace)
    motion = traces.motion(true)
    t = np.arange(0.2, trace.seconds - 0.2, 1.0 / GRID_HZ)
    if motion is None or len(t) < 5 * GRID_HZ:
        return None

    def onto(values):
        flat = align_by.smooth(values.reshape(len(values), -1), trace.rate_hz, BAND_HZ)
        return np.stack([np.interp(t, *row_times.increasing(trace.t, flat[:, i]))
                         for i in range(flat.shape[1])], 1)

    up, rate, rate_dot, force = (onto(x) for x in (motion.up, motion.rate, motion.rate_dot,
                                                   true.force))
    if rate.std() < 1e-3:
        return None
    moved = traces.Motion(None, up, rate, rate_dot, None, None)
    spin = hypotheses.spinning(rate)
    tangential = hypotheses.lever_columns(moved) - spin
    signal = trace.g * up
    slope = -np.gradient(signal, axis=0) * GRID_HZ
    own = np.concatenate([signal, np.ones((len(t), 1))], 1)
    sds = np.concatenate([np.full(3, hypotheses.SHAPE), [hypotheses.BIAS["accel"]]])
    columns = np.concatenate([tangential, spin, slope[:, :, None]], 2)
    prior = np.concatenate([np.full(6, ARM_M), [hypotheses.DELAY_S]])
    live = np.ones(3, bool)
    rows, inflation = None, 1.0
    for _ in range(3):
        result = regression(force - signal, own, sds, columns, np.zeros(7), prior, inflation,
                            live, rows)
        rows = local_noise(result.left)
        inflation = align_by.independent(result.left / rows[:, None])
    groups = moves_of(trace, t)
    if len(np.unique(groups)) < FEWEST_MOVES:
        return None
    parts = []
    for number in np.unique(groups):
        keep = groups != number
        parts.append(regression(
            (force - signal)[keep], own[keep], sds, columns[keep], np.zeros(7), prior, inflation,
            live, rows[keep], residuals=False).shared)
    parts = np.array(parts)
    apart = parts - parts.mean(axis=0)
    covariance = result.covariance + (len(parts) - 1.0) / len(parts) * apart.T @ apart
    return OwnMotion(float(result.shared[6]), float(np.sqrt(covariance[6, 6])))


def moves_of(trace, t):
    """(n,) number of the move that each time is in or just before: the hand moves in another way
    each time, so a move is what counts as one observation [Efron & Stein, The jackknife estimate
    of variance, Ann. Statist. 9 (1981), 586]."""
    middles = [0.5 * (trace.t[a] + trace.t[b - 1]) for a, b in trace.rests]
    return np.searchsorted(np.array(middles), t)


def compared(real, sim, row_s):
    """([Convention] of a simulator one of whose sensors is late where the real one's is not,
    whether it lacks a delay of the real one: that it has to learn, not lose), by two OwnMotions.
    Where a sensor seems to sit follows from what else a hand or a robot does, which is not the
    same in another motion."""
    late = real.delay_s - sim.delay_s
    sigma = float(np.hypot(real.delay_sigma_s, sim.delay_sigma_s))
    if abs(late) <= APART * sigma or abs(late) < row_s:
        return [], False
    itself = late_itself(sim, late)
    return [late_one(late, sigma)] * itself, not itself


def late_itself(sim, late):
    """Whether the simulator's own motion shows most of a delay against the real log (s)."""
    return abs(sim.delay_s) > max(APART * sim.delay_sigma_s, 0.5 * abs(late)) \
        and sim.delay_s * late < 0.0


def shown_late(sim, late):
    """Whether a simulator's log of the real one's motion is late by itself, as its own rests and
    moves say. Which of two logs it is that is late the pair does not tell: where nothing else does
    a real sensor behind a filter is as likely, and the delay is a number to be set."""
    sensor = own_calibration.fitted(sim)
    moved = fitted(sim, sensor) if sensor is not None and sim.rests else None
    return moved is not None and late_itself(moved, late)


def different_motion(real, sim, own_real, row_s, moving=True):
    """(Conventions, sentences on what cannot be seen, whether what shows in motion was compared,
    whether the simulator lacks a delay) of logs of two motions, or of none (moving)."""
    if sim.rate is None or real.rate is None:
        return [], ["conventions of %s: they need a gyro in both logs" % sim.name], False, False
    # Where it drives slowly gravity is known as well as a direction has to be here.
    findings, unseen = own_consistency.conventions_of(*(
        replace(log, rests=log.calm) for log in (real, sim)), moving,
        1.0 if own_real is None else own_real.turns)
    if findings or own_real is None or not sim.rests:
        return findings, unseen, False, False
    moved = fitted(real, own_real), fitted(sim, own_calibration.fitted(sim))
    if None in moved:
        return findings, unseen + ["delay of %s: fewer than %d moves between rests" % (
            sim.name, FEWEST_MOVES)], False, False
    findings, lacks_delay = compared(*moved, row_s)
    return findings, unseen, True, lacks_delay


def timing(late, late_sigma, fits, alignment, freed=None):
    """Delay between the sensors, smoothness of each, clock: differences only, each with what to
    do; freed {sensor: s2}: half the square of the time constant by which the straight lines that
    stand for repeated rows make the simulator's log smoother than the real one."""
    numbers = []
    if late is not None:
        numbers.append(with_how(parameters.compared(
            "delay", "gyro", "", "ms", None, np.inf, None, np.inf, -1e3 * late, 1e3 * late_sigma,
            least=LEAST_DELAY_MS), later))
    for kind, sensor_fit in fits.items():
        fit = sensor_fit.fit
        if any(c.name == "unknown" for c in sensor_fit.conventions):
            continue
        smooth_s2 = fit.smooth_s2 - (freed or {}).get(kind, 0.0)
        told = smooth_s2 / np.hypot(fit.smooth_sigma_s2, 1e-6 * LEAST_SMOOTH_MS2)
        numbers.append(with_how(parameters.compared(
            "smoothness", kind, "", "ms²", None, np.inf, None, np.inf, -1e6 * smooth_s2,
            1e6 * fit.smooth_sigma_s2, least=LEAST_SMOOTH_MS2,
            apart=np.sqrt(max(told ** 2 - sensor_fit.smoothing_earns, 0.0))), smoother))
    if alignment.same:
        numbers.append(with_how(parameters.compared(
            "clock", "device", "", "%", None, np.inf, None, np.inf, -100.0 * alignment.drift,
            100.0 * alignment.drift_sigma,
            apart=(abs(alignment.drift) - QUARTZ) / alignment.drift_sigma), faster))
    return numbers


def slope(fits):
    """[Parameter]: degrees by which the floor of one log slopes more than the other's."""
    fit = fits["accel"].fit if "accel" in fits else None
    if fit is None or not fit.hypothesis.slopes:
        return []
    size = float(np.hypot(*fit.extra))
    sigma = float(np.hypot(*(fit.extra * fit.extra_sigma))) / max(size, 1e-12)
    return [with_how(parameters.compared(
        "slope", "device", "", "°", None, np.inf, None, np.inf, np.degrees(np.arctan(size)),
        np.degrees(sigma)), "lean its floor, or its gravity, by {:.2f}° otherwise".format)]


def with_how(parameter, how):
    """The Parameter with what to do where it differs."""
    return replace(parameter, how=how(parameter.difference)) if parameter.differs else parameter


def later(ms):
    """What to do about a delay between the sensors: gyro after accelerometer, or the reverse."""
    return "output the %s %.3g ms later" % ("gyro" if ms > 0 else "accelerometer", abs(ms))


def smoother(ms2):
    """Half the square of a time constant; two poles one after the other add theirs."""
    tau_ms = np.sqrt(2.0 * abs(ms2))
    pole = "low-pass of first order at %.3g Hz (time constant %.3g ms)" % (
        1e3 / (2.0 * np.pi * tau_ms), tau_ms)
    return "put a %s behind it" % pole if ms2 > 0 else \
        "it is smoother than the sensor by a %s: take as much out" % pole


def faster(percent):
    """What to do about a clock that runs this much faster than the real one."""
    return "multiply its times by %.6g" % (1.0 - percent / 100.0)


def delay(sensor_fits, row_s):
    """(seconds by which the gyro is later than the accelerometer, more than the real sensor's;
    standard error), and the Convention where it is a row or more."""
    # A fit without a name has the signal's derivatives beside it, which take any delay for theirs.
    if len(sensor_fits) < 2 or any(
            c.name == "unknown" for f in sensor_fits.values() for c in f.conventions):
        return None, None, []
    a, g = sensor_fits["accel"].fit, sensor_fits["gyro"].fit
    late = g.delay_s - a.delay_s
    sigma = float(np.hypot(a.delay_sigma_s, g.delay_sigma_s))
    findings = [late_one(late, sigma)] if abs(late) > LATE_SIGMA * sigma and (
        abs(late) >= row_s) else []
    return late, sigma, findings


def late_one(late, sigma):
    """The Convention of a gyro that is late by so many seconds, or an accelerometer (negative)."""
    kind = "gyro" if late > 0 else "accel"
    ms = 1e3 * abs(late)
    return convention_findings.finding(kind + "_delay", kind, 1.0 - 2.0 * _tail(abs(late) / sigma),
                   0.5 * (late / sigma) ** 2, "take %.1f ms of delay out of it" % ms,
                   value={"delay": ms}, unit="ms", interval_90={
                       "delay": (ms - 1645.0 * sigma, ms + 1645.0 * sigma)})


def _tail(z):
    return 0.5 * erfc(z / 2.0 ** 0.5)
