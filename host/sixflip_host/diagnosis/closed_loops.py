"""The simulator run again with what was found: every sensor, at rest and in motion."""
from .. import progress
from . import closed_loop, closed_loop_motion, closed_loop_turns


def of(found, named=()):
    """{"accel", "gyro", "gyro_turns", "accel_motion": closed_loop.Loop} of a Diagnosis, those
    that have something to add; named: effects that are added whether they were found or not."""
    loops = {}
    for kind, gap in found.gaps.items():
        progress.doing("the simulator again, with what was found")
        loops[kind] = closed_loop.close(_with(gap, named), found.conditions.reference_c)
    if found.turns:
        loops["gyro_turns"] = closed_loop_turns.close(_with(found.turns, named),
                                                      found.conditions.reference_c)
    if found.motion:
        loops["accel_motion"] = closed_loop_motion.close(_with(found.motion, named))
    return {kind: loop for kind, loop in loops.items() if loop}


def _with(gap, named):
    """A gap with these effects among those that it found."""
    for name in named:
        gap = gap.with_effect(name)
    return gap
