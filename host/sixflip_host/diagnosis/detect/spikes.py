"""Spikes: samples at rest, single or in pairs, that are far off those before and after them, more
often than the tails of noise have them. No effect of the library does that: it is said where, not
what.
"""
import copy
import math
from dataclasses import dataclass

import numpy as np

from ...capture import registers
from .. import odds
from .detection import present
from .rest_parts import LIFTS_S
from .sample_neighbours import student

SPIKE = 4.5  # standard deviations of a sample off its neighbours, which agree
AGREE = 4.0  # standard deviations that the four neighbours, but one in a pair, may differ by
PAIRED = 3  # of the four, where the one beside it may be wild as well
LEAST_SPIKES = 10  # knocks on a table come singly
# How heavy the tails of noise are, Student's t: rests of the recordings have 6 and more
# (`python -m tests.studies.robustness.tails`), in steps that leave nothing to jumps of one size.
TAILS = (5.0, 5.5, 6.0, 6.5, 7.0, 8.0, 9.0, 10.0, 12.0, 15.0, 20.0, 40.0, 200.0)
# Jumps: so many times the noise wide; or of one size, above which the wide ones do as well.
WIDTHS, SIZES = (10.0, 30.0, 100.0, 1000.0), (5.0, 6.0, 8.0, 10.0)
SHARES = tuple(10.0 ** np.arange(-4.0, -0.9, 0.25))  # of samples that jump, tried
# Times the noise, of samples that are louder for a while, and their share: no jumps.
LOUDER, LOUD = (2.0, 3.0, 5.0), (0.05, 0.1, 0.2, 0.4)
SCALES = tuple(np.arange(0.7, 1.31, 0.05))  # of the noise, about what its middle says
FINE = 50.0  # steps of the inverse hyperbolic sine in which sizes are counted
PASSES = 6  # of three side by side the one between is seen when the others are gone


