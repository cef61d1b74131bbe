"""The third stage: what the rests, the turns between them and the moves say of both sensors."""
import math
from dataclasses import dataclass

import numpy as np

from .. import progress, side_by_side
from ..capture.registers import SENSORS
from . import adequacy, localisation, motion_model, odds, stray_turns, turn_model
from .detect.detection import present
from .rest_model import RestModel

# Of the ends of turns, that is no matter of the gyro: 17 mg of an accelerometer that bends more
# than any does (typical.SIZES), without showing it in a few poses.
SCATTERED_DEG = 1.0
WIDE = 10.0  # times its lower end, that an interval reaches to which has no upper one


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
            gap is gaps.get("gyro") and harmless(gap, motion)) for gap in carried):
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
    """True when the gyro of UsableRests tells how they turn from one to the next."""
    bent = any(f.sensor == "gyro" and f.effect in ("dead_band", "saturation") and not unsized(f)
               for f in findings)
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
