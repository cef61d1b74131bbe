"""A simulator's log against the real one, in four layers that never borrow each other's names:
conventions, parameters, effects (of diagnosis.Diagnosis), task."""
from dataclasses import dataclass, replace

import numpy as np

from .. import verdict
from . import (
    alignment,
    convention_findings,
    conventions,
    dead_zone,
    gyro_or_motor,
    held_readings,
    hypotheses,
    levelled_off,
    noise_and_registers,
    numbers_told,
    own_calibration,
    own_motion,
    pairing,
    parameters,
    remaining_gap,
    single_log,
    timing,
    traces,
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
    their size; wanders: sensors of which what is left of one motion goes on for seconds: it is no
    shaking, which each log has of its own; lacks_delay: of two motions, the real one shows a delay
    between its sensors that the simulator's does not; bands (dead_zone.Band, ...): of slow turns
    that the real log lacks, and with which the fits have the simulator's; of_gyro: nats by which
    it is the gyro that does not answer them, and not what turns it; otherwise: of two motions, at
    rest they differ by a bias or by how the sensor lies."""

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
        those of which that tenth is left while no log tells the noise; and the gyro that lacks
        slow turns, which what turns it may lack."""
        shakes = {kind: np.sqrt(sum(p.difference ** 2 for p in self.differs if (
            p.name, p.sensor) == ("shaking", kind) and p.difference > 0.0) / 3.0)
            for kind in self.gap}
        return [kind for kind, gap in self.gap.items()
                if not gap[2] and _open(gap, 0.0)
                or kind not in self.wanders and gap[1] > shakes[kind] and _open(gap, FAR_ABOVE)
                or kind == "gyro" and self.bands and self.of_gyro < gyro_or_motor.GYRO]

    @property
    def left(self):
        """Sensors of which more is left than noise, and than a tenth of the gap of two logs of
        one motion, and wanders. Where a range differs the readings at its end are left."""
        cut = {p.sensor for p in self.parameters if p.name == "range" and p.differs}
        return [kind for kind, gap in self.gap.items()
                if kind in self.wanders - cut and _open(gap, ABOVE)]


def _open(gap, times):
    """Whether of a gap (before, after, noise alone), root mean squares, so many times the noise is
    left (not where that is not known), and a tenth of what is above it; times: 0 for any."""
    before, after, noise = gap
    after = min(before, after)
    above = after > times * noise > 0.0 if times else True
    return above and before - after < verdict.CLOSED * (before - noise)


def compare(real_logs, name, capture):
    """Comparison of one log of the simulator with the real log that is nearest to its motion.

    real_logs  [(name, Capture)]
    """
    sim = traces.trace_from_capture(name, capture)
    candidates = [traces.trace_from_capture(n, c) for n, c in real_logs]
    aligned = [alignment.align(real, sim) for real in candidates]
    best = max(range(len(candidates)), key=lambda k: aligned[k].correlation)
    return compare_traces(candidates[best], sim, aligned[best])


def compare_traces(real, sim, aligned):
    """Comparison of two Traces, whose clocks lie as the Alignment says."""
    unseen = []
    holds = {"real": held_readings.holds(real), "sim": held_readings.holds(sim)}
    findings = held_readings.findings(real, sim, holds["real"], holds["sim"])
    sim_free = held_readings.free(sim, holds["sim"])
    real_free = held_readings.free(real, holds["real"])
    live, constant = single_log.constant_channels(real, sim)
    findings += constant
    if aligned.by == "forces" and not single_log.turns(real) and not single_log.turns(sim):
        aligned = replace(aligned, turning=False)
        live = {**live, "gyro": np.zeros(3, bool)}  # noise says nothing of the other log's
        unseen = ["%s of %s: nothing turns" % (", ".join(
            name.replace("_", " ") for name in hypotheses.IN_TURNS), sim.name)]
    own_real = own_calibration.fitted(real_free)
    fits, unmended, stops, bands, of_gyro = {}, {}, {}, (), 0.0
    late, late_sigma, judged, lacks_delay = None, None, False, False
    row_s = 1.0 / min(real.rate_hz, sim.rate_hz)
    motion = None
    if aligned.same and own_real is not None:
        motion = traces.motion(own_real.applied(real_free))
    if motion is not None:
        aligned = replace(aligned, same=pairing.one_motion(real_free, sim_free, aligned, motion,
                                                           live))
    railed = [log.name for log in (real, sim) if log.railed.mean() > RAILED]
    if railed:
        unseen.append("conventions: most of the time at the end of the range in %s"
                      % " and ".join(railed))
    elif aligned.same and motion is not None:
        fresh = {k: sim.rate_hz / v.rows for k, v in holds["sim"].items()}
        fits = conventions.same_motion(real_free, sim_free, aligned, motion, live, fresh)
        stops = levelled_off.stops(fits)
        if stops:
            real_free = levelled_off.marked(real_free, stops)
            fits = conventions.same_motion(real_free, sim_free, aligned, motion, live, fresh)
        unmended = fits
        bands = dead_zone.found(fits, real_free, sim_free)
        if bands:
            fits = conventions.same_motion(real_free, dead_zone.taken_off(sim_free, bands),
                                           aligned, motion, live, fresh)
            of_gyro = gyro_or_motor.nats_of_gyro(
                replace(real_free, force=own_real.applied(real_free).force), sim_free, aligned,
                fits)
        late, late_sigma, delays = conventions.delay(fits, row_s)
        delays = [held_readings.beside(c, sim.rate_hz, holds["sim"]) for c in delays
                  if own_motion.shown_late(sim_free, late)]
        judged = len(fits) == 2
        findings += [c for f in fits.values() for c in f.conventions if not (
            constant and c.name == "constant_channel")] + delays
    elif constant:
        unseen.append("other conventions of %s: a channel of it says nothing" % sim.name)
    else:
        more, unseen, judged, lacks_delay = own_motion.different_motion(
            real_free, sim_free, own_real if real.rests else None, row_s)
        findings += more
        if aligned.same and not real.rests:
            unseen = ["conventions and parameters of %s, but for what its own rests show: there "
                      "is none in %s" % (sim.name, real.name)]
    if real.rate is not None and sim.rate is None:
        unseen = [*unseen, "the gyro: there is none in %s" % sim.name]
    findings = convention_findings.merged(findings)
    mended = convention_findings.trace_put_right(sim_free, findings)
    own_sim = own_calibration.fitted(mended)
    if not fits:  # what never rests is known beside the other log of its motion alone
        own_real, own_sim = (own if log.rests else None for own, log in (
            (own_real, real), (own_sim, sim)))
    otherwise = None
    if not fits and None not in (own_real, own_sim):
        otherwise = own_calibration.lies_otherwise(real_free, mended, own_real, own_sim)
    if otherwise is not None:
        unseen = [*unseen, "whether a bias or how they lie makes %s and %s differ at rest, by "
                  "(%.0f, %.0f, %.0f) mg: each lies too much alike in all of its rests" % (
                      real.name, sim.name, *otherwise)]
    numbers, of_numbers = numbers_of(real, sim, mended, (own_real, own_sim), fits, findings)
    left = {kind: remaining_gap.not_foretold(sensor_fit) for kind, sensor_fit in fits.items()}
    attainable = remaining_gap.held_out(unmended, left, real, sim)
    numbers, of_told = numbers_told.together(
        numbers, fits, attainable, remaining_gap.wandering(fits, left), real.flicker)
    left = {kind: remaining_gap.not_foretold(fit) for kind, fit in of_told.items()}
    gap = remaining_gap.held_out(unmended, left, real, sim)
    cut = {(p.sensor, p.axis) for p in numbers if p.name == "range"}
    numbers += [p for p in levelled_off.ranges(stops, real, sim) if (p.sensor, p.axis) not in cut]
    if len(fits) == 2 and not findings:
        numbers += noise_and_registers.shaking(real, dead_zone.taken_off(sim, bands))
    numbers += timing.timing(late, late_sigma, fits, aligned, {
        kind: held_readings.smoothing_s2(holds["sim"][kind], sim)
        - held_readings.smoothing_s2(holds["real"][kind], real) for kind in fits})
    findings += of_numbers + parameters.bias_sign(numbers)
    if any(c.name == "noise_per_sample" for c in findings):
        numbers = [p for p in numbers if p.name != "noise_density"]
    task, why_not = remaining_gap.tried(real_free, mended, own_real, own_sim, {
        kind: replace(fit, fit=fit.refitted(None)) for kind, fit in of_told.items()})
    return Comparison(sim.name, real.name, aligned, tuple(findings), tuple(numbers), task, gap,
                      fits, own_real, own_sim,
                      (*alignment.said_of(real, sim, aligned),
                       *gyro_or_motor.said_of(bands, of_gyro), *why_not), tuple(unseen),
                      judged or convention_findings.only_in_motion(findings),
                      None if real.celsius is None else float(real.celsius.mean()),
                      wanders=remaining_gap.wandering(fits, left), lacks_delay=lacks_delay,
                      bands=bands, of_gyro=of_gyro,
                      otherwise=otherwise is not None)


def numbers_of(real, sim, mended, own, fits, findings):
    """([Parameter], [Convention] on the noise) of two Traces; mended: that of the simulator with
    the conventions found put right; own: OwnSensor or None of the real one, of the simulator."""
    spoiled = [c for c in findings if c.name in convention_findings.SPOILED
               or (c.name, c.sensor) == ("time_step", "gyro")
               or c.name in convention_findings.OF_ATTITUDE and not real.rests]
    usable = {k: not any(c.sensor in (k, "device") for c in spoiled) for k in ("accel", "gyro")}
    densities, on_noise = noise_and_registers.noises(real, mended)
    rounded = {kind: sim.quantum[kind == "gyro"] / np.sqrt(12.0) for kind in fits
               if conventions.silent(sim, kind)}
    return (parameters.shapes(*own, fits, usable, rounded) + densities
            + noise_and_registers.registers(real, sim), on_noise)
