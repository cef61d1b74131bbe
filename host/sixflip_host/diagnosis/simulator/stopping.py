"""Where a channel of one of two logs of one motion does not go beyond something that the other one
does: its range ends there, or a front end levels off, or a driver holds it.
"""
from dataclasses import dataclass, replace

import numpy as np

from ...capture.registers import number_of_runs
from .evidence_of_logs import shifted
from .pairing import GRID_HZ
from .parameters import MG, Parameter
from .sensor_axes import DEG

# Times the largest reading, that the other log goes beyond it: more than a gyro's scale is off
# (6 %, ITG-3205 PS). Share of the other's rise there that the readings may have, and of its
# spread (a quarter of it was measured at stops, hard and soft): a filter takes the same part of
# all of a peak.
BEYOND, RISES = 1.08, 0.5
NEAR = 0.85  # of the largest reading: what is read there, not what two kinds of shaking leave
AT = 0.95  # of a stop: by as much the band that is compared rounds it off
OVER = 0.7  # of the readings at a stop are beyond it in the other; of a steady rate half are
FEWEST, PEAKS = 15, 2  # samples (at pairing.GRID_HZ) and peaks beyond, to both sides together


@dataclass(frozen=True)
class Stop:
    """log: "real" or "sim", the channel of which does not go beyond level, m/s2 or rad/s; kind and
    axis (0..2) of the channel."""

    log: str
    kind: str
    axis: int
    level: float

    def readings(self, trace):
        """(n,) sizes of what a Trace reads there."""
        return np.abs((trace.force if self.kind == "accel" else trace.rate)[:, self.axis])


def found(fits):
    """(Stop, ...) of {sensor: conventions.SensorFit}."""
    stops = []
    for kind, sensor_fit in fits.items():
        fit = sensor_fit.fit
        if fit.unit != 1.0 or not np.array_equal(fit.axes, np.eye(3)):
            continue
        real = shifted(sensor_fit.pair.real(kind), fit.delay_s * GRID_HZ)
        simulated = sensor_fit.pair.simulated(kind)
        for log, own, other in (("real", real, simulated), ("sim", simulated, real)):
            for axis in range(3):
                level = level_of(own[:, axis], other[:, axis])
                if level is not None:
                    stops.append(Stop(log, kind, axis, level))
    return tuple(stops)


def level_of(own, other):
    """What a channel (n,) stops at where the other's goes beyond the largest of it, or None."""
    top = np.abs(own).max()
    beyond = (np.abs(other) > BEYOND * top) & (own * other > 0.0)
    if beyond.sum() < FEWEST or number_of_runs(beyond) < PEAKS:
        return None
    rises = np.cov(np.abs(own[beyond]), np.abs(other[beyond]))
    level = float(np.median(np.abs(own[beyond])))
    # A motor that comes to its rate, in the other log after going beyond it, stays there longer.
    there = np.abs(own) > AT * level
    if (np.abs(other[there]) > level).mean() < OVER:
        return None
    # At a steady rate both vary by their noise alone, which rises with nothing.
    still = np.sqrt(rises[0, 0]) < RISES * np.sqrt(rises[1, 1])
    return level if level > NEAR * top and still and rises[0, 1] < RISES * rises[1, 1] else None


def marked(trace, stops, log):
    """The Trace with what reaches the Stops of its log marked as at the end of what it can say."""
    railed = trace.railed.copy()
    for stop in stops:
        if stop.log == log:
            railed |= stop.readings(trace) > NEAR * stop.level
    return replace(trace, railed=railed)


def ranges(stops, real, sim):
    """[Parameter] of the Stops: the median of what the Trace that stops reads from AT of them on,
    and by how much the other Trace goes beyond it. Of a simulator that stops the real range is not
    known, but for being as wide."""
    numbers = []
    for stop in stops:
        scale, unit = (MG, "mg") if stop.kind == "accel" else (DEG, "°/s")
        logs = (real, sim) if stop.log == "real" else (sim, real)
        own, other = (stop.readings(log) for log in logs)
        level = scale * float(np.median(own[own > AT * stop.level]))
        beyond, place = scale * float(other.max()), (stop.kind, "xyz"[stop.axis], unit)
        numbers.append(
            Parameter("range", *place, level, None, None, None, level - beyond, None, True, level)
            if stop.log == "real" else
            Parameter("range", *place, None, None, level, None, beyond - level, None, True, None,
                      "let it go on: the real one reads up to %.4g %s" % (beyond, unit)))
    return numbers
