"""Rows that are missing under a steady clock: a buffer that ran over, and stamps made by counting.

The stamps do not tell. A motion does: where the rate of turn changes steadily from row to row, the
step over a row that is missing is twice those beside it, of two rows three times. That competes
with steps that hands make anyhow (Student's t about one), with jumps of any size, and with rows
that were read late and caught up, of which as many steps are nil as are double. Rows that are
missing at regular times are none: of a sensor that is read more slowly than it measures some are
left out, and the stamps are right.
"""
import math

import numpy as np
from scipy import special

from .detection import Finding, present

TIMES_NOISE = 8.0
# Of their mean, that the steps before and after may differ by within three rows: where one of them
# is double it is twice as much.
ALIKE = 0.2
TAILS = (4.0, 1e6)  # degrees of freedom of the steps that hands make; so many are normal
WINDOW_S = 0.5  # of a rest, by which noise is told
SHARES = np.geomspace(0.002, 0.3, 26)  # of rows that are missing, tried: a fifth apart
ON_END = (0.0, 0.2, 0.5)  # share of the missing rows that another one follows
MOST = 5  # periods of a step: beyond that its neighbours say little of it
JUMPS = (-2.0, 6.0)  # times the steps beside it, of jumps of any size
AROUND = 5  # rows with the step that is asked about and two on either side of it
FEWEST = 200  # steps: of so many half a per cent is one
TRIED = len(ON_END)  # the shares are tried of all else as well
# Pairs of missing rows closer than half of their mean distance: as many as chance makes, or hardly
# any where they come at regular times.
NEAR, REGULAR = 0.5, 0.05


def findings(sessions):
    """[Finding]: samples that are missing although the times are steady."""
    parts = [steps(session) for session in sessions
             if session.capture.gyro is not None and len(session.capture) > AROUND]
    ratio, noise = (np.concatenate(x) for x in zip(*(part[1:] for part in parts))) if parts else (
        np.zeros(0), np.zeros(0))
    if len(ratio) < FEWEST:
        return []
    score, share, lost = judged(ratio, noise)
    if not present(score) or not at_random([part[0] for part in parts], lost, share):
        return []
    found = np.rint(ratio[lost]) - 1.0
    off = ratio[lost] - 1.0
    number = len(found)
    chance = 100.0 * found.sum() / (len(ratio) + found.sum())
    half = 1.645 * chance / math.sqrt(number)
    explained = 1.0 - float(((off - found) ** 2).sum() / (off ** 2).sum())
    return [Finding(
        "dropped_samples", "device", [], {"chance": round(float(chance), 4)}, "%", score, "timing",
        "%d of %d steps of the gyro in motion are twice those beside them, or more: samples are "
        "missing although their times are steady" % (number, len(ratio)),
        {"chance": (max(0.0, chance - half), chance + half)}, share=explained, number=number,
        hidden=float(chance) / 100.0)]


def steps(session):
    """((k,) rows, (k,) step from there to the next row by the mean of the two before and the two
    after, (k,) noise of a reading by that mean) of a Session's gyro, where it changes fast and
    steadily, by stamps as far apart as all."""
    rate = session.capture.gyro.astype(float)
    step = np.diff(rate, axis=0)
    noise = _noise(rate, session)
    step, apart = step / noise, np.diff(session.t_s)
    before, after = step[:-4] + step[1:-3], step[3:-1] + step[4:]
    about = 0.25 * (before + after)
    size = np.linalg.norm(about, axis=1)
    even = np.convolve(np.abs(apart * session.rate - 1.0) > 0.5, np.ones(5), "valid") < 0.5
    safe = np.maximum(size, 1e-9)
    ratio = (step[2:-2] * about).sum(axis=1) / safe ** 2
    # Over rows that are missing they are further apart, and may differ by as much more.
    rows = 2.0 + np.clip(np.rint(ratio), 1.0, MOST)
    alike = np.linalg.norm(after - before, axis=1) < 2.0 * ALIKE * size * rows / 3.0
    fast = even & alike & (size > TIMES_NOISE)
    return np.flatnonzero(fast) + 2, ratio[fast], 1.0 / size[fast]


def _noise(rate, session):
    """(3,) standard deviation of a reading at rest, counts, by the bends from row to row of the
    half second that is in the middle of all; at least that of rounding."""
    bends = np.diff(rate, n=2, axis=0) ** 2
    length = max(8, int(WINDOW_S * session.rate))
    begins = [np.arange(run.first, run.end - length - 1, length) for run in session.runs]
    begins = np.concatenate([np.zeros(0, int), *begins]).astype(int)
    if not len(begins):
        return np.full(3, np.inf)
    power = np.array([bends[k:k + length].mean(axis=0) for k in begins])
    return np.sqrt(np.maximum(np.median(power, axis=0) / 6.0, 1.0 / 12.0))


def judged(ratio, noise):
    """(nats of rows that are missing over all else, their share, (k,) bool which steps are over
    some) of steps by those beside them."""
    spread = (1.4826 * float(np.median(np.abs(ratio - np.median(ratio))))) ** 2
    spread = max(spread - 3.25 * float(np.median(noise ** 2)), 0.0)
    densities = [_densities(ratio, noise, spread, freedom) for freedom in TAILS]
    inside = ((ratio > JUMPS[0]) & (ratio < JUMPS[1])) / (JUMPS[1] - JUMPS[0])
    others, best = [], (-math.inf, 0.0, None)
    for sound, at in densities:
        strange = [inside, at(0.0), 0.5 * (at(0.0) + at(2.0)), at(1.5), at(2.5)]
        others += [_log(sound, other, p) for other in strange for p in (0.0, *SHARES)]
        for on in ON_END:
            longer = sum((1.0 - on) * on ** k * at(2.0 + k) for k in range(MOST - 1))
            best = max([best, *((_log(sound, longer, p), p, p * longer > (1.0 - p) * sound)
                                for p in SHARES)], key=lambda tried: tried[0])
    nats, share, lost = best
    return nats - max(others) - math.log(TRIED), float(share), lost & (ratio > 1.5)


def _log(sound, other, share):
    return float(np.log((1.0 - share) * sound + share * other + 1e-300).sum())


def _densities(ratio, noise, spread, freedom):
    """((k,) density of sound steps, function of how many times the steps beside them others are)
    by Student's t; spread: variance of what a hand does besides."""
    def at(times):
        # Of a step two samples' noise, of those beside it a quarter of one's, which has half of
        # either of the two in common with it; what a hand does besides grows with the time.
        width = np.sqrt(noise ** 2 * (2.0 + times + 0.25 * times ** 2)
                        + spread * max(1.0, times) ** 2)
        return np.exp(-0.5 * (freedom + 1.0) * np.log1p(((ratio - times) / width) ** 2 / freedom)
                      - np.log(width * math.sqrt(freedom)) - special.betaln(0.5 * freedom, 0.5))
    return at(1.0), at


def at_random(rows, lost, share):
    """Whether rows are missing as close to one another as by chance; rows: [(k,) numbers] of the
    steps of each session, lost: (all k,) bool over some."""
    reach = max(4, int(NEAR / share))
    close, expected, start = 0, 0.0, 0
    for own in rows:
        here = lost[start:start + len(own)]
        start += len(own)
        for distance in range(1, reach):
            pairs = np.isin(own + distance, own, assume_unique=True)
            expected += share ** 2 * float(pairs.sum())
            close += int(np.isin(own[here] + distance, own[here], assume_unique=True).sum())
    return close * math.log(1.0 / REGULAR) > (1.0 - REGULAR) * expected
