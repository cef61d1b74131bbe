"""The second stage, which sessions have rests in known poses that can be judged, and what had to
be left out of them; and the third, what the rests, the turns between them and the moves say of
both sensors.
"""
import math
from dataclasses import dataclass, replace

import numpy as np

from .. import progress, side_by_side
from ..capture.registers import SENSORS
from ..experiment import attitude_fit, thermometer
from . import adequacy, localisation, motion_model, odds, stray_turns, turn_model
from .detect import saturation
from .detect.detection import RANGE, present
from .rest_model import RestModel

FEWEST_PLACEMENTS = 6  # an axis' bias and scale, and one more to tell an effect by
# Of the ends of turns, that is no matter of the gyro: 17 mg of an accelerometer that bends more
# than any does (typical.SIZES), without showing it in a few poses.
SCATTERED_DEG = 1.0
WIDE = 10.0  # times its lower end, that an interval reaches to which has no upper one


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

    def read_as(self, parts):
        """The same with other readings of the sessions, and attitudes by them: [(Session,
        NominalSensor)]."""
        sessions, nominal = zip(*parts)
        others = dict(zip(self.sessions, sessions))
        return replace(self, everything=tuple(others.get(s, s) for s in self.everything),
                       sessions=sessions, nominal=nominal)


def usable_rests(sessions, findings, stuck, scaled=False):
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


@dataclass(frozen=True, eq=False)
class RestsJudged:
    """gaps {sensor: SensorGap} at rest; turns: SensorGap of the gyro in motion or None; motion:
    MotionGap of the accelerometer or None; findings (of axes and in motion), nameless, remarks."""

    gaps: dict
    turns: object
    motion: object
    findings: tuple
    nameless: tuple
    remarks: tuple


def judge(rests, findings, settings, conditions):
    """RestsJudged of UsableRests; findings: of their samples. The turns and either sensor's rests
    go side by side where there are processors for it."""
    sessions, nominal = rests.sessions, rests.nominal
    chip = sessions[0].capture.meta["sensor"]
    swapped = turns = motion = turned = None
    accel, gyro = (RestModel(kind, chip, settings, conditions) for kind in ("accel", "gyro"))
    jobs = [lambda: accel.fit(sessions, nominal)]
    if all(s.gyro is not None for s in sessions):
        swapped = stray_turns.swapped(sessions, nominal)
        # The Earth's rate on the wrong axes looks like gravity in the gyro.
        upright = sessions if swapped is None else [
            s.with_gyro_axes(swapped.read) for s in sessions]
        jobs.append(lambda: gyro.fit(upright, nominal))
        turned = swapped is None and _turn(rests, findings)
        if turned:
            jobs.insert(0, lambda: _of_turns(rests, gyro))  # of two processors the gyro has one
    found = side_by_side.results(jobs, settings.processors)
    if turned:
        turns, motion = found.pop(0)
    gaps = dict(zip(("accel", "gyro"), found))
    if turned and gaps["accel"].posterior.best.forms:
        upright = rests.read_as(gaps["accel"].upright())
        if _leans(nominal, upright.nominal):
            turns, motion = _of_turns(upright, gyro)
    new_findings, nameless, remarks = [], [], []
    if swapped is not None and swapped.effect not in settings.without:
        new_findings.append(swapped)
    if turns:
        sound = not (gaps["accel"].causes or gaps["accel"].unexplained)
        astray = _astray(turns, sound)
        nameless += [place for place, _ in astray]
        remarks += [words for _, words in astray]
    carried = [*gaps.values(), *([turns] if turns else [])]
    if conditions.stale or conditions.hidden:
        motion = None
    elif motion and any(cause.domain == "orientation" for cause in gaps["accel"].causes):
        motion = motion.beside_a_bend()
    if motion and not any(gap.unexplained and not (
            gap is gaps["accel"] and gap.lasting
            or gap is gaps.get("gyro") and harmless(gap, motion)) for gap in carried):
        new_findings += motion.findings
        remarks += motion.remarks
        if not turns.posterior.best.forms:  # a gyro that bends carries gravity wrongly, too
            nameless += motion.nameless
    remarks += ["on which axes the %s has %s these captures do not tell" % (
        SENSORS[gap.kind], " or ".join(cause.names)) for gap in carried for cause in gap.causes
        if not cause.letters and set(cause.names) - {"box_tilt"}]
    if not conditions.coarse:
        said = [squareness.remark() for squareness in gaps["accel"].crooked if squareness]
        remarks += dict.fromkeys(sentence for sentence in said if sentence)
    return RestsJudged(gaps, turns, motion, tuple(new_findings), tuple(nameless), tuple(remarks))


