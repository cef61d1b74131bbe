"""Two logs as they are compared, and what those of one motion show beside each other: each sensor
fitted with the convention, the stops of the real one and its dead bands that suit them best."""
from dataclasses import dataclass, replace

import numpy as np

from . import (
    alignment,
    conventions,
    dead_zone,
    gyro_or_motor,
    held_readings,
    hypotheses,
    levelled_off,
    own_calibration,
    own_motion,
    pairing,
    single_log,
    traces,
)


@dataclass(frozen=True)
class Logs:
    """real, sim: Traces as they were read; real_free, sim_free: with straight lines over rows that
    say nothing new; holds {"real" or "sim": {sensor: held_readings.Hold}}; aligned
    (alignment.Alignment); live {sensor: (3,) bool} of the simulator's channels that answer;
    constant: [Convention] of those that do not; own_real (own_calibration.OwnSensor or None);
    motion (traces.Motion) of the real one where it is that of both, None otherwise; unseen:
    sentences."""

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
    same without; stops (levelled_off.stops); bands (dead_zone.Band, ...); of_gyro: nats by which
    it is the gyro that has them; late, late_sigma: s of the simulator's gyro, or None;
    conventions: [Convention] that the pair shows."""

    fits: dict
    unmended: dict
    stops: dict
    bands: tuple
    of_gyro: float
    late: float
    late_sigma: float
    conventions: list


NOTHING = OneMotion({}, {}, {}, (), 0.0, None, None, [])


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
    own_real, motion = own_calibration.fitted(real_free), None
    if aligned.same and own_real is not None:
        motion = traces.motion(own_real.applied(real_free))
    if motion is not None:
        same = pairing.one_motion(real_free, sim_free, aligned, motion, live)
        aligned, motion = replace(aligned, same=same), motion if same else None
    return Logs(real, sim, real_free, sim_free, holds, aligned, live, constant, own_real, motion,
                unseen)


def beside(logs):
    """OneMotion of Logs that have one."""
    fresh = {k: logs.sim.rate_hz / v.rows for k, v in logs.holds["sim"].items()}

    def fitted(real, sim):
        return conventions.same_motion(real, sim, logs.aligned, logs.motion, logs.live, fresh)
    real, sim = logs.real_free, logs.sim_free
    fits = fitted(real, sim)
    stops = levelled_off.stops(fits)
    if stops:
        real = levelled_off.marked(real, stops)
        fits = fitted(real, sim)
    unmended, of_gyro = fits, 0.0
    bands = dead_zone.found(fits, real, sim)
    if bands:
        fits = fitted(real, dead_zone.taken_off(sim, bands))
        of_gyro = gyro_or_motor.nats_of_gyro(
            replace(real, force=logs.own_real.applied(real).force), sim, logs.aligned, fits)
    late, late_sigma, delays = own_motion.delay(fits, logs.row_s)
    shown = [c for f in fits.values() for c in f.conventions if not (
        logs.constant and c.name == "constant_channel")]
    shown += [held_readings.beside(c, sim.rate_hz, logs.holds["sim"]) for c in delays
              if own_motion.shown_late(sim, late)]
    return OneMotion(fits, unmended, stops, bands, of_gyro, late, late_sigma, shown)
