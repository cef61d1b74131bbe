"""The smallest size of each effect that a planned capture would show, at 80 % power; and what the
captures at hand of a diagnosis could not show, effect by effect, and why.

Generalised least squares with the covariance that the diagnosis has (experiment/covariance.py), of
known variances: white noise over the samples of a row, the scatter of a placement by hand (two
small turns), flicker. The unit of replication is the placement, never the sample (GAP finding 3).
"""
import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS, NAMES

from ..experiment import covariance
from ..experiment.projection import basis, without
from .alias import PlannedModel

PLACEMENT_DEG = 0.05  # scatter of placing a box by hand (METHOD section 1)
FLIP_DEG = 0.4  # error of a half turn by hand (METHOD section 2)
POWER_80 = NormalDist().inv_cdf(0.8)  # standard deviations beyond a cutoff: seen in 80 %
# Two-sided 5 % over 12 tests (Bonferroni), and 80 % power.
QUANTILE = NormalDist().inv_cdf(1.0 - 0.05 / 2.0 / 12.0) + POWER_80
SILENT = math.inf
MG_PER_RAD = 1000.0  # of gravity, across it
ABSORBED = {
    "cubic": "absorbed by scale", "local_gravity": "absorbed by scale",
    "quadratic": "absorbed by bias and box", "cross_quadratic": "absorbed by misalignment and box",
    "asymmetry": "absorbed by scale and box", "supply": "absorbed by bias: no voltage is recorded",
    "table_tilt": "a nuisance of every session, fitted and taken off",
    "box_tilt": "the box is certified", "thermal_bias": "absorbed by bias and box",
    "thermal_scale": "absorbed by scale", "thermal_rate": "absorbed by bias",
    "warm_up": "absorbed by bias", "hysteresis": "absorbed by bias and box",
    "creep": "absorbed by bias", "g_sensitivity": "absorbed by bias",
    "vibration_rectification": "absorbed by bias: nothing vibrated, or all the time",
    "earth_rate": "a nuisance: below the noise, or not told from g_sensitivity",
    "lever_arm": "needs rests in several poses, a gyro and a dozen turns between rests",
    "filter_lag": "needs rests in several poses, a gyro and a dozen turns between rests",
    "saturation": "no sample came near a rail; a rounded one is odd and absorbed by scale"}
STILL_ONLY = {"gyro": ("thermal_scale", "quadratic", "cubic", "asymmetry", "saturation")}
ALWAYS_SEEN = ("quantisation", "dead_band", "torn_reads", "dropped_samples", "sample_rate",
               "vibration", "axis_swap", "drift")
NOT_DETERMINED = "this capture does not determine its size"


@dataclass(frozen=True, eq=False)
class Power:
    """A PlannedModel (design) and the covariance of each session's rows: factors, list of (places
    of its rows, covariance.Factor); space (3n, r) is an orthonormal basis of what the nominal
    parameters take up of rows of equal, independent noise."""

    design: PlannedModel
    factors: list
    space: np.ndarray

    def whitened(self, columns):
        """(3n, k): columns (3n, k) in rows of equal, independent noise."""
        return _whitened(self.factors, columns)

    def smallest(self, name):
        """{key: smallest size seen with 80 % power}; SILENT where nothing of it is left."""
        keys, columns = self.design.raw(name)
        space = self.space
        if name in self.design.own:  # a nuisance itself: measured beside the others
            space = basis(self.whitened(self.design.without_own(name).space))
        white = self.whitened(columns)
        left = without(space, white)
        sizes = {}
        for j, key in enumerate(keys):
            norm, before = np.linalg.norm(left[:, j]), np.linalg.norm(white[:, j])
            seen = before > 0 and norm > 1e-6 * before
            sizes[key] = float(QUANTILE / norm) if seen else SILENT
        return sizes

    def smallest_flicker(self):
        """Level of flicker on top of the white noise and the placements that would be told
        from them: the variance's standard error from its Fisher information."""
        n = 3 * self.design.rows.n
        kernel = np.zeros((n, n))
        for places, factor in self.factors:
            kernel[np.ix_(places, places)] = covariance.components(factor.groups)[2]
        white = self.whitened(self.whitened(kernel).T)
        left = white - self.space @ (self.space.T @ white)
        left = left - (left @ self.space) @ self.space.T
        information = 0.5 * (left ** 2).sum()
        return math.sqrt(QUANTILE / math.sqrt(information)) if information > 0 else SILENT


def power_of(design, chip, rate_hz=100.0, step=0.0):
    """Power of a PlannedModel read by a chip (a key of typical.NOISE) at rate_hz; step: size of
    a count, mg or deg/s."""
    noise = np.array(typical.noise_at(chip, rate_hz, step))
    factors = []
    for session in np.unique(design.rows.session):
        own = np.flatnonzero(design.rows.session == session)
        groups = _groups(design, own, noise ** 2 / rate_hz)
        places = (3 * own[:, None] + np.arange(3)).ravel()
        factors.append((places, covariance.Factor(groups, [1.0], typical.FLICKER[chip])))
    return Power(design, factors, basis(_whitened(factors, design.space)))


def _whitened(factors, columns):
    white = np.empty_like(columns)
    for places, factor in factors:
        white[places] = factor.whitened(columns[places])[0]
    return white