def _leans(nominal, without):
    """Whether NominalSensors know gravity's direction worse than the turns take it to be known by
    what an accelerometer `without` that has not."""
    angles = [np.degrees(np.linalg.norm(a.up - b.up, axis=1)) for a, b in zip(nominal, without)]
    return bool(np.sqrt(np.mean(np.concatenate(angles) ** 2)) > turn_model.ATTITUDE_DEG)


def harmless(gap, motion):
    """Whether what is left of the gyro's rests turns the box by less in a move than its attitude
    at rest is known to; more would be carried into the moves. Where noise wanders, or the gap is
    too small to say how far it closes, that is not known."""
    held = gap.shrinkage
    if gap.wanders or not (held and held.interval and motion.seen):
        return False
    left = math.sqrt(max(held.after ** 2 - held.floor ** 2, 0.0))
    return left * float(np.median([m.seconds for m in motion.fit.moves])) < turn_model.ATTITUDE_DEG


def unsized(finding):
    """Whether a Finding is of a dead band of which the rests say no more than how wide it is at
    least: the turns may tell its width."""
    return finding.effect == "dead_band" and finding.sensor == "gyro" and all(
        high > WIDE * low for low, high in finding.interval.values())


def _turn(rests, findings):
    """True when the gyro of UsableRests tells how they turn from one to the next. Moves with a
    sample at the end of a range that is known are no turns anyhow; else nobody knows where it
    bends. An accelerometer with a dead band knows no direction of gravity."""
    bent = any(f.effect == "dead_band" and f.sensor == "accel" or f.sensor == "gyro" and f.effect
               in ("dead_band", "saturation") and not unsized(f)
               and (f.levels or set(f.limits.values()) != {RANGE}) for f in findings)
    return not bent and all(
        turn_model.usable(s, m) for s, m in zip(rests.sessions, rests.nominal))


def _of_turns(rests, gyro):
    """(SensorGap of the gyro's turns, MotionGap or None of the moves that it carries gravity
    through) of UsableRests; gyro: its RestModel."""
    turns = turn_model.TurnModel("gyro", gyro.chip, gyro.settings, gyro.conditions).fit(
        rests.sessions, rests.nominal)
    progress.doing("what moves between the rests show")
    return turns, motion_model.motion_gap(
        rests.everything, rests.sessions, rests.nominal, turns, gyro.settings)


def _astray(turns, sound):
    """[(Place, sentence)] of turns that end far from where gravity says: samples lost under a
    steady clock; sound: the accelerometer says rightly where gravity is."""
    nats, number = stray_turns.nats([stray_turns.ends(
        unit, turns.chosen, turn_model.ATTITUDE_DEG) for unit in turns.units
        if not unit.between])
    scattered = adequacy.placement_nats(turns.units, turns.data.statistics, turns.posterior.best,
                                        SCATTERED_DEG)
    if sound and present(scattered):
        degrees = max(u.grid[k][0] for u, k in zip(turns.units, turns.adequacy.index)
                      if not u.between)
        return [(localisation.Place("gyro", None, "motion", 1.0, odds.chance(scattered)),
                 "the turns end about %.1f deg from where gravity says, each by itself: samples "
                 "may be lost although their times are steady" % degrees)]
    if not present(nats):
        return []
    return [(localisation.Place("gyro", None, "motion", 1.0, odds.chance(nats)),
             "about %.0f turns end far from where gravity says, the others do not: samples may be "
             "lost although their times are steady" % number)]
