"""Stretches at rest, all equally long, their spectra, what noise makes of these, and a tone that
is in every stretch by itself.

By the mean of all spectra lines are told (spectral_lines.py). A tone whose frequency wanders, a
chirp or a pump whose speed is regulated, is no line in it: it is told stretch by stretch.
"""
import math
import sys

import numpy as np
from scipy import special

from ...capture.registers import steps, unit_of_count
from ...experiment.block_measures import EDGE_S

# Of a stretch, without the edges: a rest of the paper's protocol (5 s), shorter ones (4 s, 2 s),
# a short one, one on the way.
LENGTHS_S, MOVING_S = (4.5, 3.5, 1.8, 1.0), 2.0
FEWEST, SHORTEST = 4, 8  # stretches, samples of one: a log of one row a second has no lines
# Of what the shortest stretches hold of the rests, that longer ones must hold: a few long rests
# say nothing of what is there while the box is handled.
HELD = 0.5
# Of slow noise: bins of its corner beyond the first, levels there over the largest power of all.
CORNERS = np.array([1.0, 3.0, 10.0, 30.0])
LEVELS = tuple(2.0 ** -k for k in range(16))
LINE_BINS = 3  # to each side, of a line whose frequency lies between two bins
LOWEST_HZ = 0.7  # a hand or a vehicle moves more slowly than that
LOBE = 2  # bins to each side, of a line
STRONG_SHARE = 0.4  # of the standard deviation of the noise: what is as large is named in any case
RARE = 0.001  # that noise has such a tone in one stretch; how many have one is judged
# What that is taken for: a median of so few stretches is off by a fifth, which at exp(-12) makes
# eleven times as many.
DOUBTED, FEWEST_TOLD = 0.02, 24
OFTEN = 0.25  # share of the stretches that has one: less is a visit, no state of the sensor
WANDERS = 3.0  # bins, quartile to quartile: the lobe of a steady line is four bins wide


def rests(sessions, sensor):
    """list of (n, 3) stretches of samples in mg or deg/s, all at rest, equally long; of the
    whole capture where there is no rest."""
    if not any(session.runs for session in sessions):
        length = int(MOVING_S * sessions[0].rate)
        return _stretches(sessions, sensor, length, whole=True) if length >= SHORTEST else []
    rate = sessions[0].rate
    lengths = [int(seconds * rate) for seconds in LENGTHS_S if seconds * rate >= SHORTEST]
    numbers = {length: sum(len(range(*_starts(session, run, length)))
                           for session in sessions for run in session.runs)
               for length in lengths}
    most = max((length * number for length, number in numbers.items()), default=0)
    for length, number in numbers.items():
        if number >= FEWEST and length * number >= HELD * most:
            return _stretches(sessions, sensor, length)
    return []


def _stretches(sessions, sensor, length, whole=False):
    stretches = []
    for session in sessions:
        scale = unit_of_count(session.capture.meta, sensor)
        counts = getattr(session.capture, sensor)
        for run in [(0, 0, len(counts))] if whole else session.runs:
            for start in range(*_starts(session, run, length)):
                stretches.append(counts[start:start + length] * scale)
    return stretches


def _starts(session, run, length):
    """(start, stop, step) of a range: where stretches of `length` samples of a rest begin."""
    _, first, end = run
    edge = int(EDGE_S * session.rate)
    return first + edge, end - edge - length + 1, length


def spectrum(stretches, axis):
    """(mean power (k,), the same with every stretch counted alike, R)."""
    power = periodograms(np.array([s[:, axis] for s in stretches]))
    # Every stretch counts alike: a burst of noise in one of them is no line.
    level = np.median(power[:, 1:], axis=1)
    alike = power
    if (level > 0.0).all():
        alike = power * (np.median(level) / level)[:, None]
    return power.mean(axis=0), alike.mean(axis=0), len(power)


def periodograms(x):
    """(R, k): power of stretches x (R, n), each bin that of a sample's noise on average."""
    window = np.hanning(x.shape[1])
    # What creeps or drifts is no line: a straight one is taken off.
    course = np.linspace(-1.0, 1.0, x.shape[1])
    x = x - x.mean(axis=1)[:, None] - np.outer(x @ course / (course @ course), course)
    return np.abs(np.fft.rfft(x * window, axis=1)) ** 2 / (window ** 2).sum()


def step(sessions, sensor, axis):
    """mg or deg/s of the steps that an axis counts in: rounding makes lines of its own."""
    scale = unit_of_count(sessions[0].capture.meta, sensor)
    return scale * min(int(steps(getattr(s.capture, sensor)[:, [axis]])[0]) for s in sessions)