def _groups(design, own, density):
    """list of covariance.Group of the rows `own` of one session: of each placement, and of the
    turn before it. density (3,): of white noise, mg2 s or (deg/s)2 s."""
    rows, parts = design.rows, []
    for placement in np.unique(rows.placement[own]):
        places = np.flatnonzero(rows.placement[own] == placement)
        mine = own[places]
        white = np.diag((density / rows.seconds[mine][:, None]).ravel())
        parts.append((slice(places[0], places[-1] + 1), white, _by_hand(design, placement, mine),
                      np.eye(3 * len(mine))))
    return covariance.in_time(rows.at.t[own], rows.seconds[own], np.ones(3), parts)


def _by_hand(design, placement, mine):
    """(3k, q) what a hand's placement and its half turn add to the k rows of a placement, each
    of a standard deviation of 1."""
    if design.sensor == "accel":
        own = (3 * mine[:, None] + np.arange(3)).ravel()
        return math.radians(PLACEMENT_DEG) * MG_PER_RAD * design.tilts_of(placement)[own]
    # An error of the angle is seen as a rate along the axis turned about.
    error = np.where(design.rows.rest[mine], 0.0, FLIP_DEG / design.rows.seconds[mine])
    return (error[:, None] * np.stack(design.rows.at.up, 1)[mine]).reshape(-1, 1)


def middle(sizes):
    """The median over the coefficients; SILENT when half of them are."""
    values = sorted(sizes.values())
    return values[(len(values) - 1) // 2] if values else SILENT


def listed(diagnosis):
    """[{effect, reason}] in the order of the library; an effect seen by one sensor is left out
    for the other only with the sensor named."""
    unseen, named = [], _named(diagnosis)
    for name in NAMES:
        for sensor in sorted(EFFECTS[name].units):
            if name in ALWAYS_SEEN or (name, sensor) in named:
                continue
            why = why_unseen(diagnosis, name, sensor)
            if why:
                unseen.append({"effect": name, "sensor": sensor, "reason": why})
    return unseen


def _named(diagnosis):
    names = {(n, kind) for kind, c in diagnosis.causes for n in c.names}
    return names | {(f.effect, f.sensor) for f in diagnosis.findings}


def why_unseen(diagnosis, name, sensor):
    """Why an effect could not have been seen; "" when it could, and of a sensor that is not
    there."""
    if sensor != "device" and any(getattr(s.capture, sensor) is None for s in diagnosis.sessions):
        return ""
    if name in ("lever_arm", "filter_lag"):
        return in_motion(diagnosis, name, sensor)
    if sensor == "device" or name in ("supply", "table_tilt", "earth_rate", "local_gravity"):
        return ABSORBED.get(name, "")
    gap = diagnosis.gaps.get(sensor)
    if gap is None:
        if sensor in diagnosis.rest:
            return diagnosis.rest[sensor].reason(name)
        return "needs rests in several poses"
    if name == "saturation" and sensor == "accel":
        return ABSORBED[name]
    if name in STILL_ONLY.get(sensor, ()):
        if diagnosis.turns is None:
            return "needs turns between the poses: the gyro was judged at rest"
        gap = diagnosis.turns
    if name == "box_tilt":
        return "the box is certified" if diagnosis.settings.certified else ""
    if name.startswith("thermal") and any(s.temperature is None for s in gap.sessions):
        return "no temperature column"
    mine = [o for o in gap.options if o.effect == name and not o.record]
    if not mine:
        return "silent: " + ABSORBED.get(name, "nothing of it is left")
    smallest = least_that_shows(gap, mine)
    usual = typical.size(name, gap.chip, sensor)[0]
    if not typical.determined(smallest, usual):
        return NOT_DETERMINED
    if usual and smallest > abs(usual):
        return "too small for this capture: from %.2g %s on, typical is %.2g" % (
            smallest, EFFECTS[name].units[sensor], abs(usual))
    return ""


def in_motion(diagnosis, name, sensor):
    """reason() of the effects that act in motion only."""
    if sensor == "device":
        return "both sensors are late together: shows only against a reference outside"
    motion = diagnosis.motion
    if motion is None or not motion.seen:
        return ABSORBED[name]
    if name == "lever_arm" and motion.one_hand:
        return "turned in the air: the hand's grip or the box, flips on a table tell"
    smallest, usual = motion.least(name), typical.size(name, motion.chip, sensor)[0]
    if smallest <= usual:
        return ""
    if not typical.determined(smallest, usual):
        return NOT_DETERMINED
    return "hidden by the hand's own acceleration: from %.2g %s on, typical is %.2g" % (
        smallest, EFFECTS[name].units[sensor], usual)


def least_that_shows(gap, options):
    """Smallest size that would show: the middle one of the coefficients, the best variant."""
    columns = max(options, key=lambda o: len(o.columns)).columns
    information = np.zeros(len(columns))
    for unit, index in zip(gap.units, gap.levels()):
        information += np.diag(unit.gram.at(index, columns))
    sizes = np.sort(QUANTILE / np.sqrt(np.maximum(information, 1e-300)))
    return float(sizes[(len(sizes) - 1) // 2])


def visible_share(diagnosis):
    """Share of the effects of rests whose typical size the captures would have shown."""
    seen = total = 0
    for sensor in diagnosis.gaps:
        for name in NAMES:
            if sensor not in EFFECTS[name].units or name in ALWAYS_SEEN or name in (
                    "lever_arm", "supply", "table_tilt", "earth_rate", "local_gravity",
                    "filter_lag", "saturation", "vibration_rectification", "box_tilt"):
                continue
            if name in STILL_ONLY.get(sensor, ()) or name in ("thermal_rate", "asymmetry"):
                continue
            total += 1
            seen += not why_unseen(diagnosis, name, sensor)
    return seen / max(total, 1)
