"""The first stage: what registers, clock and spectra say of the samples themselves, with a name
and without."""
import copy
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sixflip import RAIL
from sixflip_sim.effects import typical

from .. import side_by_side
from ..capture import registers
from ..capture.imports import gyro_unit
from . import localisation, odds
from .detect import (
    axis_order,
    byte_faults,
    codes,
    dead_band,
    held_values,
    lattice,
    line_across_rests,
    missing_rows,
    noise_bursts,
    noise_shape,
    rest_parts,
    rest_spectra,
    row_order,
    sample_clock,
    saturation,
    shake_detector,
    spectral_lines,
    spikes,
    stuck_axes,
    torn_reads,
    unread_rows,
    wrong_scale,
)
from .detect.detection import agreed_by_axis, present
from .settings import Conditions, Settings

COARSE = ("quantisation", "dead_band", "saturation", "torn_reads")
# What makes some seconds louder, and some samples leap.
QUIETEST = 4.0  # times less noise than its data sheet says that a part has: by a narrow filter
NOISY = ("vibration", "torn_reads", "saturation", "dead_band")
SLOW_HZ = 1.0  # of a line that the means of rests have something of
SCALES = ("full_scale", "gravity")  # damages that every reading of a sensor has
SENSOR = registers.SENSORS
ALONE = Settings()


def without_damage(captures, processors=1):
    """([(name, Capture)] without their damage, [Damage]). The captures given are not changed;
    processors: that captures share."""
    captures, disordered = row_order.as_read(captures)
    captures, unread = unread_rows.as_read(captures)
    captures, held = held_values.as_read(captures)
    captures, bytes_mended = byte_faults.repaired(captures, processors)
    return captures, [*disordered, *unread, *held, *bytes_mended]


@dataclass(frozen=True, eq=False)
class SamplesJudged:
    """sessions: those judged, without what single samples far off do to their rests; findings
    (tuple of Finding), damages (tuple of detection.Damage), nameless (tuple of Place), remarks
    (tuple of sentences)."""

    sessions: tuple
    findings: tuple
    damages: tuple
    nameless: tuple
    remarks: tuple

    @property
    def scaled(self):
        """True when all that the accelerometer reads is of another scale."""
        return any(d.sensor == "accel" and d.kind in SCALES for d in self.damages)

    @property
    def of_scales(self):
        """[Place] of what makes all that a sensor reads too large or too small."""
        return [_place(d, None) for d in self.damages if d.kind in SCALES]

    def conditions(self, reference_c):
        """settings.Conditions that hold for the rests of the same captures."""
        coarse = any(f.sensor == "accel" and f.effect in COARSE for f in self.findings)
        def axes(effect):
            return {f.sensor: ["xyz".index(a) for a in f.axes] for f in self.findings
                    if f.effect == effect}
        return Conditions(reference_c, coarse, axes("vibration"), axes("dead_band"),
                          any("later" in damage.value for damage in self.damages),
                          max((f.hidden for f in self.findings), default=0.0))


