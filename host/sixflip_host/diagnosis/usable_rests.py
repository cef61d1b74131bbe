"""The second stage: the sessions whose rests in known poses can be judged, each with its nominal
sensor; what had to be left out of them is said."""
from dataclasses import dataclass

import numpy as np

from .. import progress
from ..experiment import attitude_fit, thermometer
from .detect import saturation

FEWEST_PLACEMENTS = 6  # an axis' bias and scale, and one more to tell an effect by


@dataclass(frozen=True, eq=False)
class UsableRests:
    """everything: all sessions, those that were changed as they are now; sessions: those that can
    be judged, each with its attitude_fit.NominalSensor in nominal (none: no rest can be);
    reference_c: their mean temperature; remarks."""

    everything: tuple
    sessions: tuple = ()
    nominal: tuple = ()
    reference_c: float = 25.0
    remarks: tuple = ()


def select(sessions, findings, stuck, scaled=False):
    """UsableRests of sessions; findings: of their samples; stuck: a column never changes; scaled:
    the accelerometer's full scale is not the one stated."""
    usable = _enough(sessions)
    if any(s.capture.accel is None for s in sessions):
        return UsableRests(tuple(sessions))
    contradicted = {s: s.contradicted() for s in usable}
    orders = [f for f in findings if f.effect == "axis_swap"]
    swapped = any(not f.files for f in orders)
    told = {name for f in orders for name in f.files}  # with a name: what gravity contradicts
    bad = [pair for s, pairs in contradicted.items() for pair in pairs if s.name not in told]
    remarks = []
    if bad and not swapped:
        remarks.append("labels that gravity contradicts: " + ", ".join(
            "%s (%.0f deg off)" % pair for pair in bad))
    if swapped or scaled or stuck or not usable:
        return UsableRests(tuple(sessions), remarks=tuple(remarks))
    changed = {s: s.without_poses([name for name, _ in pairs])
               for s, pairs in contradicted.items() if pairs}
    everything = [changed.get(s, s) for s in sessions]
    usable = _enough([changed.get(s, s) for s in usable])
    if not usable:
        return UsableRests(tuple(everything), remarks=tuple(remarks))
    temperatures = [s.temperature for s in usable if s.temperature is not None]
    reference_c = float(np.mean(np.concatenate(temperatures))) if temperatures else 25.0
    remarks += temperature_remarks(usable)
    if any(f.effect == "saturation" and f.sensor == "accel" for f in findings):
        # Rests that were cut off say nothing about the sensor but that.
        kept = {s: s.without_samples(saturation.railed(s)) for s in usable}
        lost = sum(s.placements() - fewer.placements() for s, fewer in kept.items())
        remarks += ["%d rests on a rail were left out" % lost] if lost else []
        everything = [kept.get(s, s) for s in everything]
        usable = _enough(kept.values())
    if not usable:
        return UsableRests(tuple(everything), (), (), reference_c, tuple(remarks))
    progress.doing("the nominal sensor")
    nominal = [attitude_fit.fit(s) for s in usable]
    return UsableRests(tuple(everything), tuple(usable), tuple(nominal), reference_c,
                       tuple(remarks))


def _enough(sessions):
    return [s for s in sessions if s.placements() >= FEWEST_PLACEMENTS and (
        s.labelled or s.accel is None or s.turned_over)]


def temperature_remarks(sessions):
    """Sentences on a temperature that is not there, or hardly changes."""
    if any(s.temperature is None for s in sessions):
        return ["no usable temperature column: effects of temperature cannot be looked for"]
    moved = thermometer.moved_c(sessions)
    return [] if moved >= 1.0 else [
        "the temperature moved by %.1f degC only: little can be said about it" % moved]
