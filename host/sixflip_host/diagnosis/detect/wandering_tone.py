"""A tone whose frequency wanders: a chirp, a pump whose speed is regulated. In the mean of all
spectra it is no line, in every stretch by itself it is one.

Over the median of all stretches the power of one of them, bin by bin, is exponential with mean 1
where there is only noise, and so is what comes and goes at one resonance; the largest of K bins is
beyond x with a probability of 1 - (1 - exp(-x))^K [Fisher, Proc. R. Soc. A 125 (1929) 54].
"""
import math
import sys

import numpy as np
from scipy import special

from . import rest_spectra, spectral_lines

RARE = 0.001  # that noise has such a tone in one stretch; how many have one is judged
# What that is taken for: a median of so few stretches is off by a fifth, which at exp(-12) makes
# eleven times as many.
DOUBTED, FEWEST = 0.02, 24
OFTEN = 0.25  # share of the stretches that has one: less is a visit, no state of the sensor
WANDERS = 3.0  # bins, quartile to quartile: the lobe of a steady line is four bins wide


def axes(sessions, sensor):
    """[(axis letter, nats, (lowest, highest) Hz)] of a sensor at rest."""
    if any(getattr(s.capture, sensor) is None for s in sessions) or not any(
            s.runs for s in sessions):
        return []
    stretches = rest_spectra.rests(sessions, sensor)
    if len(stretches) < FEWEST:
        return []
    tones = [("xyz"[axis], *_tone(np.array([s[:, axis] for s in stretches]), sessions[0].rate))
             for axis in range(3)]
    return [tone for tone in tones if tone[1] > 0.0]


def _tone(x, rate):
    """(nats, (lowest, highest) Hz) of stretches x (R, n); 0 nats where there is none."""
    n = x.shape[1]
    chance, place, lobe = chances(x, rate)
    amplitude = np.sqrt(np.maximum(4.0 * lobe / n, 0.0))
    tone = (chance < RARE) & (amplitude > spectral_lines.STRONG_SHARE * x.std(axis=1))
    bins = place[tone]
    if tone.mean() < OFTEN or np.subtract(*np.quantile(bins, (0.75, 0.25))) < WANDERS:
        return 0.0, (0.0, 0.0)
    hz = np.quantile(bins, (0.05, 0.95)) * rate / n
    chance = special.bdtrc(tone.sum() - 1, len(tone), DOUBTED)
    return -math.log(max(chance, sys.float_info.min)), tuple(hz)


def chances(x, rate):
    """Of each of the stretches x (R, n): (the probability of its largest bin by noise alone, the
    bin, the power of its lobe beyond noise), (R,) each; ones where the spectra tell nothing."""
    first = max(spectral_lines.LOBE + 1, int(spectral_lines.LOWEST_HZ * x.shape[1] / rate) + 1)
    power, nothing = rest_spectra.periodograms(x), np.zeros(len(x))
    if power.shape[1] - first < 2 * FEWEST:
        return np.ones(len(x)), nothing.astype(int), nothing
    level = np.median(power[:, first:-1], axis=1)
    if not (level > 0.0).all():
        return np.ones(len(x)), nothing.astype(int), nothing
    alike = power / level[:, None]
    ratio = (alike / (np.median(alike, axis=0) / math.log(2.0)))[:, first:-1]
    place = first + ratio.argmax(axis=1)
    chance = -np.expm1(ratio.shape[1] * np.log1p(-np.exp(-ratio.max(axis=1))))
    wide = spectral_lines.LOBE
    lobe = np.array([spectrum[k - wide:k + wide + 1].sum() for spectrum, k in zip(power, place)])
    return chance, place, lobe - (2 * wide + 1) * level / math.log(2.0)
