"""Drift: more flicker than is allowed, all over the session and within the rests.

A random walk is none where one jump in each session, or one slow sine, does about as well: what
jumps once or sways does not drift.
"""
import numpy as np

from . import adequacy, which

DRIFT_NATS = 6.0
JUMP_NATS = 3.0  # what a jump at an unknown time costs in each session
SWAY_NATS = 4.0  # what a sine of unknown period and phase costs in each session
SHORTEST_SWAY_S, SWAYS_AN_OCTAVE = 16.0, 6
STILL_FITS = 1.6  # chi2 a degree of freedom that freer flicker must bring it down to


def level(gap):
    """(flicker level, nats gained by it) of a SensorGap that drifts, or None: more flicker than
    is allowed, the rests themselves wander so, and all that is left looks like it."""
    columns = np.concatenate([c.columns for c in gap.chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in gap.chosen] + [np.zeros(0)])
    free = which.fits(gap.data, columns, prior)
    highest = max(u.grid[f.index[0]][1] for u, f in zip(gap.units, free))
    if highest <= gap.allowed * 1.001:
        return None
    gain = sum(float(f.loglik[0]) - _at_level(u, s, columns, prior, gap.allowed)
               for u, f, s in zip(gap.units, free, gap.data.statistics))
    seen = expected = 0.0
    least = 1.0
    for (part, _), unit, fit in zip(gap.parts, gap.units, free):
        values = part.accel if gap.kind == "accel" else part.gyro
        noise = part.noise_accel if gap.kind == "accel" else part.noise_gyro
        found = adequacy.wandering(part, values, noise, unit.grid[fit.index[0]][1])
        if found:
            seen, expected = seen + found[0], expected + found[1]
            least = min(least, found[2])
    ratio = sum(float(f.quadratic[0]) for f in free) / max(
        1, sum(u.freedom for u in gap.units) - len(columns))
    if gain <= DRIFT_NATS or seen <= 0.4 * expected or least >= 1e-3 or ratio >= STILL_FITS:
        return None
    if max(_simpler(gap, free)) >= gain - DRIFT_NATS / 2.0:
        return None
    return highest, gain


def _simpler(gap, fits):
    """Nats that one jump in each session gains, and one sine, with no more flicker than is
    allowed."""
    jump = sway = 0.0
    for (part, _), unit, fit in zip(gap.parts, gap.units, fits):
        placement = unit.grid[fit.index[0]][0]
        factor = np.linalg.cholesky(unit.covariance(placement, gap.allowed))
        z = np.linalg.solve(factor, unit.z)
        take = np.linalg.solve(factor, unit.contrasts.T)
        steps = ((part.placement >= start)[:, None] for start in np.unique(part.placement)[1:])
        jump += max(_gain(take, z, steps) - JUMP_NATS, 0.0)
        sway += max(_gain(take, z, _sines(part.t)) - SWAY_NATS, 0.0)
    return jump, sway


def _sines(t):
    """(n, 2) sine and cosine of every period from SHORTEST_SWAY_S to the session's length."""
    longest = max(float(np.ptp(t)), 2.0 * SHORTEST_SWAY_S)
    octaves = np.log2(longest / SHORTEST_SWAY_S)
    # A session holds many periods of a fast sine: as dense as the phase at its ends wants.
    count = max(int(SWAYS_AN_OCTAVE * octaves), int(4.0 * longest / SHORTEST_SWAY_S))
    for frequency in np.linspace(1.0 / longest, 1.0 / SHORTEST_SWAY_S, count):
        phase = 2.0 * np.pi * frequency * t
        yield np.stack([np.sin(phase), np.cos(phase)], 1)


def _gain(take, z, courses):
    """Largest gain in nats of any course (n, k) on all three axes."""
    best = 0.0
    for course in courses:
        columns = take @ np.kron(course, np.eye(3))
        size = np.linalg.lstsq(columns, z, rcond=1e-9)[0]
        best = max(best, 0.5 * float(z @ columns @ size))
    return best


def _at_level(unit, statistics, columns, prior, allowed):
    """Largest log-likelihood with no more flicker than allowed."""
    quadratic, projections = statistics
    keep = [i for i, (_, level) in enumerate(unit.grid) if level <= allowed * 1.001]
    return max(float(which.Fit(_Point(unit, i), (quadratic[i:i + 1], projections[i:i + 1]),
                               columns, prior).loglik[0]) for i in keep)


class _Point:
    """One point of a unit's grid, for which.Fit."""

    def __init__(self, unit, index):
        self.grid = unit.grid[index:index + 1]
        self.gram, self.logdet = unit.gram[index:index + 1], unit.logdet[index:index + 1]
