"""All stages over all captures, from top to bottom: samples, rests, turns and moves, verdict."""
from dataclasses import dataclass
from functools import cached_property

from .. import progress
from ..capture import registers
from ..experiment import blocks, terms
from ..planning import detectable
from . import (
    localisation,
    mimicry,
    odds,
    rest_gap,
    rest_noise,
    rests_judged,
    samples_judged,
    stray_turns,
)
from .detect import sample_clock, shake_detector
from .settings import Conditions, Settings
from .simulator import simulator_answer

LEAST_S = 5.0  # of a capture that can be said to show no gap


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """sessions, Settings, Conditions; clocks: one SampleClock or None a session; findings (tuple
    of Finding); gaps {sensor: SensorGap} of rests in poses, rest {sensor: RestGap} of captures
    without poses, turns (SensorGap of the gyro in motion or None), motion (MotionGap of the
    accelerometer or None); nameless (tuple of Place): beside those in the gaps; broken: nothing
    can be said of the rests; remarks (list of sentences); comparisons: simulator.comparison.
    Comparison of each log of the user's own simulator; damages: tuple of Damage, those put
    right before among them; noise: {sensor: rest_noise.RestNoise} of rests without poses."""

    sessions: tuple
    settings: Settings
    conditions: Conditions
    clocks: tuple
    findings: tuple
    gaps: dict
    rest: dict
    turns: object
    motion: object
    nameless: tuple
    broken: bool
    remarks: list
    comparisons: tuple
    damages: tuple
    noise: dict

    @property
    def causes(self):
        """[(sensor, Cause)] of all sensors, the largest score first."""
        causes = [(kind, c) for gaps in (self.gaps, self.rest) for kind, gap in gaps.items()
                  for c in gap.causes]
        if self.turns:
            causes += [("gyro", c) for c in self.turns.causes]
        return sorted(causes, key=lambda pair: -pair[1].score)

    @property
    def judged(self):
        """[SensorGap] of rests in poses and of turns."""
        return [*self.gaps.values(), *([self.turns] if self.turns else [])]

    @cached_property
    def where(self):
        """[Place]: what the samples show, then the rests and the turns; of no gap nothing, also
        where logs of one motion show in both what each by itself would be taken for."""
        if self.verdict == "no gap":
            return []
        named = [localisation.Place(f.sensor, axis, f.domain, 1.0 if f.share is None else f.share,
                                    odds.chance(f.score))
                 for f in self.findings for axis in (f.axes or [None])]
        places = [p for gap in self.judged for p in localisation.places(gap)]
        places += [p for gap in self.rest.values() for p in gap.places]
        return named + sorted([*places, *self._left, *self.nameless], key=localisation.order)

    @cached_property
    def verdict(self):
        """One of the verdict's rows, on what was found in rests, turns, moves and samples."""
        claims = self._claims()
        row = odds.decide(claims, [*self._nameless(), float(self.broken)], self.sees())
        return simulator_answer.verdict(row, self.comparisons, odds.any_of(
            [c.probability for c in claims]) > odds.LIKELY) if self.comparisons else row

    def _claims(self):
        claims = [odds.Claim(f.named, told([f.effect, *f.rivals], f.share) and self._sized(f),
                             f.nameless) for f in self.findings if f.plausible]
        claims += [odds.Claim(sum(c.probabilities.values()), told(c.names, c.share) and bool(
            c.effect == "drift" or gap.shrinkage.interval), c.nameless)
            for gap in [*self.judged, *self.rest.values()] for c in gap.causes if c.plausible]
        return claims + [odds.Claim(g.posterior.places["drift"]["drift"], True)
                         for g in self.gaps.values() if g.drift]

    @cached_property
    def outside(self):
        """Probability that something is there which no name of the library stands for."""
        return odds.any_of(self._nameless())

    def of_name(self, sensor, probability, names, share):
        """Probability of a cause of a sensor, found among all hypotheses to explain this share,
        less that of what only looks like it."""
        gap = self.gaps.get(sensor)
        return gap.of_name(probability, names, share, self.outside) if gap else odds.of_name(
            probability, mimicry.MIMICKED, self.outside)

    def _sized(self, finding):
        """Whether the interval of a Finding's share is known; in motion, that of the gap."""
        if finding.domain != "motion":
            return finding.share_interval is not None
        return bool(self.motion and self.motion.shrinkage and self.motion.shrinkage.interval)

    def _nameless(self):
        """Probabilities that something without a name is there."""
        gaps = [*self.judged, *self.rest.values()]
        probabilities = [p for g in self.judged for p in odds.of_gap(g)]
        probabilities += [odds.not_closed(g.shrinkage and g.shrinkage.interval) for g in gaps]
        probabilities += [p for gap in self.rest.values() for p in gap.nameless]
        probabilities += [1.0 - place.p for place in [*self.nameless, *self._left]]
        # A size that no part has is a name for something else.
        probabilities += [f.named for f in self.findings if not f.plausible]
        return probabilities + [c.place.get(c.effect, 0.0) for _, c in self.causes
                                if not c.plausible]

    @cached_property
    def _left(self):
        """[Place] of what departs in the samples beside what a Finding accounts for; in motion it
        is the moves' own."""
        left = [(f, odds.not_closed(f.share_interval)) for f in self.findings
                if f.domain != "motion"]
        return [localisation.Place(f.sensor, None, f.domain, 1.0 - f.share, 1.0 - probability)
                for f, probability in left if probability]

    def sees(self):
        """True when the capture would have shown most of what it is asked about."""
        if not self.gaps:
            return any(s.runs and s.t_s[-1] >= LEAST_S for s in self.sessions)
        return detectable.visible_share(self) > 0.5


