"""A simulator's log against the real one, in four layers that never borrow each other's names:
conventions, parameters, effects (of diagnosis.Diagnosis), task."""
from dataclasses import dataclass, replace

import numpy as np

from .. import odds
from . import (
    alignment,
    clock_course,
    convention_findings,
    dead_zone,
    held_readings,
    motion_match,
    noise_and_registers,
    noise_band,
    numbers_told,
    one_motion,
    own_calibration,
    own_motion,
    parameters,
    remaining_gap,
    shaking,
    simulator_answer,
    single_log,
    stopping,
    timing,
    traces,
    turned_in_box,
)

RAILED = 0.5  # share of a log at the end of its range: what is left of it is no motion any more
# Times the noise, root mean square, of what is left of two logs of one motion: 0.8 to 1.2 where
# they differ in nothing but noise, 2.8 of a rover that bumps shake otherwise in each (`make zoo`).
ABOVE = 1.5
FAR_ABOVE = 4.0  # times the noise: more than any two runs over one floor differ by


@dataclass(frozen=True)
class Comparison:
    """log, against: names of the simulator's and the real log; alignment; conventions
    (convention_findings.Convention, ...); parameters (parameters.Parameter, ...); task
    (remaining_gap.Task or None); gap {sensor: (before, after, noise alone)} held out, of one
    motion; fits {sensor: conventions.SensorFit}; real and simulated own_calibration.OwnSensor;
    remarks; unseen; motion_judged: lever arm and delay of the two logs were compared, or what is
    wrong with the simulator's hides them; reference_c: mean temperature of the real log or None;
    effects (tuple of effects_beside.Beside): those found, as far as two logs of one motion show
    their size; wanders: sensors of which what is left of one motion goes on for seconds, or
    follows from both logs: it is no shaking, which each has of its own; lacks_delay: of two
    motions, the real one shows a delay between its sensors that the simulator's does not; bands
    (dead_zone.Band, ...): of slow turns that the real log lacks, and with which the fits have the
    simulator's; of_gyro: nats by which it is the gyro that does not answer them, and not what
    turns it; otherwise: of two motions, at rest they differ by a bias or by how the sensor lies;
    put_right (clock_course.PutRight): both captures with their times put right, where those do
    not go alike, or None."""

    log: str
    against: str
    alignment: alignment.Alignment
    conventions: tuple
    parameters: tuple
    task: remaining_gap.Task
    gap: dict
    fits: dict
    real: own_calibration.OwnSensor
    simulated: own_calibration.OwnSensor
    remarks: tuple
    unseen: tuple
    motion_judged: bool
    reference_c: float
    effects: tuple = ()
    wanders: frozenset = frozenset()
    lacks_delay: bool = False
    bands: tuple = ()
    of_gyro: float = 0.0
    otherwise: bool = False
    put_right: clock_course.PutRight = None

    @property
    def differs(self):
        return [p for p in self.parameters if p.differs]

    @property
    def unexplained(self):
        return bool(self.left) or any(c.name == "unknown" and not c.one_of
                                      for c in self.conventions)

    @property
    def shaken(self):
        """Sensors of which far more is left than noise, and than a tenth of the gap, and nothing
        that goes on for seconds: it may be shaking that each log has of its own, and may be the
        sensor's. Where the real one is known to shake more, by more than is left, it is that. And
        those of which that tenth is left, and more than a chip flickers by, while no log tells the
        noise; and the gyro that lacks slow turns, which what turns it may lack."""
        shakes = {kind: np.sqrt(sum(p.difference ** 2 for p in self.differs if (
            p.name, p.sensor) == ("shaking", kind) and p.difference > 0.0) / 3.0)
            for kind in self.gap}
        return [kind for kind, gap in self.gap.items()
                if not gap[2] and gap[1] > self.real.flicker[kind] and _open(gap, 0.0)
                or kind not in self.wanders and gap[1] > shakes[kind] and _open(gap, FAR_ABOVE)
                or kind == "gyro" and self.bands and self.of_gyro < dead_zone.GYRO]

    @property
    def left(self):
        """Sensors of which more is left than noise, and than a tenth of the gap of two logs of
        one motion, and wanders. Where a range differs the readings at its end are left: a tenth
        of what it cuts off, and no more."""
        cut = {kind: max((abs(p.difference) for p in self.differs if (
            p.name, p.sensor) == ("range", kind)), default=0.0) for kind in self.gap}
        return [kind for kind, gap in self.gap.items() if kind in self.wanders
                and gap[1] > (1.0 - odds.CLOSED) * cut[kind] and _open(gap, ABOVE)]


