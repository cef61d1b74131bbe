"""The loop closed for the gyro in motion: the real turns made again by the simulated gyro, with
the effects found and without, and the same figures of both (GAP stage 6, last sentence).

The motion is the real one: the rate as it was read, changed by the least constant rate that
makes each turn end where gravity says it did. The simulated gyro adds its effects to that.
"""
import copy

import numpy as np

from sixflip_sim.effects.library import make as make_effect
from sixflip_sim.effects.moment import Moment

from ..simulating import noise_arrays
from . import closed_loop, gyro_turns, nominal_fit, which

ROUNDS = 3


def close(gap, reference_c):
    """Loop of a TurnsGap, each session by the coefficients of the others; None without causes."""
    if not gap.chosen:
        return None
    columns = np.concatenate([c.columns for c in gap.chosen])
    prior = np.concatenate([c.prior for c in gap.chosen])
    fits = which.fits(gap.data, columns, prior)
    loop = closed_loop.Loop()
    loop.effects = closed_loop.specs(gap, which.coefficients(fits, prior)[0][0], reference_c)
    before = after = floor = number = 0.0
    for held, (unit, (session, model)) in enumerate(zip(gap.units, gap.parts)):
        others = fits[:held] + fits[held + 1:] or fits
        theta = which.coefficients(others, prior)[0][0]
        motion = [consistent(t) for t in gyro_turns.turns(session, model)]
        squares = []
        for effects in ([], closed_loop.specs(gap, theta, reference_c)):
            y = gyro_turns.calibrated([turned(t, effects) for t in motion])
            squares.append(float(((unit.z - unit.contrasts.T @ y) ** 2).sum()))
        before, after = before + squares[0], after + squares[1]
        floor += float(np.trace(unit.covariance(*unit.grid[gap.adequacy.index[held]])))
        number += len(unit.z)
    loop.before, loop.after, loop.floor = np.sqrt(np.array([before, after, floor]) / number)
    shown = before - floor
    loop.share = float((before - after) / shown) if shown > 0.1 * floor else None
    return loop


def consistent(turn):
    """The turn with the least constant rate taken off that makes it end as gravity says."""
    found = copy.copy(turn)
    axes = nominal_fit.lateral_basis(turn.before)
    for _ in range(ROUNDS):
        found.integrate()
        off = gyro_turns.observed(found, axes)
        constant = np.broadcast_to(np.eye(3), (len(found.dt), 3, 3))
        found.middle = found.middle - np.linalg.pinv(gyro_turns.projected(found, constant)) @ off
    return found


def turned(turn, effects):
    """The turn as a gyro with these effects (specs) reads it."""
    found = copy.copy(turn)
    m = Moment(np.exp, np.sin, np.floor, noise_arrays.gauss)
    m.w = tuple(turn.middle.T)
    if turn.temperature is not None:
        m.temperature = turn.temperature
    out = list(turn.middle.T.copy())
    for spec in effects:
        make_effect(spec).add(m, out)
    found.middle = np.stack(out, 1)
    return found.integrate()