def judge(sessions, settings=ALONE, damages=()):
    """SamplesJudged of all sessions; settings: settings.Settings; damages: those that were put
    right or taken out before, which leave no gap behind."""
    without = settings.without
    *found, whole, (rings, tones, lines, held_by_hand) = side_by_side.results(
        [partial(say, sessions) for say in (*FOUND_BY, _of_whole_axes, _of_spectra)],
        settings.processors)
    lines = spectral_lines.within_the_rate(lines, whole[0], sessions[0].rate)
    findings = [f for f in sum(found, []) + lines if f.effect not in without]
    findings, uneven = codes.uneven(sessions, findings, {sensor for sensor, *_ in whole[2]})
    coarse = {(f.sensor, axis) for f in findings if f.effect in COARSE for axis in f.axes}
    held, scales, bits = whole
    slow = stuck_axes.read_slower(sessions)
    coarse |= {(damage.sensor, axis) for damage in slow for axis in damage.axes}
    stuck = stuck_axes.stuck_for_a_while(sessions, coarse)
    left = [*held, *slow, *stuck, *scales]
    damages = [*damages, *left]
    leaping = {sensor for sensor, *_ in [*bits, *uneven]} | {
        f.sensor for f in findings if f.effect == "dead_band"}
    jumpy = {sensor for sensor, *_ in uneven} | {
        f.sensor for f in findings if f.effect in ("torn_reads", "dead_band")}
    sessions = [_without_bands(s, findings) for s in sessions]
    without_spikes, wild = spikes.without_spikes(sessions, leaping)
    findings, shaped = noise_shape.not_normal(without_spikes, findings, leaping)
    noisy = leaping | {f.sensor for f in findings if f.effect in NOISY}
    noisy |= {"gyro"} if held_by_hand else set()
    unsteady = [burst for burst in noise_bursts.unsteady(without_spikes) if burst[0] not in noisy]
    # A rail cuts off what moves: it makes no single sample of a rest stand out.
    unsteady += [spike for spike in wild if spike[0] not in leaping | {
        f.sensor for f in findings if f.effect in NOISY and f.effect != "saturation"}]
    unsteady += torn_reads.jumps(sessions, jumpy)
    unsteady += [(sensor, noise_shape.words(sensor, axis, *measures), odds.chance(nats))
                 for sensor, axis, nats, *measures in shaped]
    remarks = [damage.words for damage in damages]
    if not any(d.sensor == "gyro" and d.kind == "full_scale" for d in damages):
        remarks += gyro_unit.doubt([s.capture for s in sessions])
    remarks += ["bit %d of the %s axis of the %s always reads %d"
               % (bit, axis, SENSOR[sensor], value) for sensor, axis, bit, value, _ in bits]
    remarks += [*(words for _, _, words, _ in rings), *held_by_hand]
    # Spikes that are pages are one gap, by whichever of both they are told more surely.
    noise = {sensor: min(p for other, _, p in unsteady if other == sensor)
             for sensor, _, _ in unsteady}
    nameless = [localisation.Place(sensor, None, "noise", 1.0, p) for sensor, p in noise.items()]
    nameless += [localisation.Place(sensor, axis, "time_since_move", 1.0, odds.chance(nats))
                 for sensor, axis, _, nats in rings]
    nameless += [_place(damage, axis) for damage in left for axis in damage.axes or (None,)]
    nameless += [localisation.Place(sensor, axis, "amplitude", 1.0, odds.chance(nats))
                 for sensor, axis, nats in [*((*bit[:2], bit[-1]) for bit in bits), *uneven]]
    remarks += ["the %s axis of the %s reads some codes hardly ever and others too often"
                % (axis, SENSOR[sensor]) for sensor, axis, _ in uneven]
    shaken = {(f.sensor, a) for f in findings if f.effect == "vibration" for a in f.axes}
    shaken |= {("gyro", axis) for axis in "xyz" if held_by_hand}
    tones = [tone for tone in tones if tone[:2] not in shaken]
    nameless += [localisation.Place(sensor, axis, "frequency", 1.0, odds.chance(nats))
                 for sensor, axis, nats, _ in tones]
    remarks += ["the %s axis of the %s has a tone that wanders between %.2g and %.2g Hz"
                % (axis, SENSOR[sensor], *hz) for sensor, axis, _, hz in tones]
    sessions = tuple(_without_lines(s, findings) for s in without_spikes)
    if stuck:  # an axis that keeps its value says nothing of how it rests
        sessions = tuple(s.without_samples(stuck_axes.stuck_rows(s, stuck)) for s in sessions)
    return SamplesJudged(sessions, tuple(findings), tuple(damages), tuple(nameless),
                         (*remarks, *(words for _, words, _ in unsteady),
                          *noise_shape.in_common(without_spikes, noisy)))


def _place(damage, axis):
    """Place of a Damage on an axis, or on all of them."""
    return localisation.Place(damage.sensor, axis, damage.domain, 1.0, odds.chance(damage.score))


