"""Stage 0: what the registers and the clock tell without statistics of rests.

Steps (common divisor), dead band, torn reads, rails, clipped peaks, repeated and dropped
samples, the true rate, axes swapped or inverted.
"""
import numpy as np

from ...capture import registers
from . import axis_order, codes, sample_clock, saturation, torn_reads
from .detection import Finding, present


def findings(sessions):
    """list of Finding over all sessions."""
    found = []
    for sensor in ("accel", "gyro"):
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None for c in columns):
            continue
        found += _per_axis("quantisation", sensor, [registers.steps(c) for c in columns],
                           [codes.step_nats(c) for c in columns], "counts come in steps",
                           [codes.distinct(c) for c in columns])
        band = _per_axis("dead_band", sensor, [registers.dead_band(c) for c in columns],
                         [codes.band_nats(c) for c in columns], "counts near 0 read 0",
                         [codes.zeros(c) for c in columns])
        found += band + saturation.saturation(sessions, sensor, columns)
        found += torn_reads.finding(sessions, sensor,
                                    ["xyz".index(a) for f in band for a in f.axes])
    return found + sample_clock.findings(sessions) + axis_order.swapped(sessions)


def _per_axis(effect, sensor, sizes, nats, words, numbers):
    """One Finding of what all sessions agree on, axis by axis (3,) in counts; 0 is nothing;
    nats (3,) of each session; numbers (3,): of codes, or of runs of zeros. There is no sample
    that does otherwise: it is all of the gap."""
    least, total = np.min(sizes, axis=0), np.sum(nats, axis=0)
    axes = [i for i in range(3) if least[i] > 1 and present(total[i])]
    if not axes:
        return []
    value = {"xyz"[i]: int(least[i]) for i in axes}
    number = int(np.sum(numbers, axis=0)[axes].sum())
    return [Finding(effect, sensor, ["xyz"[i] for i in axes], value, "counts",
                    sum(total[i] for i in axes), "amplitude", words,
                    {k: (v, v) for k, v in value.items()}, share=1.0, number=number)]
