"""Two logs as they are compared, and what those of one motion show beside each other: each sensor
fitted with the convention, the stops of the real one and its dead bands that suit them best.

A stop is a level that the real sensor does not go beyond, within its noise or softly, while the
simulator of the same motion goes on: a front end that saturates before the converter does. A log
by itself does not tell it from a motor that comes to one rate again and again. Nor does it tell
whether a dead band is the gyro's or that of what turns the thing: its forces may.
"""
from dataclasses import dataclass, replace

import numpy as np

from . import (
    alignment,
    conventions,
    dead_zone,
    held_readings,
    hypotheses,
    motion_match,
    own_calibration,
    own_motion,
    pairing,
    parameters,
    single_log,
    stopping,
    timing,
    traces,
    transfer,
)
from .sensor_axes import left_of


@dataclass(frozen=True)
class Logs:
    """real, sim: Traces as they were read; real_free, sim_free: with straight lines over rows that
    say nothing new; holds {"real" or "sim": {sensor: held_readings.Hold}}; aligned
    (alignment.Alignment); live {sensor: (3,) bool} of the simulator's channels that answer;
    constant: [Convention] of those that do not; own_real (own_calibration.OwnSensor or None);
    motion (traces.Motion) of the real one where it is that of both, None otherwise; behind
    {sensor: low_pass.LowPass} that one of them has; unseen: sentences."""

    real: traces.Trace
    sim: traces.Trace
    real_free: traces.Trace
    sim_free: traces.Trace
    holds: dict
    aligned: alignment.Alignment
    live: dict
    constant: list
    own_real: own_calibration.OwnSensor
    motion: traces.Motion
    behind: dict
    unseen: tuple

    @property
    def row_s(self):
        """Of the slower log."""
        return 1.0 / min(self.real.rate_hz, self.sim.rate_hz)

    def smoothing_s2(self, kind):
        """Half the square of the time constant by which straight lines over rows of a sensor make
        the simulator's log smoother than the real one."""
        return held_readings.smoothing_s2(self.holds["sim"][kind], self.sim) \
            - held_readings.smoothing_s2(self.holds["real"][kind], self.real)


@dataclass(frozen=True)
class OneMotion:
    """fits {sensor: conventions.SensorFit}, with the simulator as its bands have it; unmended: the
    same without; stops (stopping.Stop, ...); bands (dead_zone.Band, ...); of_gyro: nats by which
    it is the gyro that has them; late, late_sigma: s of the simulator's gyro, or None; smoothed
    {sensor: timing.Smoothness}; conventions: [Convention] that the pair shows."""

    fits: dict
    unmended: dict
    stops: tuple
    bands: tuple
    of_gyro: float
    late: float
    late_sigma: float
    smoothed: dict
    conventions: list


NOTHING = OneMotion({}, {}, (), (), 0.0, None, None, {}, [])


def logs_of(real, sim, aligned):
    """The Logs of two Traces whose clocks lie as the Alignment says."""
    holds = {"real": held_readings.holds(real), "sim": held_readings.holds(sim)}
    sim_free = held_readings.free(sim, holds["sim"])
    real_free = held_readings.free(real, holds["real"])
    live, constant = single_log.constant_channels(real, sim)
    unseen = ()
    if aligned.by == "forces" and not single_log.turns(real) and not single_log.turns(sim):
        aligned = replace(aligned, turning=False)
        live = {**live, "gyro": np.zeros(3, bool)}  # noise says nothing of the other log's
        unseen = ("%s of %s: nothing turns" % (", ".join(
            name.replace("_", " ") for name in hypotheses.IN_TURNS), sim.name),)
    aligned = replace(aligned, moving=aligned.same or not (
        single_log.lies_still(real) and single_log.lies_still(sim)))
    own_real, motion = own_calibration.fitted(real_free), None
    if aligned.same and own_real is not None:
        motion = traces.motion(own_real.applied(real_free))
    if motion is not None:
        same = motion_match.one_motion(real_free, sim_free, aligned, motion, live)
        aligned, motion = replace(aligned, same=same), motion if same else None
    behind = {}
    if motion is not None:
        logs = real_free, sim_free
        behind = transfer.between(*logs, aligned, motion, live)
        if behind:
            aligned = motion_match.paced(*logs, aligned, behind)
            behind = transfer.between(*logs, aligned, motion, live)
    return Logs(real, sim, real_free, sim_free, holds, aligned, live, constant, own_real, motion,
                behind, unseen)


