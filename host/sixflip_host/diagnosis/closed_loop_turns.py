"""The loop closed for the gyro in motion: the real turns made again by the simulated gyro, with
the effects found and without, and the same figures of both (GAP stage 6, last sentence).

The motion is the real one: the rate as it was read, changed by the least constant rate that
makes each turn end where gravity says it did. The simulated gyro adds its effects to that.
"""
import numpy as np

from sixflip_sim.effects.library import make as make_effect
from sixflip_sim.effects.moment import Moment

from ..experiment import noise_arrays, turns
from . import closed_loop, coefficient_fits

ROUNDS = 3  # of a linear correction that is off by its square each time


def close(gap, reference_c):
    """Loop of the gyro in motion, each session by the others; None without causes
    that are made of rates (a dead band is made of counts)."""
    if not gap.chosen or any(form.effect == "dead_band" for form in gap.chosen):
        return None
    columns = np.concatenate([c.columns for c in gap.chosen])
    prior = np.concatenate([c.prior for c in gap.chosen])
    fits = coefficient_fits.fits(gap.data, columns, prior)
    loop = closed_loop.Loop()
    loop.effects = closed_loop.specs(
        gap, coefficient_fits.coefficients(fits, prior)[0][0], reference_c)
    before = after = floor = number = 0.0
    for held, unit in enumerate(gap.units):
        others = fits[:held] + fits[held + 1:] or fits
        theta = coefficient_fits.coefficients(others, prior)[0][0]
        motion = [consistent(t) for t in unit.turns]
        squares = []
        for effects in ([], closed_loop.specs(gap, theta, reference_c)):
            y, _ = turns.calibrated([turned(t, effects) for t in motion])
            squares.append(float(((unit.z - unit.contrasts(y)) ** 2).sum()))
        before, after = before + squares[0], after + squares[1]
        floor += float(unit.noise_energy(*unit.grid[gap.adequacy.index[held]]))
        number += unit.freedom
    loop.before, loop.after, loop.floor = np.sqrt(np.array([before, after, floor]) / number)
    shown = before - floor
    loop.share = float((before - after) / shown) if shown > 0.1 * floor else None
    return loop


def consistent(turn):
    """The turn with the least constant rate taken off that makes it end as gravity says."""
    constant = np.broadcast_to(np.eye(3), (len(turn.dt), 3, 3))
    turn = turn.integrated()
    for _ in range(ROUNDS):
        off = turns.observed(turn)
        turn = turn.read_as(turn.middle - np.linalg.pinv(turns.projected(turn, constant)) @ off)
    return turn


def turned(turn, effects):
    """The turn as a gyro with these effects (specs) reads it."""
    m = Moment(np.exp, np.sin, np.floor, noise_arrays.gauss)
    m.w = tuple(turn.middle.T)
    if turn.temperature is not None:
        m.temperature = turn.temperature
    out = list(turn.middle.T.copy())
    for spec in effects:
        make_effect(spec).add(m, out)
    return turn.read_as(np.stack(out, 1))