def _without_bands(session, findings):
    """The session with what a dead band takes off put back on: where no code is missing, all that
    is read beyond the band is less by it, which bends every axis as no other effect does."""
    capture = copy.copy(session.capture)
    for finding in (f for f in findings if f.effect == "dead_band"):
        counts = np.array(getattr(capture, finding.sensor))
        for axis, band in finding.value.items():
            column = counts[:, "xyz".index(axis)].astype(np.int64)
            off = column - codes.resting(column)
            if np.abs(off[off != 0]).min(initial=band) < band:
                counts[:, "xyz".index(axis)] = np.clip(
                    column + band * np.sign(off), -RAIL - 1, RAIL)
        setattr(capture, finding.sensor, counts)
    return session.of_capture(capture) if any(
        f.effect == "dead_band" for f in findings) else session


def _without_lines(session, findings):
    """The session with the means of its blocks without the slow lines that were found."""
    for finding in (f for f in findings if f.effect == "vibration"):
        for axis, hz in finding.hz.items():
            session = line_across_rests.without(session, finding.sensor, "xyz".index(axis), hz,
                                                SLOW_HZ)
    return session


def _of_spectra(sessions):
    """(what rings after it was put down, tones that wander, Findings of lines beside that, what is
    said of a hand)."""
    rings = rest_parts.ringing_axes(sessions)
    tones = [(sensor, *tone) for sensor in SENSOR for tone in rest_spectra.wandering_tones(
        sessions, sensor)]
    lines = spectral_lines.findings(sessions, *([found[:2] for found in of]
                                                for of in (rings, tones)))
    return rings, tones, *shake_detector.without_tremor(lines, sessions)


def _of_whole_axes(sessions):
    """(Damages of values that are held, of scales, axes with a bit that is stuck)."""
    return (held_values.findings(sessions), wrong_scale.findings(sessions),
            [bit for bit in registers.stuck_bits(sessions) if present(bit[-1])])


def _of_registers(sensor, sessions):
    """[Finding] of a sensor's registers: steps, a dead band, rails, clipped peaks, torn reads."""
    columns = [getattr(s.capture, sensor) for s in sessions]
    if any(c is None for c in columns):
        return []
    meta, rate = sessions[0].capture.meta, min(s.rate for s in sessions)
    noise = typical.noise_at(typical.chip_of(meta["sensor"], sensor), rate)
    band = dead_band.findings(sensor, columns, [s.at_rest for s in sessions], min(
        noise) / QUIETEST / registers.unit_of_count(meta, sensor))
    # Of a file of decimals the counts are none of a chip's: what it counts in is its own step.
    steps = [lattice.steps(c, sensor, meta[registers.SCALES[sensor]])
             if registers.own_counts(s.capture, sensor) else registers.steps(c)
             for s, c in zip(sessions, columns)]
    steps = [np.where(found > s.capture.meta.get(sensor + "_own_step", 1), found, 1)
             for s, found in zip(sessions, steps)]
    return (agreed_by_axis("quantisation", sensor, steps,
                           list(map(codes.step_nats, columns, steps)), "counts come in steps",
                           [codes.distinct(c) for c in columns])
            + _in_units(band, sessions[0].capture.meta, sensor)
            + saturation.saturation(sessions, sensor, columns)
            + torn_reads.finding(sessions, sensor, ["xyz".index(a) for f in band for a in f.axes]))


def _in_units(findings, meta, sensor):
    """The Findings with their sizes in g or deg/s, too, where counts are those of an import."""
    if meta.get(sensor + "_values") != "float":
        return findings
    return [replace(f, levels={axis: size / meta[registers.SCALES[sensor]]
                               for axis, size in f.value.items()}) for f in findings]


def _of_rows(sessions):
    """list of Finding of whole rows: repeated and dropped samples, the true rate, axes swapped or
    inverted."""
    timing = sample_clock.findings(sessions)
    if not any(finding.effect == "dropped_samples" for finding in timing):
        timing += missing_rows.findings(sessions)
    return timing + axis_order.swapped(sessions)


# Functions of sessions: what they find is told in this order.
FOUND_BY = (partial(_of_registers, "accel"), partial(_of_registers, "gyro"), _of_rows)
