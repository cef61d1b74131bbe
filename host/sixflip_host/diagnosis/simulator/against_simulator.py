"""The user's own simulator: the gap is what the real sensor has and that simulator lacks.

The simulator's log is diagnosed like a real capture. What it models is taken off the real sessions
at their own poses, times and temperatures, so that the scenes need not be the same; what both have
in their registers, timing or spectrum is no gap. What the simulator has and the real sensor lacks
is a gap as well. Where both logs are of one motion, their difference says which of the effects
that each shows by itself are in both, and so no gap between them.
"""
from dataclasses import dataclass, replace

import numpy as np

from ...capture import registers
from ...experiment import terms
from ...planning import detectable
from .. import adequacy, odds
from .. import diagnosis as stages
from ..detect import spectral_lines
from ..hypotheses import columns_of
from . import hypotheses, shaken_alike
from .effects_beside import design, fit_with, of_fit

# Standard errors between two sizes from which on they are two effects: two of one size are as far
# apart in one of 370 pairs (normal).
APART = 3.0
# Standard error of a size that has no interval, as a share of it: as well as two logs repeat a
# line, a step or a clock. Less accuses healthy simulators, more hides a difference of a third
# (make zoo). With one, what a scale or a crooked axis makes of it, which no log is corrected for.
RAW = 0.1
# Standard errors within which the share of an effect in the difference is none, so that both logs
# have it, if it is also as far from all of it: either is wrong in one of 370 (normal).
BOTH = 3.0


@dataclass(frozen=True, eq=False)
class Simulator:
    """diagnosis: the Diagnosis of its captures; known: {sensor: [(effect, variant, key,
    coefficient)]}; remarks: tuple of sentences."""

    diagnosis: stages.Diagnosis
    known: dict
    remarks: tuple

    def new(self, finding, sessions):
        """True when the simulator lacks a Finding of the real sensor, of Sessions, or has another
        size."""
        for other in self.diagnosis.findings:
            if (other.effect, other.sensor) != (finding.effect, finding.sensor):
                continue
            keys = set(other.value) | set(finding.value)
            apart = [(_size(finding, k), _size(other, k)) for k in keys]
            if all(abs(a - b) <= APART * np.hypot(sa, sb) for (a, sa), (b, sb) in apart):
                return False
        return not shaken_alike.found_alike(finding, sessions, self.diagnosis.sessions)

    def shakes_alike(self, sessions, sensor, shaken):
        """Whether its log has the power of the real Sessions where that is shaken at rest, {axis
        letter: Hz or None}: what each log by itself makes of it may differ."""
        return shaken_alike.alike(sessions, self.diagnosis.sessions, sensor, shaken)

    def lacks(self, finding, sessions):
        """A Finding of the real sensor, of Sessions, without the axes that the simulator's log
        has shaken as much: each has a line of its own."""
        lines = [line for line in finding.lines if not self.shakes_alike(
            sessions, finding.sensor, {line.letter: line.hz})]
        return finding if not lines or len(lines) == len(finding.lines) else \
            spectral_lines.told(lines, finding.sensor, sessions[0].rate)

    def has_tone(self, sessions, place):
        """Whether a Place without a name is a tone, which its log has as well."""
        return place.domain == "frequency" and place.axis is not None and self.shakes_alike(
            sessions, place.sensor, {place.axis: None})

    def shows(self, finding):
        """True when its log would show a Finding of the real sensor, if it had it."""
        return finding.domain != "motion" or self.diagnosis.motion is not None

    def only_simulated(self, findings, sessions, in_motion=True):
        """Findings of the simulator that the real sensor, of Sessions, does not show, nor is
        shaken as much where they say; in_motion: its log would show what acts in motion."""
        real = {(f.effect, f.sensor) for f in findings}
        return [f for f in self.diagnosis.findings if (f.effect, f.sensor) not in real
                and (in_motion or f.domain != "motion")
                and not shaken_alike.found_alike(f, self.diagnosis.sessions, sessions)]


def _size(finding, key):
    """(value, standard error) of a Finding's size; nothing is as uncertain as the others."""
    value = finding.value.get(key, 0.0)
    interval = (finding.interval or {}).get(key)
    if interval is not None and interval[1] > interval[0]:
        return value, float(np.hypot((interval[1] - interval[0]) / 2.0 / odds.Z_90,
                                     hypotheses.SHAPE * value))
    return value, RAW * max(abs(v) for v in finding.value.values())


