"""All stages over all captures: the order in which they are asked, and the verdict."""
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from .. import progress
from . import (
    attitude_fit,
    axis_order,
    counts,
    gyro_turns,
    integrity,
    motion,
    motion_gap,
    noise_bursts,
    observations,
    rails,
    regressors,
    sample_clock,
    single_rest,
    spectral_lines,
    where,
)
from .sensor_gap import SensorGap

FEWEST_PLACEMENTS = 6
COARSE = ("quantisation", "dead_band", "saturation", "torn_reads")
NOISY = ("vibration", "torn_reads", "saturation")  # what makes some seconds louder
SENSOR = {"accel": "accelerometer"}
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


class Diagnosis:
    """sessions, findings (list of Finding), gaps {sensor: SensorGap}, rest (SingleRest or None),
    turns, motion (TurnsGap of the gyro, MotionGap of the accelerometer, or None), where (list of
    Place), verdict, remarks (sentences)."""

    def __init__(self, sessions, settings, simulator=None):
        sessions, others = observations.same_chip(sessions)
        sessions, again = observations.distinct(sessions)
        self.sessions, self.settings = sessions, settings
        self.remarks, self.gaps, self.rest, self.turns = [], {}, None, None
        self.motion = None
        self.scale_remark = ""
        self.remarks += ["%s is of another sensor (%s) and was left out" % (
            s.name, s.capture.meta["sensor"]) for s in others]
        self.remarks += ["%s repeats a capture before it and was left out" % s.name
                         for s in again]
        self.remarks += ["%s: its timestamps stand still, rate_hz was used instead" % s.name
                         for s in sessions if s.timeless]
        self.remarks += sample_clock.remarks(sessions)
        progress.doing("registers, clock and spectra")
        self.stuck = counts.stuck(sessions)
        self.remarks += self.stuck
        self.findings = [f for f in integrity.findings(sessions)
                         + spectral_lines.findings(sessions) if f.effect not in settings.without]
        self._noise(sessions)
        settings.coarse = any(f.sensor == "accel" and f.effect in COARSE for f in self.findings)
        self._poses()
        if not self.gaps:
            progress.doing("the longest rest")
            self.rest = single_rest.SingleRest(sessions, settings)
            more = list(self.rest.findings)
            if not any(f.effect == "vibration" and f.sensor == "accel" for f in self.findings):
                more += motion.findings(sessions)
            self.findings += [f for f in more if f.effect not in settings.without]
            self.remarks += self.rest.remarks
        if simulator:
            self._compared(simulator)
        self.remarks += ["the %s: %s" % (SENSOR.get(f.sensor, f.sensor), f.words)
                         for f in self.findings if f.effect == "vibration"]
        self.where = [where.Place(f.sensor, axis, f.domain, 1.0, np.exp(-min(f.score, 600.0)))
                      for f in self.findings for axis in (f.axes or [None])]
        places = [p for gap in [*self.gaps.values(), *([self.turns] if self.turns else [])]
                  for p in where.places(gap)]
        self.where += sorted(places + self.nameless, key=where.order)
        self.verdict = self._verdict()

    def _noise(self, sessions):
        """Noise that comes in bursts and bits that stick: where, without a name."""
        named = {f.sensor for f in self.findings if f.effect in NOISY}
        bursts = [b for b in noise_bursts.found(sessions) if b[0] not in named]
        bits = counts.stuck_bits(sessions)
        self.remarks += [words for _, words, _ in bursts]
        self.remarks += ["bit %d of the %s axis of the %s always reads %d"
                         % (bit, axis, "gyro" if sensor == "gyro" else "accelerometer", value)
                         for sensor, axis, bit, value in bits]
        self.nameless = [where.Place(sensor, None, "noise", 1.0, p) for sensor, _, p in bursts]
        # Each sample would show a bit that is free on one side or the other.
        samples = sum(len(s.capture) for s in sessions)
        self.nameless += [where.Place(sensor, axis, "amplitude", 1.0, 0.5 ** min(samples, 900))
                          for sensor, axis, _, _ in bits]

    def _compared(self, simulator):
        """Leave out what the simulator has as well; add what only it has."""
        self.remarks += simulator.remarks + simulator.noise_remarks(self.sessions)
        self.remarks += ["the simulator has %s (%s), the real sensor does not"
                         % (f.effect, f.sensor) for f in simulator.only_simulated(self.findings)]
        self.findings = [f for f in self.findings if simulator.new(f)]

    def _poses(self):
        """The rests of sessions with poses, if any has enough of them."""
        usable = [s for s in self.sessions if s.placements() >= FEWEST_PLACEMENTS]
        if not usable:
            return
        swapped = any(f.effect == "axis_swap" for f in self.findings)
        bad = [c for s in usable for c in s.contradicted()]
        if bad and not swapped:
            self.remarks.append("labels that gravity contradicts: " + ", ".join(
                "%s (%.0f deg off)" % pair for pair in bad))
        if swapped or self.stuck:
            return
        for session in usable if bad else ():
            session.refuse([name for name, _ in session.contradicted()])
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
        self.scale_remark = axis_order.full_scale(usable, nominal)
        if self.scale_remark:
            self.remarks.append(self.scale_remark)
            return
        self._judge(usable, nominal)

    def _off_the_rails(self, usable):
        """Rests that were cut off say nothing about the sensor but that; a remark names how
        many were left out."""
        if not any(f.effect == "saturation" and f.sensor == "accel" for f in self.findings):
            return usable
        before = sum(s.placements() for s in usable)
        for session in usable:
            session.leave_out(rails.railed(session))
        lost = before - sum(s.placements() for s in usable)
        if lost:
            self.remarks.append("%d rests on a rail were left out" % lost)
        return [s for s in usable if s.placements() >= FEWEST_PLACEMENTS]

    def _judge(self, sessions, nominal):
        """Both sensors at rest and the gyro's turns, side by side where there are cores: the
        linear algebra lets other threads run."""
        gyro = all(s.gyro is not None for s in sessions)
        with ThreadPoolExecutor(self.settings.jobs) as pool:
            accel = pool.submit(SensorGap, "accel", sessions, nominal, self.settings)
            if gyro:
                self._axes(sessions, nominal)
                still = pool.submit(SensorGap, "gyro", sessions, nominal, self.settings)
                self._turns(sessions, nominal)
                self.gaps["gyro"] = still.result()
            self.gaps["accel"] = accel.result()
        progress.doing("what moves between the rests show")
        self.gaps = {k: self.gaps[k] for k in ("accel", "gyro") if k in self.gaps}
        self.motion = motion_gap.of(self.sessions, sessions, nominal, self.turns, self.settings)
        # What the rests do not explain would be carried into the moves.
        if self.motion and not any(g.unexplained for g in self.gaps.values()):
            self.findings += self.motion.found
            self.remarks += self.motion.remarks
        said = [c.remark() for c in self.gaps["accel"].crooked if c and not self.settings.coarse]
        self.remarks += list(dict.fromkeys(sentence for sentence in said if sentence))

    def _axes(self, sessions, nominal):
        """Axes of the gyro that are swapped: named, and put right for all that follows, since
        the Earth's rate on the wrong axes looks like gravity in the gyro."""
        self.swapped = gyro_turns.swapped(sessions, nominal)
        if not self.swapped:
            return
        if self.swapped.effect not in self.settings.without:
            self.findings.append(self.swapped)
        for session in sessions:
            session.gyro = session.gyro @ self.swapped.read
            for name in ("noise_gyro", "rounding_gyro"):
                setattr(session, name, getattr(session, name) @ np.abs(self.swapped.read))

    def _turns(self, sessions, nominal):
        """The gyro while it moves: what bends or scales it, beyond a band that reads nothing."""
        bent = any(f.sensor == "gyro" and f.effect == "dead_band" for f in self.findings)
        usable = all(gyro_turns.usable(s, m) for s, m in zip(sessions, nominal))
        if usable and not self.swapped and not bent:
            self.turns = gyro_turns.TurnsGap("gyro", sessions, nominal, self.settings)

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
        found = [(kind, c) for kind, gap in self.gaps.items() for c in gap.causes]
        if self.turns:
            found += [("gyro", c) for c in self.turns.causes]
        return sorted(found, key=lambda pair: -pair[1].score)

    def _verdict(self):
        gaps = self.gaps.values()
        drifting = any(g.drift for g in gaps)
        unexplained = any(g.unexplained for g in gaps) or bool(
            self.stuck or self.scale_remark or self.nameless
            or self.turns and self.turns.unexplained)
        believed = [c for _, c in self.causes if c.plausible]
        incredible = [c for _, c in self.causes if not c.plausible]
        resolved = drifting or any(not f.rivals for f in self.findings) or any(
            one_domain(c.names) for c in believed)
        found = bool(believed or self.findings or drifting)
        if not found:
            if unexplained or incredible:
                return "unexplained"
            return "no gap" if self.sees() else "cannot tell"
        if unexplained or incredible:
            return "partly explained"
        return "explained" if resolved else "cannot tell"

    def sees(self):
        """True when the capture would have shown most of what it is asked about."""
        from . import unseen
        if not self.gaps:
            return any(s.runs and s.t_s[-1] >= LEAST_S for s in self.sessions)
        return unseen.visible_share(self) >= 0.5


def one_domain(names):
    """True when all effects of a class show themselves in the same way: where it comes from
    is known then, if not its name."""
    return len({regressors.DOMAIN[n] for n in names}) == 1
