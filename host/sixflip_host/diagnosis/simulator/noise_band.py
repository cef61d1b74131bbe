"""Layer two, how the noise at rest falls off towards the end of the band that both logs show: by
the upper octave beside the one below it. A chip's own filter takes noise away that a simulator
draws from row to row, and two logs of the same density are not of the same noise.

Octaves so high that a floor and a hand have nothing there; of each the median over its
frequencies, which no line moves, in all rests but those that shake more than others.
"""
from dataclasses import replace

import numpy as np

from . import single_log
from .parameters import MG, compared
from .sensor_axes import DEG
from .shaking import PIECE_S, SHOWS, pieces

FEWEST = 20  # pieces at rest, ten seconds: an octave of five frequencies is known to a tenth
SETTLING = 4.0  # times the usual power of a piece: it was touched
LEAST_HZ = 10.0  # where the lower octave begins: below are gaits and what sways
# Natural logarithm of power, by which two logs of one chip's noise may fall off otherwise: a tenth
# in size.
ALIKE = 0.2
# Relative standard error of a median over exponential ordinates, of which Hann's window makes
# one of one and a half [Percival & Walden, Spectral Analysis for Physical Applications (1993),
# section 6.6], times the root of their number: 1.25 times that of their mean.
OF_MEDIAN = 1.25 * np.sqrt(1.5)


def falls_off(real, sim):
    """[Parameter] of two Traces, one a sensor whose noise both show: the density of the upper
    octave, which differs where that of one log falls off from the lower one and the other's does
    not."""
    top = SHOWS * min(real.rate_hz, sim.rate_hz)
    if top / 4.0 < LEAST_HZ:
        return []
    numbers = []
    for kind, name in (("accel", "force"), ("gyro", "rate")):
        values = [getattr(log, name) for log in (real, sim)]
        if any(v is None for v in values):
            continue
        octaves = [_octaves(log, v, log.noise[kind], log.quantum[kind == "gyro"], top)
                   for log, v in zip((real, sim), values)]
        if None not in octaves:
            numbers.append(_parameter(kind, *octaves, top))
    return numbers


def _octaves(trace, values, noise, quantum, top):
    """((2, 3) powers of the lower and the upper octave below a frequency, their relative standard
    errors (2, 1)) of values (n, 3) at the rests of a Trace; None where they do not show them."""
    if noise is None or noise.moving or (noise.per_sample <= single_log.DROWNED * quantum).any():
        return None
    hz = np.arange(top / 4.0, top, 1.0 / PIECE_S)
    made, still, read = pieces(trace, values, np.zeros(len(values), bool), hz)
    power = np.abs(made[read & still.all(axis=1)]) ** 2
    if len(power):
        whole = power.sum(axis=(1, 2))
        power = power[whole <= SETTLING * np.median(whole)]
    if len(power) < FEWEST:
        return None
    mean = power.mean(axis=0)
    parts = [mean[hz < top / 2.0], mean[hz >= top / 2.0]]
    return (np.array([np.median(part, axis=0) for part in parts]),
            np.array([[OF_MEDIAN / np.sqrt(len(power) * len(part))] for part in parts]))


def _parameter(kind, real, sim, top):
    (a, a_error), (b, b_error) = real, sim
    fall = np.log(a[1] / a[0]) - np.log(b[1] / b[0])
    sigma = np.sqrt((a_error ** 2 + b_error ** 2).sum() / 3.0)
    # What a filter takes it takes from all axes; what shakes one of them is none.
    sigma = max(sigma, float(fall.std(ddof=1)) / np.sqrt(3.0))
    apart, size = abs(float(fall.mean())), MG if kind == "accel" else DEG
    density = [size * float(np.sqrt(x[1].mean() * PIECE_S / 2.0)) for x in (a, b)]
    found = compared("fast_noise", kind, "", "mg/√Hz" if kind == "accel" else "°/s/√Hz",
                     density[0], 0.5 * density[0] * float(a_error[1, 0]) / np.sqrt(3.0),
                     density[1], 0.5 * density[1] * float(b_error[1, 0]) / np.sqrt(3.0),
                     apart=apart / sigma if apart > ALIKE else 0.0)
    shares = [float(np.exp(0.5 * np.log(x[1] / x[0]).mean())) for x in (a, b)]
    return replace(found, set_to=None, how=filtered_so(*shares, top)) if found.differs else found


def filtered_so(real, simulated, top):
    """What to do about a simulator whose noise in the octave below a frequency (Hz) is such a
    share (of its size) of that in the octave below it, where the real one's is another."""
    return "filter its noise %s: between %.0f and %.0f Hz %.2g of what it is below, instead of " \
        "%.2g" % ("as the sensor does" if real < simulated else "less", top / 2.0, top, real,
                  simulated)
