"""Logs of different motions side by side, and the delay between the sensors of each.

Two logs of one motion give their differences (timing.py). Of a log by itself it is its own motion
that says how late one sensor is behind the other: what the force is beside the gravity that the
gyro carries along, against how the sensor turns. What the hand or the wheels do besides is noise.
"""
from dataclasses import dataclass, replace

import numpy as np

from ...experiment.projection import regression
from . import alignment as align_by
from . import hypotheses, own_calibration, own_consistency, row_times, timing, traces
from .pairing import GRID_HZ, local_noise

ARM_M = 0.3  # prior of a lever arm in a log: of the sensor, and of the point it is turned about
BAND_HZ = align_by.BAND_HZ
FEWEST_MOVES = 8  # of which the jackknife takes one after the other away: it errs by a quarter
# Standard errors between two logs from which on they differ: 1 of 150,000 by chance (normal),
# since the errors of eight moves have heavier tails.
APART = 4.5


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
    return [timing.late_one(late, sigma)] * itself, not itself


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
