"""A level at which the real sensor stops, within its noise or softly, while the simulator of the
same motion goes on: a front end that saturates before the converter does. A log by itself does not
tell it from a motor that comes to one rate again and again.
"""
from dataclasses import replace

import numpy as np

from ..detect.codes import number_of_runs
from .evidence_of_logs import shifted
from .hypotheses import DEG
from .pairing import GRID_HZ
from .parameters import MG, Parameter

# Times the largest reading, that the simulator goes beyond it: more than a gyro's scale is off
# (6 %, ITG-3205 PS). Share of the simulator's rise there that the readings may have: a filter
# takes the same part of all of a peak.
BEYOND, RISES = 1.08, 0.5
NEAR = 0.85  # of the largest reading: what is read there, not what two kinds of shaking leave
AT = 0.95  # of a stop: by as much the band that is compared rounds it off
OVER = 0.7  # of the readings at a stop are beyond it in the simulator; of a steady rate half are
FEWEST, PEAKS = 15, 2  # samples (at pairing.GRID_HZ) and peaks beyond, to both sides together


def stops(fits):
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
    return level if level > NEAR * top and rises[0, 1] < RISES * rises[1, 1] else None


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
