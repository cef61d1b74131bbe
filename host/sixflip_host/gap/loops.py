"""The simulator run again with what was found: every sensor, at rest and in motion."""
from .. import progress
from . import closed_loop, closed_loop_motion, closed_loop_turns


def of(found, named=()):
    """{"accel", "gyro", "gyro_turns", "accel_motion": closed_loop.Loop} of a Diagnosis, those
    that have something to add; named: effects that are added whether they were found or not."""
    loops = {}
    for kind, gap in found.gaps.items():
        progress.doing("the simulator again, with what was found")
        mine = [n for n in named if n in {o.effect for o in gap.options}]
        for name in mine[:-1]:
            closed_loop.force(gap, name)
        loops[kind] = closed_loop.close(found, kind, mine[-1] if mine else None)
    if found.turns:
        for name in named:
            closed_loop.force(found.turns, name)
        loops["gyro_turns"] = closed_loop_turns.close(found.turns, found.settings.reference_c)
    if found.motion:
        for name in named:
            found.motion.force(name)
        loops["accel_motion"] = closed_loop_motion.close(found.motion)
    return {kind: loop for kind, loop in loops.items() if loop}
