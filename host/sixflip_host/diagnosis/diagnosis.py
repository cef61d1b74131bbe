"""All stages over all captures: the order in which they are asked, and the verdict."""
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from .. import progress
from ..capture import registers
from ..experiment import attitude_fit, blocks, terms
from . import localisation, motion_model, odds, rest_gap, rest_noise, turn_model, verdict
from .detect import (
    codes,
    held_values,
    integrity,
    noise_bursts,
    sample_clock,
    saturation,
    shake_detector,
    spectral_lines,
    torn_reads,
    wrong_scale,
)
from .detect.detection import present
from .rest_model import RestModel
from .simulator import simulator_answer

FEWEST_PLACEMENTS = 6
COARSE = ("quantisation", "dead_band", "saturation", "torn_reads")
NOISY = ("vibration", "torn_reads", "saturation")  # what makes some seconds louder
SENSOR = {"accel": "accelerometer"}
SCALES = ("full_scale", "gravity")  # damages that every reading of a sensor has
LEAST_S = 5.0  # of a capture that can be said to show no gap


class Settings:
    """certified: the box is square; without: effects left out of the library; reference: {sensor:
    flicker level of a noise capture}; reference_c: temperature that slopes are taken about;
    simulated: {sensor: [(effect, variant, key, coefficient)]} that the simulator has already;
    jobs: threads."""

    def __init__(self, certified=False, without=(), reference=None, jobs=0):
        self.certified, self.without = certified, set(without)
        self.reference = reference or {}
        self.reference_c = 25.0
        self.simulated = {}
        self.jobs = jobs or os.cpu_count() or 1
        self.coarse = False  # registers move what is read near zero
        self.shaken = {}  # {sensor: axes (0..2) that a line of the spectrum is on}


