"""The simulator run again with what was found: every sensor, at rest (closed_loop.py) and in
motion (GAP stage 6, last sentence).

The motion is the real one. Of the gyro's turns it is the rate as it was read, changed by the least
constant rate that makes each turn end where gravity says it did; the simulated gyro adds its
effects to that. Of the moves it is what the gyro and gravity at both ends say; what is compared
are the frequencies of each move, and the hand's own acceleration is in the difference, before and
after.
"""
import numpy as np

from sixflip_sim.effects.library import EFFECTS
from sixflip_sim.effects.library import make as make_effect

from .. import progress
from ..experiment import inertial_fit, noise_arrays, turns
from . import closed_loop, moves_fit
from .closed_loop import Loop

ROUNDS = 3  # of a linear correction that is off by its square each time


def of(found, named=()):
    """{"accel", "gyro", "gyro_turns", "accel_motion": closed_loop.Loop} of a Diagnosis, those
    that have something to add; named: effects that are added whether they were found or not."""
    loops, reference_c = {}, found.conditions.reference_c
    for kind, gap in found.gaps.items():
        progress.doing("the simulator again, with what was found")
        loops[kind] = closed_loop.close(_with(gap, named), reference_c)
    if found.turns:
        loops["gyro_turns"] = of_turns(_with(found.turns, named), reference_c)
    if found.motion:
        loops["accel_motion"] = of_moves(_with(found.motion, named))
    return {kind: loop for kind, loop in loops.items() if loop}


def _with(gap, named):
    """A gap with these effects among those that it found."""
    for name in named:
        gap = gap.with_effect(name)
    return gap


def of_turns(gap, reference_c):
    """Loop of the gyro in motion, each session by the others; None without causes
    that are made of rates (a dead band is made of counts)."""
    if not gap.chosen or any(form.effect == "dead_band" for form in gap.chosen):
        return None
    before = after = floor = number = 0.0
    for held, unit in enumerate(gap.units):
        theta = gap.coefficients(held)
        motion = [consistent(t) for t in unit.turns]
        squares = []
        for effects in ([], closed_loop.specs(gap, theta, reference_c)):
            y, _ = turns.calibrated([turned(t, effects) for t in motion])
            squares.append(float(((unit.z - unit.contrasts(y)) ** 2).sum()))
        before, after = before + squares[0], after + squares[1]
        floor += float(unit.noise_energy(*unit.grid[gap.adequacy.index[held]]))
        number += unit.freedom
    shown = before - floor
    return Loop(*(float(np.sqrt(v / number)) for v in (before, after, floor)),
                float((before - after) / shown) if shown > 0.1 * floor else None,
                closed_loop.specs(gap, gap.coefficients(), reference_c))


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
    m = noise_arrays.moment()
    m.w = tuple(turn.middle.T)
    if turn.temperature is not None:
        m.temperature = turn.temperature
    out = list(turn.middle.T.copy())
    for spec in effects:
        make_effect(spec).add(m, out)
    return turn.read_as(np.stack(out, 1))


def of_moves(gap):
    """Loop of a MotionGap, each fold by the sizes of the others; None where nothing is found."""
    if gap is None or not gap.found:
        return None
    made = [added(m, specs(gap, gap.held.by_others[f]))
            for m, f in zip(gap.fit.moves, gap.held.folds)]
    before = gap.fit.rms(gap.bare)
    after = gap.fit.rms([real - simulated for real, simulated in zip(gap.bare, made)])
    floor = gap.floor()
    shown = before ** 2 - floor ** 2
    return Loop(before, after, floor, (before ** 2 - after ** 2) / shown if shown > 0.0 else None,
                specs(gap, gap.sizes))


def specs(gap, sizes):
    """[{effect, sensor, key: size}] of the effects found, with these sizes (4,)."""
    out = []
    for name in [f.effect for f in gap.found]:
        values = sizes[moves_fit.EFFECTS[name]]
        if name == "filter_lag":
            sensor = "accel" if values[0] > 0.0 else "gyro"
            values = np.abs(values)
        else:
            sensor = "accel"
        top = EFFECTS[name].largest[sensor]
        out.append({"effect": name, "sensor": sensor,
                    **{k: float("%.4g" % np.clip(v, -top, top))
                       for k, v in zip(EFFECTS[name].keys, values)}})
    return out


def added(move, effects):
    """(n, 3) mg: how far the simulated sensors with these effects (specs) are off in a move."""
    moment = inertial_fit.moment(move.turn)
    felt = np.stack(moment.f, 1)
    out, late = (list(np.zeros((3, len(felt)))) for _ in range(2))
    for spec in effects:
        make_effect(spec).add(moment, out if spec["sensor"] == "accel" else late)
    out, late = np.stack(out, 1), np.stack(late, 1)
    if late.any():  # the motion was the one that such a gyro reads as it was read
        turn = move.turn.read_as(move.turn.middle - 0.5 * (late[1:] + late[:-1]))
        body = inertial_fit.pinned(turn)
        out = out + 1000.0 * (np.einsum("nji,j->ni", body, turn.before) - felt)
    return inertial_fit.Seen.of_turn(move.turn).of(out[:, :, None])[:, :, 0]
