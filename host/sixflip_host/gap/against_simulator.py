"""The user's own simulator: the gap is what the real sensor has and that simulator lacks.

SIM.csv is diagnosed like a real capture. What it models is taken off the real sessions at their
own poses, times and temperatures, so scenes need not be the same; what both have in their
registers, timing or spectrum is no gap. What it has and the real sensor lacks is a gap as well.
"""
import numpy as np

from . import diagnosis as stages
from . import observations, which

ALIKE = 0.3  # relative difference of a size below which two findings are the same
NOISE_OFF = 1.25  # ratio of white noise beyond which it is said


class Simulator:
    """known: {sensor: [(effect, variant, key, coefficient)]}; findings of the simulator;
    noise: {sensor: (3,) of a second}; remarks."""

    def __init__(self, sessions, settings):
        same = stages.Settings(settings.certified, settings.without, settings.reference,
                               settings.jobs)
        self.found = stages.Diagnosis(sessions, same)
        self.known, self.remarks = {}, []
        self.reference_c = same.reference_c
        for kind, gap in self.found.gaps.items():
            if not gap.chosen:
                continue
            columns = np.concatenate([c.columns for c in gap.chosen])
            prior = np.concatenate([c.prior for c in gap.chosen])
            theta = which.coefficients(which.fits(gap.data, columns, prior), prior)[0][0]
            every = [(d.effect, d.variant, key) for d in gap.units[0].designs for key in d.keys]
            self.known[kind] = [(*every[column], float(t)) for column, t in zip(columns, theta)]
        if not self.found.gaps:
            self.remarks.append("the simulator's capture holds too few poses: only its noise, "
                                "steps, lines and timing are compared")
        names = sorted({c.effect for _, c in self.found.causes})
        if names:
            self.remarks.append("the simulator already has: " + ", ".join(names))

    def new(self, finding):
        """True when the simulator lacks a Finding of the real sensor, or has another size."""
        for other in self.found.findings:
            if (other.effect, other.sensor) != (finding.effect, finding.sensor):
                continue
            keys = set(other.value) | set(finding.value)
            pairs = [(other.value.get(k, 0.0), finding.value.get(k, 0.0)) for k in keys]
            if all(abs(a - b) <= ALIKE * max(abs(a), abs(b)) for a, b in pairs):
                return False
        return True

    def only_simulated(self, findings):
        """Findings of the simulator that the real sensor does not show."""
        real = {(f.effect, f.sensor) for f in findings}
        return [f for f in self.found.findings if (f.effect, f.sensor) not in real]

    def noise_remarks(self, sessions):
        """Sentences on white noise that differs."""
        out = []
        for kind in ("accel", "gyro"):
            ours = _noise(sessions, kind)
            theirs = _noise(self.found.sessions, kind)
            if ours is None or theirs is None:
                continue
            ratio = float(np.median(theirs / np.maximum(ours, 1e-12)))
            if not 1.0 / NOISE_OFF < ratio < NOISE_OFF:
                out.append("the simulator's %s is %.2g times as noisy as the real one" % (
                    "accelerometer" if kind == "accel" else "gyro", ratio))
        return out


def _noise(sessions, kind):
    values = [getattr(s, "noise_" + kind) for s in sessions if s.n and hasattr(s, "noise_" + kind)]
    return np.median(values, axis=0) if values else None


def read(captures, paths, settings):
    """Simulator from captures."""
    return Simulator([observations.Session(p, c) for p, c in zip(paths, captures)], settings)