def beside(logs):
    """OneMotion of Logs that have one."""
    fresh = {k: logs.sim.rate_hz / v.rows for k, v in logs.holds["sim"].items()}

    def fitted(real, sim):
        return conventions.same_motion(real, sim, logs.aligned, logs.motion, logs.live, fresh,
                                       logs.behind, logs.own_real)
    real, sim = logs.real_free, logs.sim_free
    fits = fitted(real, sim)
    stops = stopping.found(fits)
    if stops:
        real, sim = (stopping.marked(log, stops, which) for log, which in (
            (real, "real"), (sim, "sim")))
        fits = fitted(real, sim)
    unmended, of_gyro = fits, 0.0
    bands = dead_zone.found(fits, real, sim)
    if bands:
        fits = fitted(real, dead_zone.taken_off(sim, bands))
        of_gyro = nats_of_gyro(
            replace(real, force=logs.own_real.applied(real).force), sim, logs.aligned, fits)
    smoothed = timing.smoothness(fits, {kind: logs.smoothing_s2(kind) for kind in fits})
    late, late_sigma, delays = timing.delay(fits, logs.row_s, smoothed)
    shown = [c for f in fits.values() for c in f.conventions if not (
        logs.constant and c.name == "constant_channel")]
    shown += [held_readings.beside(c, sim.rate_hz, logs.holds["sim"]) for c in delays
              if own_motion.shown_late(sim, late)]
    return OneMotion(fits, unmended, stops, bands, of_gyro, late, late_sigma, smoothed, shown)


def nats_of_gyro(real, sim, aligned, fits):
    """How much likelier the forces are where the thing turned as the simulator's did, and the gyro
    did not answer, than where it turned as the gyro says: what turns it may not answer either.
    Gravity goes another way in the two, by a known course: of what the accelerometer's fit leaves
    of the simulator's forces that is all or nothing. 0 at most where the forces are not alike but
    for noise: then it moved otherwise, wherever it turned. fits: with the bands taken off."""
    accel, gyro = fits.get("accel"), fits["gyro"].fit
    if accel is None or accel.fit.unit != 1.0 or None in (real.noise["accel"], sim.noise["accel"]):
        return 0.0
    at = (real.t - aligned.offset_s) / (1.0 + aligned.drift)
    inside = ((at > 0.0) & (at < sim.seconds))[:, None]
    own = (real.rate - traces.rest_line(real, real.rate)) @ (np.eye(3) + gyro.shape).T
    turns = np.stack([np.interp(at, sim.t, x) for x in (
        sim.rate - traces.rest_line(sim, sim.rate)).T], 1)
    ups = [traces.motion(replace(real, rate=rate)).up for rate in (
        np.where(inside, turns, own), own)]
    pair = accel.pair
    course = real.g * pairing.at_times(real, ups[0] - ups[1], aligned.of_simulator(pair.t),
                                       pair.band_hz)
    design = np.column_stack([pair.force, np.ones(len(pair.t))])  # which the fit has, too
    left, course = (left_of(x, design) for x in (accel.fit.left, course))
    noise = dead_zone.in_band(real, sim, "accel", pair.band_hz)
    most = 0.0 if left.std() > parameters.TOGETHER * np.sqrt((noise ** 2).mean()) else np.inf
    power = max(float((course ** 2).sum()), 1e-30)
    share = float((left * course).sum()) / power
    rest = left - share * course
    variance = float((rest ** 2).mean()) * alignment.independent(rest) / power
    return min(most, (1.0 - 2.0 * share) / (2.0 * variance))