def read(sessions, settings):
    """Simulator from its Sessions."""
    diagnosis = stages.diagnose_sessions(sessions, settings, beside=True)
    known = {kind: _known(gap) for kind, gap in diagnosis.gaps.items() if gap.chosen}
    return Simulator(diagnosis, known, tuple(_remarks(diagnosis, registers.stuck(sessions))))


def _known(gap):
    """[(effect, variant, key, coefficient)] of what a SensorGap has with a name."""
    every = [(d.effect, d.variant, key) for d in gap.units[0].designs for key in d.keys]
    return [(*every[column], float(t)) for column, t in zip(gap.shared.index, gap.coefficients())]


def _remarks(diagnosis, constant):
    """Sentences on what the simulator's Diagnosis shows, and cannot show, but for those on its
    constant axes: one without noise is constant where nothing moves, which both logs tell."""
    remarks = [] if diagnosis.gaps else ["the simulator's capture holds too few poses: of the "
                                         "effects, only steps, lines and timing are compared"]
    if diagnosis.causes:
        names = sorted({c.effect for _, c in diagnosis.causes})
        remarks.append("the simulator already has: " + ", ".join(names))
    remarks += ["the simulator's log: " + x for x in diagnosis.remarks if x not in constant]
    silent = sorted({u["effect"] for u in detectable.listed(diagnosis)})
    return remarks + ["effects that the simulator's log cannot show: " + ", ".join(silent)] * bool(
        silent and diagnosis.gaps)


def in_both(diagnosis):
    """{sensor: [(effect, variant, key, coefficient)]} of the causes of a Diagnosis that two logs
    of one motion show to be in the simulator as well: of what such a cause adds to the real
    readings, nothing is in their difference. Each log by itself may take one effect for several,
    and not alike, which is no gap between them."""
    shared = {}
    for kind, gap in diagnosis.gaps.items():
        fits = [comparison.fits[kind] for comparison in diagnosis.comparisons
                if kind in comparison.fits]
        for cause in gap.causes if fits else ():
            if all(_is_in_both(kind, fit, cause, diagnosis) for fit in fits):
                shared.setdefault(kind, []).extend(_coefficients(gap, cause))
    return shared


def not_compared(known, comparisons):
    """known {sensor: [(effect, variant, key, coefficient)]} of a simulator's own rests without the
    effects of which two logs of one motion tell whether they are in both: a size that the
    simulator's rests give has an error, and taken off the real ones it leaves that behind."""
    fitted = {kind for comparison in comparisons for kind, fit in comparison.fits.items()
              if fit.hypothesis.name}
    return {kind: [one for one in sizes if kind not in fitted or one[0] not in _compared_by(kind)]
            for kind, sizes in known.items()}


def _compared_by(kind):
    """Names of the effects that two logs of one motion are compared by (in_both)."""
    return (*terms.of_the_moment(kind), "box_tilt")


def _coefficients(gap, cause):
    """[(effect, variant, key, coefficient)] of a cause of a SensorGap."""
    every = [(d.effect, d.variant, key) for d in gap.units[0].designs for key in d.keys]
    columns = columns_of(cause.chosen).index
    return [(*every[column], float(size)) for column, size in zip(columns, cause.theta)]


def _is_in_both(kind, sensor_fit, cause, diagnosis):
    if sensor_fit.hypothesis.name == "" or cause.effect not in _compared_by(kind) or (
            not cause.value):
        return False
    acting = design(kind, cause.effect, cause, sensor_fit.pair, diagnosis)
    added = acting.columns @ [cause.value.get(key, 0.0) for key in acting.keys]
    whole = replace(acting, keys=["share"], columns=added[:, None], prior=np.ones(1))
    level = np.sqrt(2.0) * adequacy.usual(diagnosis.sessions[0].capture.meta["sensor"], kind)
    (share,), (sigma,) = of_fit(fit_with(sensor_fit, [whole]), [whole], 0, level,
                                sensor_fit.pair.t)
    return bool(abs(share) < BOTH * sigma < abs(1.0 - share))