def diagnose_sessions(sessions, settings=None, simulator=None, comparisons=(), damages=(),
                      beside=False):
    """Diagnosis of blocks.Sessions; simulator: against_simulator.Simulator or None, what is in it
    as well is left out; comparisons: of the logs with its own; damages: what was put right in the
    captures before; beside: these or others are held against a simulator, or are one's own."""
    settings = settings or Settings()
    sessions, remarks = accepted(sessions)
    if not beside and not comparisons:
        # Beside a simulator the rests are those of both, which each finds in the same way.
        sessions = [blocks.with_whole_rests(session) for session in sessions]
    clocks = sample_clock.clocks(sessions)
    remarks += sample_clock.remarks(sessions, clocks)
    progress.doing("registers, clock and spectra")
    stuck = registers.stuck(sessions)
    samples = samples_judged.judge(sessions, settings, damages)
    sessions = samples.sessions
    remarks += [*stuck, *samples.remarks]
    findings, nameless = list(samples.findings), list(samples.nameless)
    rests = rests_judged.usable_rests(sessions, findings, stuck, samples.scaled)
    remarks += rests.remarks
    conditions = samples.conditions(rests.reference_c)
    gaps, rest, turns, motion, noise = {}, {}, None, None, {}
    if rests.nominal:
        judged = rests_judged.judge(rests, findings, settings, conditions)
        gaps, turns, motion = judged.gaps, judged.turns, judged.motion
        if turns and any(cause.effect == "dead_band" for cause in turns.causes):
            findings = [f for f in findings if not rests_judged.unsized(f)]
        findings += judged.findings
        nameless += judged.nameless
        remarks += judged.remarks
    else:
        noise = rest_noise.noise_by_sensor(sessions)
        progress.doing("the longest rest")
        # Beside a simulator what a robot does by itself is motion: it shakes on its way, and
        # settles in its rests, which a short one is full of.
        moving = (beside or bool(comparisons)) and any(len(s.runs) > 1 for s in sessions)
        rest = rest_gap.gaps_by_sensor(sessions, settings, [
            (f.sensor, "xyz".index(key), hz) for f in findings for key, hz in f.hz.items()],
            rest_gap.SETTLES_S if moving else 0.0,
            {(place.sensor, place.axis) for place in nameless if place.domain == "frequency"})
        if moving and not rest:
            remarks.append("no rest of %g s: a robot that settles is not told from sensors that "
                           "drift" % rest_gap.SETTLES_S)
        # Beside an accelerometer whose axes are swapped the gyro's seem to be.
        swapped = any(f.effect == "axis_swap" for f in findings)
        if not (beside or comparisons or swapped or "axis_swap" in settings.without):
            findings += stray_turns.swapped_on_the_way(sessions)
        if not any(s.runs for s in sessions):
            remarks.append("no rest found: only what shows in motion can be judged")
        if not moving and not any(
                f.effect == "vibration" and f.sensor == "accel" for f in findings):
            findings += [f for f in shake_detector.findings(sessions)
                         if f.effect not in settings.without]
    compared_in_motion = any(comparison.motion_judged for comparison in comparisons)
    lacking = {"filter_lag"} if any(comparison.lacks_delay for comparison in comparisons) else ()
    if simulator:
        remarks += simulator.remarks
        remarks += ["the simulator has %s (%s), the real sensor does not" % (f.effect, f.sensor)
                    for f in simulator.only_simulated(findings, sessions, motion is not None
                                                      and not compared_in_motion)]
        remarks += ["the real sensor has %s (%s); the simulator's log does not show whether it "
                    "has it, too" % (f.effect, f.sensor)
                    for f in findings if not (compared_in_motion or simulator.shows(f))]
        findings = [simulator.lacks(f, sessions) for f in findings if f.effect in lacking
                    or simulator.shows(f) and simulator.new(f, sessions)]
        nameless = [place for place in nameless if not simulator.has_tone(sessions, place)]
    if comparisons:
        # Where readings are cut off is a range, which the parameters of both logs compare.
        findings = [f for f in findings if f.effect != "saturation"]
        # What all readings are too large by is a scale, which is no gap where both share it.
        scaled = {p.sensor for c in comparisons for p in c.parameters if p.name == "scale"}
        nameless = [place for place in nameless if not (
            place.sensor in scaled and place in samples.of_scales)]
    if compared_in_motion:
        # The two logs were compared in motion: what the hand or both do is no gap.
        findings = [f for f in findings if f.domain != "motion" or f.effect in lacking]
        nameless = [place for place in nameless if place.domain != "motion"]
    remarks += ["the %s: %s" % (registers.SENSORS[f.sensor], f.words)
                for f in findings if f.effect in ("vibration", "axis_swap")]
    return Diagnosis(rests.everything, settings, conditions, tuple(clocks), tuple(findings), gaps,
                     rest, turns, motion, tuple(nameless), bool(stuck), remarks,
                     tuple(comparisons), samples.damages, noise)


def accepted(sessions):
    """(sessions of one chip, each once; sentences on what was left out or assumed)."""
    sessions, others = blocks.same_chip(sessions)
    sessions, repeated = blocks.distinct(sessions)
    remarks = ["%s is of another sensor (%s) and was left out" % (
        s.name, s.capture.meta["sensor"]) for s in others]
    remarks += ["%s repeats a capture before it and was left out" % s.name for s in repeated]
    remarks += ["%s: its timestamps stand still, rate_hz was used instead" % s.name
                for s in sessions if s.timeless]
    return sessions, remarks + [said for s in sessions for said in s.capture.assumed]


def told(names, share):
    """True when all effects of a class show themselves in the same way, so that it is known
    where it comes from, if not its name, and how much of the gap it accounts for."""
    return share is not None and len({terms.DOMAIN[n] for n in names}) == 1
