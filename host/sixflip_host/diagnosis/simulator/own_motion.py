"""Where a log's sensor sits and how late it is, by the log's own motion: what the force is beside
the gravity that the gyro carries along, against how the sensor turns. What the hand or the wheels
do besides is noise.
"""
from dataclasses import dataclass

import numpy as np

from . import alignment as align_by
from . import convention_findings, conventions, evidence_of_logs, hypotheses, traces
from .pairing import GRID_HZ, increasing

ARM_M = 0.3  # prior of a lever arm in a log: of the sensor, and of the point it is turned about
BAND_HZ = align_by.BAND_HZ
FEWEST_MOVES = 8  # of which the jackknife takes one after the other away: it errs by a quarter
# Standard errors between two logs from which on they differ: 1 of 150,000 by chance (normal),
# since the errors of eight moves have heavier tails. Chi-squared of three numbers is as rare 6.5
# above the square of that; the rest is for the same tails.
APART, CHI_OF_THREE = 4.5, 10.0


@dataclass(frozen=True)
class OwnMotion:
    """tangential, spinning (3,) m: what multiplies dw/dt x and w x (w x) in the force; their
    covariance (6, 6); delay_s of the force behind the rate and its sigma."""

    tangential: np.ndarray
    spinning: np.ndarray
    covariance: np.ndarray
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
        return np.stack([np.interp(t, *increasing(trace.t, flat[:, i]))
                         for i in range(flat.shape[1])], 1)

    up, rate, rate_dot, force = (onto(x) for x in (motion.up, motion.rate, motion.rate_dot,
                                                   true.force))
    if rate.std() < 1e-3:
        return None
    moved = traces.Motion(None, up, rate, rate_dot, None, None, ())
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
        result = evidence_of_logs.regression(force - signal, own, sds, columns, np.zeros(7), prior,
                                             inflation, live, rows, covariance=True)
        left = result[4]
        rows = conventions.local_noise(left)
        inflation = align_by.independent(left / rows[:, None])
    shared = result[2]
    groups = moves_of(trace, t)
    if len(np.unique(groups)) < FEWEST_MOVES:
        return None
    parts = []
    for number in np.unique(groups):
        keep = groups != number
        parts.append(evidence_of_logs.regression(
            (force - signal)[keep], own[keep], sds, columns[keep], np.zeros(7), prior, inflation,
            live, rows[keep])[2])
    parts = np.array(parts)
    apart = parts - parts.mean(axis=0)
    covariance = result[6] + (len(parts) - 1.0) / len(parts) * apart.T @ apart
    return OwnMotion(shared[:3], shared[3:6], covariance[:6, :6], float(shared[6]),
                     float(np.sqrt(covariance[6, 6])))


def moves_of(trace, t):
    """(n,) number of the move that each time is in or just before: the hand moves in another way
    each time, so a move is what counts as one observation [Efron & Stein, The jackknife estimate
    of variance, Ann. Statist. 9 (1981), 586]."""
    middles = [0.5 * (trace.t[a] + trace.t[b - 1]) for a, b in trace.rests]
    return np.searchsorted(np.array(middles), t)


def compared(real, sim, row_s):
    """Conventions by which two OwnMotions differ."""
    out = []
    late = -(sim.delay_s - real.delay_s)
    sigma = float(np.hypot(real.delay_sigma_s, sim.delay_sigma_s))
    if abs(late) > APART * sigma and abs(late) >= row_s:
        return [conventions.late_one(late, sigma)]
    both = real.covariance + sim.covariance
    apart = np.concatenate([sim.tangential - real.tangential, sim.spinning - real.spinning])
    chi = [float(apart[k] @ np.linalg.solve(both[k, k], apart[k])) for k in (
        slice(0, 3), slice(3, 6))]
    limit = APART ** 2 + CHI_OF_THREE
    if max(chi) < limit:
        return out
    arm = chi_of(np.concatenate([sim.tangential, sim.spinning]), sim.covariance)
    factor, scaled = scaled_by(real, sim)
    names = []
    if chi[1] > limit and chi[0] < limit / 3 and spinless(sim):
        names = ["no_centripetal_term"]
    elif arm < limit:
        names = ["lever_arm_missing"]
    elif scaled:
        names = ["time_step", "lever_arm_missing"]
    else:
        names = ["lever_arm_missing", "no_centripetal_term", "time_step"]
    nats = 0.5 * max(chi)
    if len(names) == 1:
        r = real.tangential - sim.tangential
        value = {a: float(100 * v) for a, v in zip("xyz", r)} \
            if names[0] == "lever_arm_missing" else {}
        out.append(convention_findings.finding(
            names[0], "accel", conventions.CERTAIN, nats, value=value,
            unit="cm" if value else ""))
    else:
        out.append(convention_findings.one_of("accel", names, conventions.CERTAIN, nats))
    return out


def chi_of(x, covariance):
    """Chi-squared of x (n,) being zero, by its covariance (n, n)."""
    return float(x @ np.linalg.solve(covariance, x))


def spinless(sim):
    """True when the simulator's spinning arm is nothing while its tangential one is something."""
    return chi_of(sim.spinning, sim.covariance[3:, 3:]) < APART ** 2 + CHI_OF_THREE


def scaled_by(real, sim):
    """(factor, whether the simulator's arms are that factor times the real ones)."""
    a = np.concatenate([real.tangential, real.spinning])
    b = np.concatenate([sim.tangential, sim.spinning])
    factor = float(a @ b / max(a @ a, 1e-12))
    left = b - factor * a
    covariance = sim.covariance + factor ** 2 * real.covariance
    return factor, chi_of(left, covariance) < APART ** 2 + CHI_OF_THREE and abs(factor - 1.0) > 0.3
