"""Whether what shakes the real sensor, at rest or on its way, shakes the simulator's as much, by
the power of both logs in one band of frequencies: that depends neither on their rates nor on what
each log by itself makes of a bump, or of the noise of its quiet seconds.
"""
from dataclasses import dataclass

import numpy as np
from scipy import ndimage, special

from .. import odds
from ..detect import rest_spectra, saturation, shake_detector
from ..detect.shake_detector import QUIET, WINDOW_S
from . import hypotheses

# Of its peak's power, where a bump ends: beyond, a resonance has a third of its power.
ENDS = 0.25
# Probability that two logs of the same power are held for unlike, as of sizes that are three
# standard errors apart (normal); standard errors from which on there is any power.
UNLIKE, ANY = 0.0027, 3.0


@dataclass(frozen=True)
class Spectra:
    """hz (k,); powers (R, 3, k) of each stretch at rest, (mg)2 or (deg/s)2 per Hz."""

    hz: np.ndarray
    powers: np.ndarray

    @property
    def mean(self):
        """(3, k)"""
        return self.powers.mean(axis=0)

    def within(self, axis, low, high):
        """(power of an axis between two frequencies beyond what is beside them, its standard
        error, and that of noise alone: each bin of each stretch is exponential, and Hann's window
        makes one of two bins [Percival & Walden (1993), section 6.6])."""
        inside = (self.hz >= low) & (self.hz <= high)
        beside = ~inside & (self.hz > rest_spectra.LOWEST_HZ)
        if inside.sum() < 2 or not beside.any():
            return 0.0, np.inf, np.inf
        wide = self.hz[1]
        floor = np.median(self.mean[axis, beside])
        each = (self.powers[:, axis][:, inside] - floor).sum(axis=1) * wide
        return (float(each.mean()), float(each.std(ddof=1) / np.sqrt(len(each))),
                float(floor * wide * np.sqrt(2.0 * inside.sum() / len(each))))


def found_alike(finding, own, other):
    """Whether what a Finding of Sessions says to shake their sensor shakes that of the others,
    too: by its lines at rest, or as a whole on the way where it has no frequency."""
    if finding.effect == "vibration" and not finding.lines:
        return on_the_way(own, other, finding.axes)
    return alike(own, other, finding.sensor, {line.letter: line.hz for line in finding.lines})


def on_the_way(real, simulated, letters):
    """Whether axes of the accelerometer are shaken most of the time with the same power in both
    logs, Sessions each, in each octave that both show above what a hand, legs and wheels do and
    that has its part of the real one's. How many times its quiet seconds a log is shaken depends
    on its noise, and the power beyond does not."""
    lowest = min(s.rate for sessions in (real, simulated) for s in sessions)
    low, top, octaves = shake_detector.edge(lowest), 0.5 * lowest, []
    axes = list(map("xyz".index, letters))
    while low < top:
        logs = [_beyond_quiet(sessions, low, min(2.0 * low, top))
                for sessions in (real, simulated)]
        if None not in logs:
            octaves.append([[values[axes] for values in log] for log in logs])
        low *= 2.0
    whole = sum(max(own.sum(), 0.0) for (own, *_), _ in octaves)
    octaves = [pair for pair in octaves if pair[0][0].sum() > shake_detector.LEAST * whole]
    apart = 0.0
    for (own, sigma, _), (theirs, their_sigma, noise) in octaves:
        if not (min(own.min(), theirs.min()) > 0.0
                and theirs.sum() > ANY * np.linalg.norm(noise)):
            return False
        apart += (np.log(own / theirs) ** 2 / ((sigma / own) ** 2 + (their_sigma / theirs) ** 2 + (
            2.0 * hypotheses.SHAPE) ** 2)).sum()
    return bool(octaves) and bool(special.chdtrc(len(axes) * len(octaves), apart) > UNLIKE)