def _open(gap, times):
    """Whether of a gap (before, after, noise alone), root mean squares, so many times the noise is
    left (not where that is not known), and a tenth of what is above it; times: 0 for any."""
    before, after, noise = gap
    after = min(before, after)
    above = after > times * noise > 0.0 if times else True
    return above and before - after < odds.CLOSED * (before - noise)


def compare(real_logs, name, capture):
    """Comparison of one log of the simulator with the real log that is nearest to its motion.

    real_logs  [(name, Capture)]
    """
    sim = traces.trace_from_capture(name, capture)
    candidates = [traces.trace_from_capture(n, c) for n, c in real_logs]
    aligned = [motion_match.aligned(real, sim) for real in candidates]
    best = max(range(len(candidates)), key=lambda k: aligned[k].correlation)
    real = candidates[best]
    course = clock_course.found(real, sim, aligned[best])
    if course is None:
        return compare_traces(real, sim, aligned[best])
    right = clock_course.put_right(course, real, sim, (real_logs[best][1], capture))
    real, sim = (traces.trace_from_capture(log.name, captured) for log, captured in (
        (real, right.real), (sim, right.sim)))
    result = compare_traces(real, sim, motion_match.aligned(real, sim))
    return replace(result, parameters=(*result.parameters, *right.parameters),
                   remarks=(*right.remarks, *result.remarks), put_right=right)


def compare_traces(real, sim, aligned):
    """Comparison of two Traces, whose clocks lie as the Alignment says."""
    logs = one_motion.logs_of(real, sim, aligned)
    findings, unseen, judged, lacks_delay, together = _conventions(logs)
    fits = together.fits
    if real.rate is not None and sim.rate is None:
        unseen = [*unseen, "the gyro: there is none in %s" % sim.name]
    mended = convention_findings.trace_put_right(logs.sim_free, findings)
    own = logs.own_real, own_calibration.fitted(mended)
    if not fits:  # what never rests is known beside the other log of its motion alone
        own = tuple(sensor if log.rests else None for sensor, log in zip(own, (real, sim)))
    otherwise = None
    if not fits and None not in own:
        otherwise = own_calibration.lies_otherwise(logs.real_free, mended, *own)
    if otherwise is not None:
        unseen = [*unseen, "whether a bias or how they lie makes %s and %s differ at rest, by "
                  "(%.0f, %.0f, %.0f) mg: each lies too much alike in all of its rests" % (
                      real.name, sim.name, *otherwise)]
    in_box, either = own, []
    if not fits and None not in own:
        turned, either = turned_in_box.as_the_box_says(real, mended, *own)
        in_box = turned, own[1]
    unseen = [*unseen, *either]
    numbers, of_numbers = numbers_of(real, sim, mended, in_box, fits, findings)
    numbers, of_told, gap, wanders = numbers_told.gap(numbers, fits, together.unmended, real, sim)
    numbers += _of_range_and_time(logs, together, numbers, findings)
    findings += of_numbers + parameters.bias_sign(numbers)
    if any(c.name == "noise_per_sample" for c in findings):
        numbers = [p for p in numbers if p.name != "noise_density"]
    task, why_not = remaining_gap.tried(logs.real_free, mended, *own, {
        kind: replace(fit, fit=fit.refitted(None)) for kind, fit in of_told.items()})
    remarks = (*simulator_answer.said_of(real, sim, logs.aligned),
               *dead_zone.said_of(together.bands, together.of_gyro), *why_not,
               *numbers_told.of_gravity(numbers, real.g))
    return Comparison(sim.name, real.name, logs.aligned, tuple(findings), tuple(numbers), task,
                      gap, fits, *own, remarks, tuple(unseen),
                      judged or convention_findings.only_in_motion(findings),
                      None if real.celsius is None else float(real.celsius.mean()),
                      wanders=wanders, lacks_delay=lacks_delay, bands=together.bands,
                      of_gyro=together.of_gyro, otherwise=otherwise is not None)


