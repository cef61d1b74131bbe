"""Whether a line is a sine, which goes on in phase and about as large, or a hump: noise through a
resonance, whose parts have any phase and a power that is exponential; something that comes, goes
or grows is no sine, either.

Of each part of a rest the sine and cosine that are nearest to it make one complex number. About
those of a sine they scatter by the noise and by a share of the line, as nothing runs quite evenly;
those of a hump scatter about 0 [Whittle, J. Royal Stat. Soc. B 15 (1953) 125].
"""
import math

import numpy as np

from ...capture.registers import unit_of_count
from ...experiment.block_measures import EDGE_S

PARTS = 4  # of a rest: the fewest that tell how both scatter
UNEVEN = 0.2  # of a line's amplitude, by which that of a motor under a regulated supply changes
LEAST_CYCLES = 2.0  # of a part: with fewer its course is taken for the line
BINS, FINER = 1.5, 4  # of the short stretches that the line is in; frequencies in each bin
LOBE, AROUND = 4, 16  # bins of a rest, between which to either side the noise is


def nats(line, sessions, sensor):
    """Log likelihood ratio of a line_frequency.Line being a sine over its being a hump, by all
    rests of the sessions, or the whole of those where nothing rests; each has a frequency, a phase
    and an amplitude of its own. 0 where no rest has parts that show it."""
    total = 0.0
    for session in sessions:
        counts, edge = getattr(session.capture, sensor), int(EDGE_S * session.rate)
        runs = [(first + edge, end - edge) for _, first, end in session.runs] or [(0, len(counts))]
        scale = unit_of_count(session.capture.meta, sensor)
        for first, end in runs:
            if end - first >= PARTS * LEAST_CYCLES * session.rate / line.hz:
                total += of_rest(counts[first:end, line.axis] * scale, session.rate, line.hz,
                                 line.bin_hz)
    return total


def of_rest(x, rate, hz, bin_hz):
    """Nats of one rest x (n,) at `rate` Hz, of a line at `hz` that is known to `bin_hz`."""
    n = len(x)
    bins = np.arange(n // 2 + 1) * rate / n
    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(n))) ** 2 / (np.hanning(n) ** 2).sum()
    off = np.abs(bins - hz)
    beside = (off > LOBE * rate / n) & (off < max(AROUND * rate / n, 2.0 * bin_hz))
    if not beside.any() or not power[beside].any():
        return 0.0
    # Of a complex amplitude, whose sine and cosine have half of it each.
    noise = 4.0 * float(np.median(power[beside])) / math.log(2.0) / (n / PARTS)
    parts = _parts(x, rate, hz - BINS * bin_hz, hz + BINS * bin_hz)
    mean, square = abs(parts.mean()), float((np.abs(parts) ** 2).mean())
    sine, hump = noise + (UNEVEN * mean) ** 2, max(noise, square)
    gain = PARTS * (math.log(hump / sine) + square / hump) - float(
        (np.abs(parts - parts.mean()) ** 2).sum()) / sine
    # A sine has two numbers more than the power of a hump [BIC: Schwarz, Annals of Statistics 6
    # (1978) 461], and the best of so many frequencies.
    return gain - math.log(2.0 * PARTS) - math.log(1.0 + 2.0 * BINS * bin_hz * n / rate)


def _parts(x, rate, low, high):
    """(PARTS,) complex amplitudes, in the parts of x (n,), of the frequency between two that goes
    on in phase over them with the largest one; each part less a straight line."""
    n = len(x)
    first, end = (int(np.clip(hz * FINER * n / rate, 1, FINER * n // 2)) for hz in (low, high))
    sizes = np.empty((PARTS, end - first + 1), complex)
    for k, part in enumerate(np.array_split(np.arange(n), PARTS)):
        course = np.linspace(-1.0, 1.0, len(part))
        alone = np.zeros(n)
        alone[part] = x[part] - x[part].mean() - course * (course @ x[part] / (course @ course))
        sizes[k] = np.fft.rfft(alone, FINER * n)[first:end + 1] * 2.0 / len(part)
    return sizes[:, np.abs(sizes.mean(axis=0)).argmax()]