class Diagnosis:
    """sessions, findings (list of Finding), gaps {sensor: SensorGap}, rest {sensor: RestGap} of
    captures without poses, turns (SensorGap of the gyro in motion or None), motion (MotionGap of
    the accelerometer or None), where (list of Place), verdict, remarks (sentences); comparisons:
    simulator.comparison.Comparison of each log of the user's own simulator; damages: list of
    damage.Damage, those put right before given; noise: {sensor: rest_noise.RestNoise}
    of rests without poses."""

    def __init__(self, sessions, settings, simulator=None, comparisons=(), damages=()):
        sessions, others = blocks.same_chip(sessions)
        sessions, again = blocks.distinct(sessions)
        self.sessions, self.settings = sessions, settings
        self.remarks, self.gaps, self.rest, self.turns = [], {}, {}, None
        self.motion = None
        self.remarks += ["%s is of another sensor (%s) and was left out" % (
            s.name, s.capture.meta["sensor"]) for s in others]
        self.remarks += ["%s repeats a capture before it and was left out" % s.name
                         for s in again]
        self.remarks += ["%s: its timestamps stand still, rate_hz was used instead" % s.name
                         for s in sessions if s.timeless]
        self.remarks += [said for s in sessions for said in s.capture.assumed]
        self.clocks = sample_clock.clocks(sessions)
        self.remarks += sample_clock.remarks(sessions, self.clocks)
        progress.doing("registers, clock and spectra")
        self.stuck = registers.stuck(sessions)
        self.remarks += self.stuck
        self.findings = [f for f in integrity.findings(sessions)
                         + spectral_lines.findings(sessions) if f.effect not in settings.without]
        self.damages = [*damages, *held_values.findings(sessions),
                        *wrong_scale.findings(sessions)]
        self.remarks += [one.words for one in self.damages]
        self._noise(sessions)
        settings.shaken = {f.sensor: ["xyz".index(a) for a in f.axes] for f in self.findings
                           if f.effect == "vibration"}
        settings.coarse = any(f.sensor == "accel" and f.effect in COARSE for f in self.findings)
        self._poses()
        self.noise = {} if self.gaps else rest_noise.of(sessions)
        if not self.gaps:
            progress.doing("the longest rest")
            self.rest = rest_gap.of(sessions, settings, [
                (f.sensor, "xyz".index(key), hz) for f in self.findings
                for key, hz in f.hz.items()])
            if not any(s.runs for s in sessions):
                self.remarks.append("no rest found: only what shows in motion can be judged")
            if not any(f.effect == "vibration" and f.sensor == "accel" for f in self.findings):
                self.findings += [f for f in shake_detector.findings(sessions)
                                  if f.effect not in settings.without]
        if simulator:
            self._compared(simulator)
        if any(x.motion_judged for x in comparisons):
            # The two logs were compared in motion: what the hand or both do is no gap.
            self.findings = [f for f in self.findings if f.domain != "motion"]
        self.remarks += ["the %s: %s" % (SENSOR.get(f.sensor, f.sensor), f.words)
                         for f in self.findings if f.effect == "vibration"]
        self.where = [localisation.Place(f.sensor, axis, f.domain, 1.0,
                                         odds.chance(f.score))
                      for f in self.findings for axis in (f.axes or [None])]
        places = [p for gap in [*self.gaps.values(), *([self.turns] if self.turns else [])]
                  for p in localisation.places(gap)]
        places += [p for gap in self.rest.values() for p in gap.places]
        self.where += sorted(places + self.nameless, key=localisation.order)
        self.comparisons = tuple(comparisons)
        self.verdict = self._verdict()
        if self.comparisons:
            self.verdict = simulator_answer.verdict(self.verdict, self.comparisons)

    def _noise(self, sessions):
        """Noise that comes in bursts and bits that stick: where, without a name."""
        named = {f.sensor for f in self.findings if f.effect in NOISY}
        bursts = [b for b in noise_bursts.found(sessions) if b[0] not in named]
        bits = registers.stuck_bits(sessions)
        self.remarks += ["bit %d of the %s axis of the %s always reads %d"
                         % (bit, axis, "gyro" if sensor == "gyro" else "accelerometer", value)
                         for sensor, axis, bit, value in bits]
        bursts += torn_reads.jumps(sessions, {f.sensor for f in self.findings
                                              if f.effect in ("torn_reads", "dead_band")})
        self.remarks += [words for _, words, _ in bursts]
        self.nameless = [localisation.Place(sensor, None, "noise", 1.0, p)
                         for sensor, _, p in bursts]
        self.nameless += [localisation.Place(one.sensor, axis, one.domain, 1.0,
                                             odds.chance(one.score))
                          for one in self.damages for axis in one.axes or (None,)]
        self.nameless += [localisation.Place(sensor, axis, "amplitude", 1.0, odds.chance(
            codes.bit_nats([getattr(s.capture, sensor)[:, "xyz".index(axis)] for s in sessions])))
            for sensor, axis, _, _ in bits]

    def _compared(self, simulator):
        """Leave out what the simulator has as well; add what only it has."""
        self.remarks += simulator.remarks
        self.remarks += ["the simulator has %s (%s), the real sensor does not"
                         % (f.effect, f.sensor) for f in simulator.only_simulated(self.findings)]
        self.findings = [f for f in self.findings if simulator.new(f)]

    def _poses(self):
        """The rests of sessions with poses, if any has enough of them."""
        usable = [s for s in self.sessions if s.placements() >= FEWEST_PLACEMENTS]
        if not usable or any(s.capture.accel is None for s in self.sessions):
            return
        swapped = any(f.effect == "axis_swap" for f in self.findings)
        bad = [c for s in usable for c in s.contradicted()]
        if bad and not swapped:
            self.remarks.append("labels that gravity contradicts: " + ", ".join(
                "%s (%.0f deg off)" % pair for pair in bad))
        scaled = any(d.sensor == "accel" and d.kind in SCALES for d in self.damages)
        if swapped or scaled or self.stuck:
            return
        if bad:
            usable = self._changed(usable, lambda s: s.without_poses(
                [name for name, _ in s.contradicted()]))
        usable = [s for s in usable if s.placements() >= FEWEST_PLACEMENTS]
        if not usable:
            return
        temperatures = [s.temperature for s in usable if s.temperature is not None]
        if temperatures:
            self.settings.reference_c = float(np.mean(np.concatenate(temperatures)))
        self._temperature_remarks(usable)
        usable = self._off_the_rails(usable)
        if not usable:
            return
        progress.doing("the nominal sensor")
        nominal = [attitude_fit.fit(s) for s in usable]
        self._judge(usable, nominal)

    def _changed(self, usable, change):
        """Sessions that others stand for from here on; they are so among all sessions, too."""
        other = {session: change(session) for session in usable}
        self.sessions = [other.get(session, session) for session in self.sessions]
        return list(other.values())

    def _off_the_rails(self, usable):
        """Rests that were cut off say nothing about the sensor but that; a remark names how
        many were left out."""
        if not any(f.effect == "saturation" and f.sensor == "accel" for f in self.findings):
            return usable
        before = sum(s.placements() for s in usable)
        usable = self._changed(usable, lambda s: s.without_samples(saturation.railed(s)))
        lost = before - sum(s.placements() for s in usable)
        if lost:
            self.remarks.append("%d rests on a rail were left out" % lost)
        return [s for s in usable if s.placements() >= FEWEST_PLACEMENTS]

    def _judge(self, sessions, nominal):
        """Both sensors at rest and the gyro's turns, side by side where there are cores: the
        linear algebra lets other threads run."""
        gyro = all(s.gyro is not None for s in sessions)
        with ThreadPoolExecutor(self.settings.jobs) as pool:
            chip = sessions[0].capture.meta["sensor"]
            accel = pool.submit(RestModel("accel", chip, self.settings).fit, sessions, nominal)
            if gyro:
                still = pool.submit(RestModel("gyro", chip, self.settings).fit,
                                    self._axes(sessions, nominal), nominal)
                self._turns(sessions, nominal)
                self.gaps["gyro"] = still.result()
            self.gaps["accel"] = accel.result()
        progress.doing("what moves between the rests show")
        self.gaps = {k: self.gaps[k] for k in ("accel", "gyro") if k in self.gaps}
        self.motion = motion_model.of(self.sessions, sessions, nominal, self.turns, self.settings)
        # What the rests do not explain would be carried into the moves.
        if self.motion and not any(g.unexplained for g in self.gaps.values()):
            self.findings += self.motion.found
            if not self.turns.found.best.forms:  # a gyro that bends carries gravity wrongly, too
                self.nameless += self.motion.nameless
            self.remarks += self.motion.remarks
        said = [c.remark() for c in self.gaps["accel"].crooked if c and not self.settings.coarse]
        self.remarks += list(dict.fromkeys(sentence for sentence in said if sentence))

    def _axes(self, sessions, nominal):
        """The sessions with axes of the gyro that are swapped named, and put right, since the
        Earth's rate on the wrong axes looks like gravity in the gyro."""
        self.swapped = turn_model.swapped(sessions, nominal)
        if not self.swapped:
            return sessions
        if self.swapped.effect not in self.settings.without:
            self.findings.append(self.swapped)
        return [session.with_gyro_axes(self.swapped.read) for session in sessions]

    def _turns(self, sessions, nominal):
        """The gyro while it moves: what bends or scales it, beyond a band that reads nothing."""
        bent = any(f.sensor == "gyro" and f.effect == "dead_band" for f in self.findings)
        usable = all(turn_model.usable(s, m) for s, m in zip(sessions, nominal))
        if usable and not self.swapped and not bent:
            self.turns = turn_model.TurnModel(
                "gyro", sessions[0].capture.meta["sensor"], self.settings).fit(sessions, nominal)
            self._astray()

    def _astray(self):
        """Turns that end far from where gravity says: samples lost under a steady clock."""
        nats, number = turn_model.astray(self.turns)
        if present(nats):
            self.nameless.append(localisation.Place("gyro", None, "motion", 1.0,
                                                    odds.chance(nats)))
            self.remarks.append("about %.0f turns end far from where gravity says, the others do "
                                "not: samples may be lost although their times are steady"
                                % number)

    def _temperature_remarks(self, sessions):
        if any(s.temperature is None for s in sessions):
            self.remarks.append("no usable temperature column: effects of temperature cannot be "
                                "looked for")
        elif max(s.thermometer.moved for s in sessions) < 1.0:
            self.remarks.append("the temperature moved by %.1f degC only: little can be said "
                                "about it" % max(s.thermometer.moved for s in sessions))

    @property
    def same_session(self):
        return len(self.sessions) == 1

    @property
    def causes(self):
        """[(sensor, Cause)] of all sensors, the largest score first."""
        found = [(kind, c) for gaps in (self.gaps, self.rest) for kind, gap in gaps.items()
                 for c in gap.causes]
        if self.turns:
            found += [("gyro", c) for c in self.turns.causes]
        return sorted(found, key=lambda pair: -pair[1].score)

    def _verdict(self):
        """verdict.of what was found in the rests, the turns, the moves and the samples."""
        judged = [*self.gaps.values(), *([self.turns] if self.turns else [])]
        claims = [verdict.Claim(f.named, told([f.effect, *f.rivals], f.share) and self._sized(f),
                                f.nameless) for f in self.findings if f.plausible]
        claims += [verdict.Claim(sum(c.probabilities.values()), told(c.names, c.share) and bool(
            c.effect == "drift" or shrinkage.interval), c.nameless)
            for c, shrinkage in self._shrinking() if c.plausible]
        claims += [verdict.Claim(g.found.places["drift"]["drift"], True)
                   for g in self.gaps.values() if g.drift]
        nameless = [p for g in judged for p in verdict.of_gap(g.found, g.adequacy)]
        nameless += [p for gap in self.rest.values() for p in gap.nameless]
        nameless += [1.0 - place.p for place in self.nameless]
        # A size that no part has is a name for something else.
        nameless += [f.named for f in self.findings if not f.plausible]
        nameless += [c.place.get(c.effect, 0.0) for _, c in self.causes if not c.plausible]
        broken = bool(self.stuck)
        return verdict.of(claims, [*nameless, float(broken)], self.sees())

    def _sized(self, finding):
        """Whether the interval of a Finding's share is known; in motion, that of the gap."""
        if finding.domain != "motion":
            return finding.share_interval is not None
        return bool(self.motion and self.motion.shrinkage and self.motion.shrinkage.interval)

    def _shrinking(self):
        """[(cause, holdout_gain.Shrinkage of the gap it is found in)]"""
        found = [(c, gap.shrinkage) for gaps in (self.gaps, self.rest) for gap in gaps.values()
                 for c in gap.causes]
        return found + [(c, self.turns.shrinkage) for c in (self.turns.causes if self.turns
                                                            else ())]

    def sees(self):
        """True when the capture would have shown most of what it is asked about."""
        from . import detectability
        if not self.gaps:
            return any(s.runs and s.t_s[-1] >= LEAST_S for s in self.sessions)
        return detectability.visible_share(self) >= 0.5


def told(names, share):
    """True when all effects of a class show themselves in the same way, so that it is known
    where it comes from, if not its name, and how much of the gap it accounts for."""
    return share is not None and len({terms.DOMAIN[n] for n in names}) == 1
