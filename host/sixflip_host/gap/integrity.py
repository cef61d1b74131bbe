"""Stage 0: what the registers and the clock tell without statistics of rests.

Steps (common divisor), dead band, torn reads, rails, clipped peaks, repeated and dropped
samples, the true rate, axes swapped or inverted.
"""
import numpy as np

from . import axis_order, counts, rails, sample_clock, torn_reads
from .finding import CERTAIN, Finding


def findings(sessions):
    """list of Finding over all sessions."""
    found = []
    for sensor in ("accel", "gyro"):
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None for c in columns):
            continue
        found += _per_axis("quantisation", sensor, [counts.steps(c) for c in columns],
                           "counts come in steps", "amplitude")
        found += _per_axis("dead_band", sensor, [counts.dead_band(c) for c in columns],
                           "counts near 0 read 0", "amplitude")
        found += rails.saturation(sessions, sensor, columns)
        found += torn_reads.finding(sessions, sensor, columns)
    return found + sample_clock.rate(sessions) + sample_clock.drops(sessions) \
        + axis_order.swapped(sessions)


def _per_axis(effect, sensor, sizes, words, domain):
    """One Finding of what all sessions agree on, axis by axis (3,) in counts; 0 is nothing."""
    least = np.min(sizes, axis=0)
    axes = [i for i in range(3) if least[i] > 1]
    if not axes:
        return []
    value = {"xyz"[i]: int(least[i]) for i in axes}
    return [Finding(effect, sensor, ["xyz"[i] for i in axes], value, "counts", CERTAIN, domain,
                    words, {k: (v, v) for k, v in value.items()})]
