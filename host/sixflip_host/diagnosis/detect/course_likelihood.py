"""How likely a column of counts is as the course of something that a sensor measures.

What is foreseen of a sample is the one before; what the two before it lead to, straight on or by
the autoregression that fits best; or one level. What remains is Student's t of its own width, but
for a share of leaps that are spread evenly, or as another t far wider.
"""
import math
from dataclasses import dataclass

import numpy as np

from .sample_neighbours import student

FREEDOM = (1.0, 3.0, 200.0)  # of Student's t: tails of Cauchy, heavy ones, normal ones
SHARES = 10.0 ** np.arange(-5.0, -0.29, 0.5)  # of leaps, tried in half-decades
WIDER = (5.0, 20.0, 100.0, 500.0)  # times the width, of leaps that have a size of their own
EVENLY = 131072.0  # counts that a leap may come to: twice the range of a reading
LEAST_WIDTH = 0.7  # counts: rounding alone leaves 0.41 of a difference, a bit of noise the rest
EXACT, FINENESS = 64.0, 0.01  # up to there whole counts, from there steps of one per cent
PAGE, PAGES = 256, 256  # counts of a high byte, and how many of them to both sides there are
# Samples that are taken together to see whether they tell the same: longer than a rule's effect
# goes on in a steady reading (half a second at 100 Hz), short enough that a recording has
# hundreds.
BLOCK = 50
STARTS = ((0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (2.0, -1.0, 0.0))  # of an autoregression
SETTLED, FITTED = 4, 5000  # rounds in which it settles, and about so many samples tell it
ROUNDS = 12  # in which a width settles


@dataclass(frozen=True)
class Fit:
    """each (n,): log likelihood of each of the counts but the first two; what suits them best:
    foresight, its number; freedom and width of Student's t; share of leaps, how many times wider
    (0: evenly spread)."""

    each: np.ndarray
    foresight: int
    freedom: float
    width: float
    share: float
    wider: float

    @property
    def log(self):
        return float(self.each.sum())


def fit(x, seen=None, lost=None, as_=None):
    """Fit of counts x (n,) under what suits all of them best, or another Fit as_. seen (n,): False
    for samples that are not looked at, which are left out. lost (n,): True for samples of which
    only the low byte was read; their likelihood is that of every high byte together."""
    x = x - np.median(x)
    keep = slice(None) if seen is None else seen[2:]
    lost = np.zeros(len(x) - 2, bool)[keep] if lost is None else lost[2:][keep]
    return max((_unforeseen(rest[keep], lost, number, as_) for number, rest in enumerate(
        _remains(x)) if as_ is None or number == as_.foresight), key=lambda found: found.log)


def coarse(x):
    """Log likelihood of counts x (n,) as steps or about one level, whichever is larger, with
    heavy tails."""
    return max(_heavy_tailed(np.abs(np.diff(x))), _heavy_tailed(np.abs(x - np.median(x))[1:]))


def _heavy_tailed(size):
    """Log likelihood of sizes (n,) by the density 1 / (2 w (1 + r / w)^2), whose likeliest width w
    is their median."""
    width = max(float(np.median(size)), LEAST_WIDTH)
    return -2.0 * float(np.log1p(size / width).sum()) - len(size) * math.log(2.0 * width)


def score(gain, moved):
    """Nats that gains (n,) of samples in log likelihood are worth, `moved` of which have another
    step: as many samples as tell the same again count once [Chandler & Bate, Biometrika 94 (2007)
    167], and as neither of two courses is the true one, what was gained must either be more than
    a nat for each that moved, or be gained so steadily that chance does not [Vuong, Econometrica
    57 (1989) 307]."""
    blocks = max(len(gain) // BLOCK, 1)
    rows = (gain - gain.mean())[:blocks * BLOCK].reshape(blocks, -1)
    alone, together = float((rows ** 2).sum()), float((rows.sum(axis=1) ** 2).sum())
    nats = float(gain.sum()) / max(1.0, together / max(alone, 1e-9))
    steady = 0.5 * max(float(gain.sum()), 0.0) ** 2 / max(alone, together, 1e-9)
    return min(nats, max(steady, nats - moved))


def _remains(x):
    """What each foresight leaves of x[2:], whose number is the same for all."""
    now, last, before = x[2:], x[1:-1], x[:-2]
    yield now - last
    yield now - 2.0 * last + before
    yield now - _autoregression(now, np.c_[last, before, np.ones(len(now))])
    yield now


def _autoregression(now, past):
    """What past (n, 3) says of now, by least squares that leaps do not draw [Holland & Welsch,
    Communications in Statistics A6 (1977) 813: weights of Cauchy], from the start whose end leaves
    least; some thousand samples tell it."""
    some = slice(None, None, max(1, len(now) // FITTED))
    ends = [_settled(now[some], past[some], np.array(start)) for start in STARTS]
    return past @ max(ends, key=lambda end: _heavy_tailed(
        np.abs(now[some] - past[some] @ end)))


def _settled(now, past, end):
    for _ in range(SETTLED):
        rest = now - past @ end
        width = max(1.4826 * float(np.median(np.abs(rest))), LEAST_WIDTH)
        weighted = past / (1.0 + (rest / (2.385 * width)) ** 2)[:, None]
        end = np.linalg.lstsq(weighted.T @ past, weighted.T @ now, rcond=None)[0]
    return end


def _unforeseen(rest, lost, foresight, as_):
    """The Fit of what remains (n,) under a foresight."""
    known, alone = np.flatnonzero(~lost), np.flatnonzero(lost)
    size, place = _counted(np.abs(rest[known]))
    residue, page = np.unique(np.rint(rest[alone]) % PAGE, return_inverse=True)
    pages = residue[:, None] + PAGE * np.arange(-PAGES, PAGES)
    number = np.concatenate([np.bincount(place, minlength=len(size)),
                             np.bincount(page, minlength=len(residue))])

    def density(freedom, width):
        def at(r):
            return student(r / width, freedom) / width
        return np.concatenate([at(size), at(pages).sum(axis=1)])

    def leaps(width, wider):
        return density(5.0, wider * width) if wider else np.concatenate(
            [np.full(len(size), 1.0 / EVENLY), np.full(len(residue), 2.0 * PAGES / EVENLY)])

    median = max(float(np.median(np.abs(rest[known]))) / 0.6745, LEAST_WIDTH)
    best, mixture = -math.inf, None
    for freedom in FREEDOM if as_ is None else (as_.freedom,):
        for width in {median, _width(size, number[:len(size)], freedom, median)
                      } if as_ is None else (as_.width,):
            sound = density(freedom, width)
            for wider in (0.0, *WIDER) if as_ is None else (as_.wider,):
                shares = SHARES if as_ is None else np.array([as_.share])
                mixed = np.log(np.outer(1.0 - shares, sound)
                               + np.outer(shares, leaps(width, wider)))
                sums = mixed @ number
                if sums.max() > best:
                    k = int(sums.argmax())
                    best, mixture = float(sums[k]), (mixed[k], freedom, width, shares[k], wider)
    mixed, *values = mixture
    likelihoods = np.zeros(len(rest))
    likelihoods[known], likelihoods[alone] = mixed[place], mixed[len(size) + page]
    return Fit(likelihoods, foresight, *values)


def _counted(size):
    """(sizes that occur, which of them each sample has): whole counts, larger ones by one per
    cent."""
    place = np.where(size < EXACT, np.rint(size),
                     EXACT + np.rint(np.log(np.maximum(size, EXACT) / EXACT) / FINENESS)
                     ).astype(np.int64)
    number = np.bincount(place)
    values = np.flatnonzero(number)
    return np.where(values < EXACT, values, EXACT * np.exp((values - EXACT) * FINENESS)), (
        np.cumsum(number > 0) - 1)[place]


def _width(size, number, freedom, width):
    """Likeliest width of Student's t [Lange, Little & Taylor, JASA 84 (1989) 881]."""
    for _ in range(ROUNDS):
        z = (size / width) ** 2
        width = math.sqrt(max(float((number * (freedom + 1.0) / (freedom + z) * size ** 2).sum()
                                    ) / max(float(number.sum()), 1.0), LEAST_WIDTH ** 2))
    return width
