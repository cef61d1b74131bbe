"""The simulator run again with what was found: every sensor, at rest (closed_loop.py) and in
motion (GAP stage 6, last sentence).

The motion is the real one. Of the gyro's turns it is the rate as it was read, changed by the least
constant rate that makes each turn end where gravity says it did; the simulated gyro adds its
effects to that. Of the moves it is what the gyro and gravity at both ends say; what is compared
are the frequencies of each move, and the hand's own acceleration is in the difference, before and
after. What was found is also written as a scenario file for `sixflip simulate`, and its plan.
"""
import json
import math
from pathlib import Path

import numpy as np

from sixflip.chips.catalogue import SENSORS
from sixflip.poses import faces
from sixflip_sim.effects.library import EFFECTS
from sixflip_sim.effects.library import make as make_effect

from .. import atomic_write, progress
from ..experiment import inertial_fit, noise_arrays, turns
from ..planning import plan_file, protocols
from . import closed_loop, moves_fit
from .closed_loop import Loop

ROUNDS = 3  # of a linear correction that is off by its square each time


def close_all(diagnosis, named=()):
    """{"accel", "gyro", "gyro_turns", "accel_motion": closed_loop.Loop} of a Diagnosis, those
    that have something to add; named: effects that are added whether they were found or not."""
    loops, reference_c = {}, diagnosis.conditions.reference_c
    for kind, gap in diagnosis.gaps.items():
        progress.doing("the simulator again, with what was found")
        loops[kind] = closed_loop.close(_with(gap, named), reference_c)
    if diagnosis.turns:
        loops["gyro_turns"] = close_turns(_with(diagnosis.turns, named), reference_c)
    if diagnosis.motion:
        loops["accel_motion"] = close_moves(_with(diagnosis.motion, named))
    return {kind: loop for kind, loop in loops.items() if loop}


def _with(gap, named):
    """A gap with these effects among those that it found."""
    for name in named:
        gap = gap.with_effect(name)
    return gap


def close_turns(gap, reference_c):
    """Loop of the gyro in motion, each session by the others; None without causes
    that are made of rates (a dead band is made of counts)."""
    if not gap.chosen or any(form.effect == "dead_band" for form in gap.chosen):
        return None
    before = after = floor = number = 0.0
    for held, unit in enumerate(gap.units[:len(gap.parts)]):
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
    rates = list(turn.middle.T.copy())
    for spec in effects:
        make_effect(spec).add(m, rates)
    return turn.read_as(np.stack(rates, 1))


def close_moves(gap):
    """Loop of a MotionGap, each fold by the sizes of the others; None where nothing is found."""
    if gap is None or not gap.findings:
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
    effects = []
    for name in [f.effect for f in gap.findings]:
        values = sizes[moves_fit.EFFECTS[name]]
        if name == "filter_lag":
            sensor = "accel" if values[0] > 0.0 else "gyro"
            values = np.abs(values)
        else:
            sensor = "accel"
        top = EFFECTS[name].largest[sensor]
        effects.append({"effect": name, "sensor": sensor,
                        **{k: float("%.4g" % np.clip(v, -top, top))
                           for k, v in zip(EFFECTS[name].keys, values)}})
    return effects


def added(move, effects):
    """(n, 3) mg: how far the simulated sensors with these effects (specs) are off in a move."""
    body, felt, rate = inertial_fit.carried(move.turn)
    moment = inertial_fit.moment(move.turn, felt, rate)
    accel, late = (list(np.zeros((3, len(felt)))) for _ in range(2))
    for spec in effects:
        make_effect(spec).add(moment, accel if spec["sensor"] == "accel" else late)
    accel, late = np.stack(accel, 1), np.stack(late, 1)
    if late.any():  # the motion was the one that such a gyro reads as it was read
        turn = move.turn.read_as(move.turn.middle - 0.5 * (late[1:] + late[:-1]))
        there = inertial_fit.pinned(turn)
        accel = accel + 1000.0 * (np.einsum("nji,j->ni", there, turn.before) - felt)
    return inertial_fit.Seen.of_turn(move.turn, body, rate).spectrum(accel[:, :, None])[:, :, 0]


def plan_of(session):
    """SessionPlan of a captured session: its poses, their times and its temperature."""
    rests = []
    for place, (code, first, end) in enumerate(session.runs):
        start = session.runs[place - 1][2] if place else 0
        dwell = max(0.5, round((end - first) / session.rate, 2))
        move = max(0.1, round((first - start) / session.rate, 2))
        name = faces.pose_name(code)
        mean = session.capture.accel[first:end].mean(axis=0)
        up = mean / max(np.linalg.norm(mean), 1e-9)
        timing = {"dwell_s": dwell, "move_s": move}
        rests.append(protocols.face_rest(code, **timing) if code <= 12
                     else protocols.Rest(name, tuple(up.tolist()), **timing))
    end_c, change, tau = closed_loop.cooling(session)
    return protocols.SessionPlan(rests, "measured", round(end_c - change, 2), round(change, 2),
                                 tau)


def plan_beside(path):
    """Where the plan of a scenario file is."""
    return Path(path).with_suffix(".plan.json")


def write_scenario(path, diagnosis, effects):
    """Write PATH (TOML) and beside it the plan it names; returns both paths."""
    path = Path(path)
    sessions = next(iter(diagnosis.gaps.values())).sessions
    plan = plan_beside(path)
    plan_file.write(str(plan), protocols.Protocol("measured", [plan_of(s) for s in sessions]))
    first = sessions[0]
    sensor = first.capture.meta["sensor"]
    lines = ["# The nominal simulator with the effects that `sixflip diagnose` found.",
             "sensor = %s" % json.dumps(sensor if sensor in SENSORS else "mpu6050"),
             "plan = %s" % json.dumps(str(plan)), "rate_hz = %g" % first.rate, "", "[world]",
             "accel_noise_mg = %.4g" % (float(first.noise_accel.mean()) * math.sqrt(first.rate))]
    if first.gyro is not None:
        lines.append("gyro_noise_dps = %.4g" % (float(first.noise_gyro.mean())
                                                * math.sqrt(first.rate)))
    for spec in effects:
        lines += ["", "[[effects]]"]
        lines += ["%s = %s" % (key, json.dumps(value)) for key, value in spec.items()]
    atomic_write.write_text(str(path), "\n".join(lines) + "\n")
    return path, plan