@dataclass(frozen=True, eq=False)
class Spikes:
    """Samples far off the two before and the two after in a session's rests: wild (N, 3),
    which they are; middle (N, 3) counts, what those beside them read; looked: samples looked at;
    sizes (n,): how far off all of those are whose neighbours agree, in standard deviations.
    Counts within a few steps of their neighbours never are wild."""

    wild: np.ndarray
    middle: np.ndarray
    looked: int
    sizes: np.ndarray

    @property
    def number(self):
        return int(self.wild.any(axis=1).sum())

    def seconds(self, rate):
        """Number of seconds that hold one, of samples at so many a second."""
        return len(np.unique((np.flatnonzero(self.wild.any(axis=1)) // max(rate, 1.0))))

    @property
    def pairs(self):
        """Number of those that another one follows at once."""
        wild = self.wild.any(axis=1)
        return int((wild[1:] & wild[:-1]).sum())


def spikes(session, sensor, agreeing=4, but_s=0.0):
    """Spikes of one sensor of a session; agreeing: of the four samples beside one, those that have
    to agree; but_s: so much of the end of each rest is not looked at."""
    but = int(but_s * session.rate)
    counts, looked, sizes = getattr(session.capture, sensor), 0, [np.zeros(0)]
    wild, between = np.zeros(counts.shape, bool), np.array(counts, dtype=float)
    narrowest = registers.steps(counts)
    for _, first, last in session.runs:
        end = max(first, last - but)
        x = counts[first:end].astype(float)
        if len(x) < 20:
            continue
        beside = registers.beside(x)
        middle = np.median(beside, axis=0)
        off = np.abs(x[2:-2] - middle)
        sigma = np.maximum(_deviation(off), narrowest)
        agree = np.sort(np.abs(beside - middle), axis=0)[agreeing - 1] < AGREE * sigma
        wild[first + 2:end - 2] = (off > SPIKE * sigma) & agree
        between[first + 2:end - 2] = middle
        looked += len(off)
        sizes.append((off / sigma)[agree])
    return Spikes(wild, between, looked, np.concatenate(sizes))


def jump_nats(sizes):
    """Nats of some samples jumping over noise with tails alone, of how far samples are off, (n,)
    standard deviations: the likeliest tails and scale in either, what was tried paid."""
    if not len(sizes):
        return 0.0
    place, number = np.unique(np.rint(np.arcsinh(sizes) * FINE), return_counts=True)
    z, plain, jumping = np.sinh(place / FINE), [], []
    jumps = np.array([_normal(z / width) / width for width in WIDTHS] + [
        0.5 * _normal(z - size) for size in SIZES])  # to either side
    for freedom in TAILS:
        for scale in SCALES:
            sound = student(z / scale, freedom) / scale
            louder = np.array([student(z / (times * scale), freedom) / (times * scale)
                               for times in LOUDER])
            plain += [float(number @ np.log(sound)), _mixed(sound, louder, LOUD, number)]
            jumping.append(_mixed(sound, jumps, SHARES, number))
    return max(jumping) - max(plain) - math.log(len(SHARES) * len(jumps))


def _mixed(sound, others, shares, number):
    """The largest log likelihood of a share of samples, one of `shares`, having a density of
    others (k, n) in place of sound (n,), at sizes that number (n,) samples have."""
    share = np.array(shares)[:, None, None]
    return float((np.log((1.0 - share) * sound + share * others) @ number).max())


def _normal(z):
    return np.exp(-0.5 * z ** 2) / np.sqrt(2.0 * np.pi)


def _deviation(off):
    """(3,) standard deviation of which off (n, 3) are the sizes, few of them too large. A median
    of half counts is one itself, off by a quarter where noise is two wide; the mean is not."""
    widest = 4.0 * np.maximum(np.median(off, axis=0) / 0.6745, 1.0)
    return np.maximum(np.sqrt(0.5 * np.pi) * np.minimum(off, widest).mean(axis=0), 1.0)


def without_spikes(sessions, leaping=()):
    """(sessions, [(sensor, sentence, p)]): where single samples are far off more often than the
    tails of noise have them, they read as those beside them do. A hand that takes the box up
    shakes it: what it does is no evidence. A touch rings, so of samples beside which one does not
    agree it is pairs that count. What is wild says nothing of where a rest lies, and as much as
    all others of a mean; of a few that is not worth a sentence. leaping: sensors whose counts leap
    anyhow."""
    sentences = []
    for sensor, words in registers.SENSORS.items():
        if sensor in leaping or any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        each = [spikes(s, sensor, but_s=LIFTS_S) for s in sessions]
        paired = [spikes(s, sensor, PAIRED, LIFTS_S) for s in sessions]
        if sum(spiky.pairs for spiky in paired) >= LEAST_SPIKES:
            each = paired
        number, looked = sum(spiky.number for spiky in each), sum(spiky.looked for spiky in each)
        nats = jump_nats(np.concatenate([spiky.sizes for spiky in each]))
        # What shakes for a while is as far off many times: of these each second tells once.
        nats *= sum(spiky.seconds(s.rate) for spiky, s in zip(each, sessions)) / max(number, 1)
        if not number or not present(nats):
            continue
        sessions = [_put_right(s, sensor) for s in sessions]
        if number < LEAST_SPIKES:
            continue
        sentences.append((
            sensor, "%d of %d samples of the %s at rest are far off those before and after them: "
            "spikes" % (number, looked, words), odds.chance(nats)))
    return sessions, sentences


def _put_right(session, sensor):
    """The session without spikes, those included that others stand beside."""
    for _ in range(PASSES):
        spiky = spikes(session, sensor, PAIRED)
        if not spiky.number:
            break
        session = _without(session, sensor, spiky)
    return session


def _without(session, sensor, spiky):
    capture = copy.copy(session.capture)
    counts = np.array(getattr(capture, sensor))
    counts[spiky.wild] = np.rint(spiky.middle[spiky.wild]).astype(counts.dtype)
    setattr(capture, sensor, counts)
    return session.of_capture(capture)
