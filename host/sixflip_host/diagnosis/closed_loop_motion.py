"""The loop closed for what shows in motion: the real moves felt again by the simulated sensor,
with the effects found and without (GAP stage 6, last sentence).

The motion is the real one, as the gyro and gravity at both ends say. What is compared are the
frequencies of each move; the hand's own acceleration is in the difference, before and after.
"""
import numpy as np

from sixflip_sim.effects.library import EFFECTS
from sixflip_sim.effects.library import make as make_effect

from ..experiment import inertial_fit
from . import closed_loop, moves_fit


def close(gap):
    """Loop of a MotionGap, each fold by the sizes of the others; None where nothing is found."""
    if gap is None or not gap.found:
        return None
    loop = closed_loop.Loop()
    loop.effects = specs(gap, gap.sizes)
    made = [added(m, specs(gap, gap.held.by_others[f]))
            for m, f in zip(gap.fit.moves, gap.held.folds)]
    loop.before = gap.fit.rms(gap.bare)
    loop.after = gap.fit.rms([real - simulated for real, simulated in zip(gap.bare, made)])
    loop.floor = gap.floor()
    shown = loop.before ** 2 - loop.floor ** 2
    loop.share = (loop.before ** 2 - loop.after ** 2) / shown if shown > 0.0 else None
    return loop


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