def _conventions(logs):
    """([Convention] of one_motion.Logs, sentences on what cannot be seen, whether what shows in
    motion was compared, whether the simulator lacks a delay, one_motion.OneMotion)."""
    real, sim = logs.real, logs.sim
    findings = held_readings.findings(real, sim, logs.holds["real"], logs.holds["sim"])
    findings += logs.constant
    unseen, judged, lacks_delay, together = list(logs.unseen), False, False, one_motion.NOTHING
    railed = [log.name for log in (real, sim) if log.railed.mean() > RAILED]
    if railed:
        unseen.append("conventions: most of the time at the end of the range in %s"
                      % " and ".join(railed))
    elif logs.motion is not None:
        together = one_motion.beside(logs)
        judged = len(together.fits) == 2
        findings += together.conventions
    elif logs.constant:
        unseen.append("other conventions of %s: a channel of it says nothing" % sim.name)
    else:
        more, unseen, judged, lacks_delay = own_motion.different_motion(
            logs.real_free, logs.sim_free, logs.own_real if real.rests else None, logs.row_s,
            logs.aligned.moving)
        findings += more
        if logs.aligned.same and not real.rests:
            unseen = ["conventions and parameters of %s, but for what its own rests show: there "
                      "is none in %s" % (sim.name, real.name)]
    return convention_findings.merged(findings), unseen, judged, lacks_delay, together


def _of_range_and_time(logs, together, numbers, findings):
    """[Parameter] of where one stops and the other goes on, what shakes them and of time, of one
    motion."""
    real, sim, fits = logs.real, logs.sim, together.fits
    cut = {(p.sensor, p.axis) for p in numbers if p.name == "range"}
    more = [p for p in stopping.ranges(together.stops, real, sim)
            if (p.sensor, p.axis) not in cut]
    if len(fits) == 2 and not findings:
        more += shaking.shaking(
            stopping.marked(real, together.stops, "real"), dead_zone.taken_off(
                stopping.marked(sim, together.stops, "sim"), together.bands), logs.aligned,
            {kind: x.low_pass for kind, x in together.smoothed.items() if x.low_pass})
    return more + timing.slope(fits) + timing.compared(
        together.late, together.late_sigma, together.smoothed, logs.aligned)


def numbers_of(real, sim, mended, own, fits, findings):
    """([Parameter], [Convention] on the noise) of two Traces; mended: that of the simulator with
    the conventions found put right; own: OwnSensor or None of the real one, of the simulator."""
    spoiled = [c for c in findings if c.name in convention_findings.SPOILED
               or (c.name, c.sensor) == ("time_step", "gyro")
               or c.name in convention_findings.OF_ATTITUDE and not real.rests]
    usable = {k: not any(c.sensor in (k, "device") for c in spoiled) for k in ("accel", "gyro")}
    densities, on_noise = noise_and_registers.noises(real, mended)
    if not findings:  # in another unit or time it is another noise
        densities += noise_band.falls_off(real, sim)
    rounded = {kind: mended.quantum[kind == "gyro"] / np.sqrt(12.0) for kind in fits
               if single_log.silent(mended, kind)}
    return (parameters.shapes(*own, fits, usable, rounded) + densities
            + noise_and_registers.registers(real, sim), on_noise)