def scatter(stretches, axis, k):
    """Standard deviation over mean of the power around index k, from stretch to stretch; 0 of one,
    which does not tell."""
    if len(stretches) < 2:
        return 0.0
    window = np.hanning(len(stretches[0]))
    x = np.array([s[:, axis] - s[:, axis].mean() for s in stretches])
    power = (np.abs(np.fft.rfft(x * window, axis=1)) ** 2)[:, max(0, k - 1):k + 2].sum(axis=1)
    return float(power.std(ddof=1) / max(power.mean(), 1e-300))


def slow_noise(band, even, at, number):
    """(k,) power of noise below a corner frequency beyond an even floor, as that of a sensor that
    wanders is (an Ornstein-Uhlenbeck process; with its corner at the first bin, nearly a random
    walk): the likeliest in a mean of `number` spectra beside a line at one bin [Whittle; Percival
    & Walden, equation 10.3]."""
    others = np.abs(np.arange(len(band)) - at) > LINE_BINS
    bins = 1.0 + np.arange(len(band))
    shapes = 1.0 / (1.0 + (bins / CORNERS[:, None]) ** 2)
    noise = even + np.concatenate([
        np.zeros((1, len(band))),
        *(level * band[others].max() * shapes / shapes[:, :1] for level in LEVELS)])
    cost = number * (np.log(noise) + band / noise)[:, others].sum(axis=1)
    return noise[int(cost.argmin())] - even


def log_beyond(x, number):
    """Logarithm of the probability that a Gamma variable of a whole number of stretches exceeds
    x, however small: exp(-x) times the first terms of the series of exp(x)."""
    k = np.arange(number)
    return float(special.logsumexp(k * math.log(x) - special.gammaln(k + 1.0))) - x


def wandering_tones(sessions, sensor):
    """[(axis letter, nats, (lowest, highest) Hz)] of the tones of a sensor at rest whose frequency
    wanders.

    Over the median of all stretches the power of one of them, bin by bin, is exponential with mean
    1 where there is only noise, and so is what comes and goes at one resonance; the largest of K
    bins is beyond x with a probability of 1 - (1 - exp(-x))^K [Fisher, Proc. R. Soc. A 125 (1929)
    54]."""
    if any(getattr(s.capture, sensor) is None for s in sessions) or not any(
            s.runs for s in sessions):
        return []
    stretches = rests(sessions, sensor)
    if len(stretches) < FEWEST_TOLD:
        return []
    tones = [("xyz"[axis], *_wandering(np.array([s[:, axis] for s in stretches]),
                                       sessions[0].rate)) for axis in range(3)]
    return [tone for tone in tones if tone[1] > 0.0]


def _wandering(x, rate):
    """(nats, (lowest, highest) Hz) of stretches x (R, n); 0 nats where there is none."""
    n = x.shape[1]
    chance, place, lobe = largest_bins(x, rate)
    amplitude = np.sqrt(np.maximum(4.0 * lobe / n, 0.0))
    tone = (chance < RARE) & (amplitude > STRONG_SHARE * x.std(axis=1))
    bins = place[tone]
    if tone.mean() < OFTEN or np.subtract(*np.quantile(bins, (0.75, 0.25))) < WANDERS:
        return 0.0, (0.0, 0.0)
    hz = np.quantile(bins, (0.05, 0.95)) * rate / n
    chance = special.bdtrc(tone.sum() - 1, len(tone), DOUBTED)
    return -math.log(max(chance, sys.float_info.min)), tuple(hz)


def largest_bins(x, rate):
    """Of each of the stretches x (R, n): (the probability of its largest bin by noise alone, the
    bin, the power of its lobe beyond noise), (R,) each; ones where the spectra tell nothing."""
    first = max(LOBE + 1, int(LOWEST_HZ * x.shape[1] / rate) + 1)
    power, nothing = periodograms(x), np.zeros(len(x))
    if power.shape[1] - first < 2 * FEWEST_TOLD:
        return np.ones(len(x)), nothing.astype(int), nothing
    level = np.median(power[:, first:-1], axis=1)
    if not (level > 0.0).all():
        return np.ones(len(x)), nothing.astype(int), nothing
    alike = power / level[:, None]
    ratio = (alike / (np.median(alike, axis=0) / math.log(2.0)))[:, first:-1]
    place = first + ratio.argmax(axis=1)
    chance = -np.expm1(ratio.shape[1] * np.log1p(-np.exp(-ratio.max(axis=1))))
    wide = LOBE
    lobe = np.array([own[k - wide:k + wide + 1].sum() for own, k in zip(power, place)])
    return chance, place, lobe - (2 * wide + 1) * level / math.log(2.0)
