"""Captures without poses: what one rest, or rests in one attitude, can say.

Drift from the wandering of short means, temperature from rests of one attitude at different
temperatures; lines, steps, rails and rate are looked for elsewhere, in every capture.
"""
import numpy as np
from scipy import stats

from ..simulating.signal_measures import allan
from . import adequacy
from .finding import Finding

SAME_DEG = 3.0
FEWEST_C = 1.0
LEAST_T = 5.0  # standard deviations
PARTS = 12
BETWEEN_MG = 0.3  # what a rest differs by from the next for no reason: flicker over minutes
STRAIGHT = 0.9  # share of the scatter that a straight line must take


class SingleRest:
    """findings (list of Finding), remarks (sentences)."""

    def __init__(self, sessions, settings):
        self.findings, self.remarks = [], []
        rests = [(s, longest(s)) for s in sessions]
        rests = [(s, r) for s, r in rests if r is not None]
        if not rests:
            self.remarks.append("no rest found: only what shows in motion can be judged")
            return
        for sensor in ("accel", "gyro"):
            if any(getattr(s.capture, sensor) is None for s, _ in rests):
                continue
            self._drift(sensor, rests, settings)
        self._temperature(rests)

    def _drift(self, sensor, rests, settings):
        """Allan deviation at a twelfth of the rest against white noise and allowed flicker."""
        session = rests[0][0]
        chip = session.capture.meta["sensor"]
        allowed = adequacy.allowance(chip, sensor, settings.reference.get(sensor))
        seen = []
        for one, (first, end) in rests:
            x = scaled(one, sensor)[first:end]
            m = max(1, len(x) // PARTS)
            tau = m / one.rate
            if tau < 1.0:
                continue
            white = (one.noise_accel if sensor == "accel" else one.noise_gyro) / np.sqrt(tau)
            floor = np.sqrt(white ** 2 + allowed ** 2)  # the level is about the Allan floor
            seen.append((allan(x, m), floor, tau))
        if not seen:
            return
        ratio = np.median([(a / f) ** 2 for a, f, _ in seen], axis=0)
        # An overlapping Allan variance of 12 averages has some 10 degrees of freedom.
        p = stats.chi2.sf(ratio * 10.0 * len(seen), 10.0 * len(seen))
        axes = [i for i in range(3) if p[i] < 1e-3 and ratio[i] > 2.5]
        if axes:
            value = {"xyz"[i]: float("%.3g" % np.median([a[i] for a, _, _ in seen]))
                     for i in axes}
            half = 1.645 / np.sqrt(2 * 10.0 * len(seen))
            self.findings.append(Finding(
                "drift", sensor, sorted(value), value, "mg" if sensor == "accel" else "deg/s",
                float(-np.log(max(p.min(), 1e-300))), "time",
                "the reading wanders by itself over %.0f s" % seen[0][2],
                {k: (v * (1 - half), v * (1 + half)) for k, v in value.items()},
                {"thermal_bias": "temperature", "warm_up": "time"} if self._warms(rests) else {}))

    def _warms(self, rests):
        return any(s.thermometer is not None and s.thermometer.moved > FEWEST_C
                   for s, _ in rests)

    def _temperature(self, rests):
        """Slopes over rests in one attitude at different temperatures."""
        if len(rests) < 3 or any(s.thermometer is None for s, _ in rests):
            return
        means = np.array([scaled(s, "accel")[a:b].mean(axis=0) for s, (a, b) in rests])
        up = means / np.linalg.norm(means, axis=1)[:, None]
        if np.degrees(np.arccos(np.clip(up @ up[0], -1, 1))).max() > SAME_DEG:
            return
        t = np.array([s.thermometer.c.mean() for s, _ in rests])
        if np.ptp(t) < FEWEST_C:
            return
        vertical = int(np.abs(up[0]).argmax())
        for axis in range(3):
            self._slope(rests, t, means[:, axis], axis, axis == vertical)

    def _slope(self, rests, t, values, axis, vertical):
        """One axis against the temperature; across gravity a mount that gives looks alike."""
        design = np.stack([np.ones(len(t)), t - t.mean()], 1)
        slope = float(np.linalg.lstsq(design, values, rcond=None)[0][1])
        white = np.median([s.noise_accel[axis] / np.sqrt(max(1.0, s.t_s[-1])) for s, _ in rests])
        sigma = float(np.hypot(white, BETWEEN_MG))
        error = sigma / np.sqrt(((t - t.mean()) ** 2).sum())
        left = values - values.mean() - slope * (t - t.mean())
        straight = 1.0 - (left ** 2).sum() / max(((values - values.mean()) ** 2).sum(), 1e-12)
        if abs(slope) < LEAST_T * error or straight < STRAIGHT:
            return
        key, why = "xyz"[axis], "rests in one attitude"
        rivals = {"thermal_scale": why} if vertical else {"table_tilt": why}
        rivals.update({"warm_up": why, "drift": why})
        self.findings.append(Finding(
            "thermal_bias", "accel", [key], {key: slope}, "mg/degC",
            0.5 * (slope / error) ** 2, "temperature", "it follows the temperature",
            {key: (slope - 1.645 * error, slope + 1.645 * error)}, rivals))


def longest(session):
    """(first, end) of the longest rest, or None."""
    if not session.runs:
        return None
    _, first, end = max(session.runs, key=lambda r: r[2] - r[1])
    return first, end


def scaled(session, sensor):
    """Samples in mg or deg/s."""
    meta = session.capture.meta
    counts = getattr(session.capture, sensor).astype(float)
    return counts * (1000.0 / meta["accel_lsb_per_g"]) if sensor == "accel" \
        else counts / meta["gyro_lsb_per_dps"]
