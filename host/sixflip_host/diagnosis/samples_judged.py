"""The first stage: what registers, clock and spectra say of the samples themselves, with a name
and without."""
from dataclasses import dataclass

from ..capture import registers
from . import localisation, odds
from .detect import (
    codes,
    held_values,
    integrity,
    noise_bursts,
    spectral_lines,
    torn_reads,
    wrong_scale,
)
from .settings import Conditions

COARSE = ("quantisation", "dead_band", "saturation", "torn_reads")
# What makes some seconds louder, and some samples leap.
NOISY = ("vibration", "torn_reads", "saturation", "dead_band")
SCALES = ("full_scale", "gravity")  # damages that every reading of a sensor has
SENSOR = {"accel": "accelerometer", "gyro": "gyro"}


@dataclass(frozen=True, eq=False)
class SamplesJudged:
    """sessions: those judged, without what single samples far off do to their rests; findings
    (tuple of Finding), damages (tuple of damage.Damage), nameless (tuple of Place), remarks
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

    def conditions(self, reference_c):
        """settings.Conditions that hold for the rests of the same captures."""
        coarse = any(f.sensor == "accel" and f.effect in COARSE for f in self.findings)
        return Conditions(reference_c, coarse, {
            f.sensor: ["xyz".index(a) for a in f.axes] for f in self.findings
            if f.effect == "vibration"})


def of(sessions, without=(), damages=()):
    """SamplesJudged of all sessions; without: effects left out of the library; damages: those
    that were put right before."""
    findings = [f for f in integrity.findings(sessions) + spectral_lines.findings(sessions)
                if f.effect not in without]
    damages = [*damages, *held_values.findings(sessions), *wrong_scale.findings(sessions)]
    bits = registers.stuck_bits(sessions)
    leaping = {sensor for sensor, *_ in bits} | {
        f.sensor for f in findings if f.effect == "dead_band"}
    noisy = leaping | {f.sensor for f in findings if f.effect in NOISY}
    jumpy = {f.sensor for f in findings if f.effect in ("torn_reads", "dead_band")}
    without_spikes, wild = noise_bursts.without_spikes(sessions, leaping)
    unsteady = [one for one in [*noise_bursts.found(without_spikes), *wild]
                if one[0] not in noisy]
    unsteady += torn_reads.jumps(sessions, jumpy)
    remarks = [one.words for one in damages]
    remarks += ["bit %d of the %s axis of the %s always reads %d"
               % (bit, axis, SENSOR[sensor], value) for sensor, axis, bit, value in bits]
    nameless = [localisation.Place(sensor, None, "noise", 1.0, p) for sensor, _, p in unsteady]
    nameless += [localisation.Place(one.sensor, axis, one.domain, 1.0, odds.chance(one.score))
                 for one in damages for axis in one.axes or (None,)]
    nameless += [localisation.Place(sensor, axis, "amplitude", 1.0, odds.chance(codes.bit_nats(
        [getattr(s.capture, sensor)[:, "xyz".index(axis)] for s in sessions])))
        for sensor, axis, _, _ in bits]
    return SamplesJudged(tuple(without_spikes), tuple(findings), tuple(damages), tuple(nameless),
                         (*remarks, *(words for _, words, _ in unsteady)))
