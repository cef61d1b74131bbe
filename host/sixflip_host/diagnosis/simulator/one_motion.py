"""Two logs as they are compared, and what those of one motion show beside each other: each sensor
fitted with the convention, the stops of the real one and its dead bands that suit them best.

A stop is a level that the real sensor does not go beyond, within its noise or softly, while the
simulator of the same motion goes on: a front end that saturates before the converter does. A log
by itself does not tell it from a motor that comes to one rate again and again. Nor does it tell
whether a dead band is the gyro's or that of what turns the thing: its forces may.
"""
from dataclasses import dataclass, replace

import numpy as np

from ...capture.registers import number_of_runs
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
    timing,
    traces,
    transfer,
)
from .evidence_of_logs import shifted
from .pairing import GRID_HZ
from .parameters import MG, Parameter
from .sensor_axes import DEG, left_of

# Times the largest reading, that the simulator goes beyond it: more than a gyro's scale is off
# (6 %, ITG-3205 PS). Share of the simulator's rise there that the readings may have, and of its
# spread (a quarter of it was measured at stops, hard and soft): a filter takes the same part of
# all of a peak.
BEYOND, RISES = 1.08, 0.5
NEAR = 0.85  # of the largest reading: what is read there, not what two kinds of shaking leave
AT = 0.95  # of a stop: by as much the band that is compared rounds it off
OVER = 0.7  # of the readings at a stop are beyond it in the simulator; of a steady rate half are
FEWEST, PEAKS = 15, 2  # samples (at pairing.GRID_HZ) and peaks beyond, to both sides together


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
    same without; stops (stops_of); bands (dead_zone.Band, ...); of_gyro: nats by which it is the
    gyro that has them; late, late_sigma: s of the simulator's gyro, or None; smoothed
    {sensor: timing.Smoothness}; conventions:
    [Convention] that the pair shows."""

    fits: dict
    unmended: dict
    stops: dict
    bands: tuple
    of_gyro: float
    late: float
    late_sigma: float
    smoothed: dict
    conventions: list


NOTHING = OneMotion({}, {}, {}, (), 0.0, None, None, {}, [])


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
    stops = stops_of(fits)
    if stops:
        real = marked(real, stops)
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


def stops_of(fits):
    """{(sensor, axis): m/s2 or rad/s that the real channel does not go beyond} of {sensor:
    conventions.SensorFit}, where the simulator's does."""
    found = {}
    for kind, sensor_fit in fits.items():
        fit = sensor_fit.fit
        if fit.unit != 1.0 or not np.array_equal(fit.axes, np.eye(3)):
            continue
        real = shifted(sensor_fit.pair.real(kind), fit.delay_s * GRID_HZ)
        for axis in range(3):
            stop = stop_of(real[:, axis], sensor_fit.pair.simulated(kind)[:, axis])
            if stop is not None:
                found[kind, axis] = stop
    return found


def stop_of(real, simulated):
    """What real (n,) stops at where simulated goes beyond the largest of it, or None."""
    top = np.abs(real).max()
    beyond = (np.abs(simulated) > BEYOND * top) & (real * simulated > 0.0)
    if beyond.sum() < FEWEST or number_of_runs(beyond) < PEAKS:
        return None
    rises = np.cov(np.abs(real[beyond]), np.abs(simulated[beyond]))
    level = float(np.median(np.abs(real[beyond])))
    # A motor that comes to its rate, in the simulator after going beyond it, stays there longer.
    there = np.abs(real) > AT * level
    if (np.abs(simulated[there]) > level).mean() < OVER:
        return None
    # At a steady rate both vary by their noise alone, which rises with nothing.
    still = np.sqrt(rises[0, 0]) < RISES * np.sqrt(rises[1, 1])
    return level if level > NEAR * top and still and rises[0, 1] < RISES * rises[1, 1] else None


def marked(trace, found):
    """The Trace with what reaches the stops() found marked as at the end of what it can say."""
    railed = trace.railed.copy()
    for (kind, axis), stop in found.items():
        values = (trace.force if kind == "accel" else trace.rate)[:, axis]
        railed |= np.abs(values) > NEAR * stop
    return replace(trace, railed=railed)


def ranges(found, real, sim):
    """[Parameter] of the stops() found: the median of what the real Trace reads from AT of them
    on, and by how much the simulator's Trace goes beyond it."""
    numbers = []
    for (kind, axis), stop in found.items():
        scale, unit, name = (MG, "mg", "force") if kind == "accel" else (DEG, "°/s", "rate")
        ours, theirs = (np.abs(getattr(trace, name)[:, axis]) for trace in (real, sim))
        level = scale * float(np.median(ours[ours > AT * stop]))
        numbers.append(Parameter("range", kind, "xyz"[axis], unit, level, None, None, None,
                                 level - scale * float(theirs.max()), None, True, level))
    return numbers


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