def _beyond_quiet(sessions, low, high):
    """((3,) power of the usual window of an accelerometer between two frequencies beyond the noise
    that its quiet windows show, mg2, (3,) its standard error, (3,) that of noise alone), or None
    of too few windows. Of noise alone the quiet ones have less than the usual one by chance."""
    power = []
    for session in sessions:
        rows = max(8, int(WINDOW_S * session.rate))
        hz = np.arange(rows // 2 + 1) * session.rate / rows
        inside = (hz >= low) & (hz < high)
        number = len(session.capture) // rows
        if session.capture.accel is None or not number or not inside.any():
            return None
        x = session.capture.accel[:number * rows].reshape(number, rows, 3) * (
            1000.0 / session.capture.meta["accel_lsb_per_g"])
        read = ~saturation.railed(session)[:number * rows].reshape(number, rows).any(axis=1)
        power.append(2.0 / rows * np.stack([rest_spectra.periodograms(x[read, :, i])[
            :, inside].sum(axis=1) for i in range(3)], 1))
    ranked, bins = np.sort(np.concatenate(power), axis=0), inside.sum()
    if len(ranked) < shake_detector.FEWEST_WINDOWS:
        return None
    chance = special.chdtri(bins, 0.5) / special.chdtri(bins, 1.0 - QUIET)
    noise = chance * np.quantile(ranked, QUIET, axis=0)
    first, last = shake_detector.ends_of_median(len(ranked))
    error = noise * np.sqrt(2.0 / bins)
    return np.median(ranked, axis=0) - noise, np.hypot(
        (ranked[last] - ranked[first]) / (2.0 * odds.Z_90), error), error


def spectra(sessions, sensor):
    """Spectra of a sensor of several Sessions, or None."""
    if any(getattr(s.capture, sensor) is None for s in sessions):
        return None
    stretches = rest_spectra.rests(sessions, sensor)
    if len(stretches) < rest_spectra.FEWEST:
        return None
    rate, n = sessions[0].rate, len(stretches[0])
    powers = [rest_spectra.periodograms(np.array([x[:, axis] for x in stretches]))
              for axis in range(3)]
    return Spectra(np.arange(n // 2 + 1) * rate / n, 2.0 * np.stack(powers, 1) / rate)


def band(own, axis, hz):
    """(lowest, highest Hz) of the bump of an axis around a frequency, or of the highest one for
    None: as far as it does not fall below ENDS of its peak, and a line's lobe at least."""
    mean = np.where(own.hz > rest_spectra.LOWEST_HZ, ndimage.uniform_filter1d(
        own.mean[axis], 3, mode="nearest"), 0.0)
    lobe = rest_spectra.LOBE
    if hz is None:
        top = int(mean.argmax())
    else:
        near = min(max(0, int(round(hz / own.hz[1])) - lobe), len(mean) - 1)
        top = near + int(mean[near:near + 2 * lobe + 1].argmax())
    labels = ndimage.label(mean > ENDS * mean[top])[0]
    bins = np.flatnonzero(labels == labels[top])
    first, last = min(bins[0], top - lobe), min(max(bins[-1], top + lobe), len(mean) - 1)
    return max(first, 0) * own.hz[1], last * own.hz[1]


def alike(real, simulated, sensor, shaken):
    """Whether what shakes axes of a sensor at rest, {axis letter: Hz, or None for where it is
    shaken most}, has the same power in both logs, Sessions each: a power that is there in the
    simulator's, too, and differs from the real one's by no more than both scatter and scales do,
    on all of the axes together."""
    if not shaken or any(s.runs for s in real) != any(s.runs for s in simulated):
        return False
    logs = [spectra(sessions, sensor) for sessions in (real, simulated)]
    if None in logs:
        return False
    apart = 0.0
    for letter, hz in shaken.items():
        axis = "xyz".index(letter)
        ends = band(logs[0], axis, hz)
        if ends[1] > logs[1].hz[-1]:
            return False
        (own, sigma, _), (theirs, their_sigma, noise) = (
            log.within(axis, *ends) for log in logs)
        if not (own > 0.0 and theirs > ANY * noise):
            return False
        # What comes and goes has as large an error as its mean, of which the share is known.
        apart += np.log(own / theirs) ** 2 / (
            (sigma / own) ** 2 + (their_sigma / theirs) ** 2 + (2.0 * hypotheses.SHAPE) ** 2)
    return bool(special.chdtrc(len(shaken), apart) > UNLIKE)
