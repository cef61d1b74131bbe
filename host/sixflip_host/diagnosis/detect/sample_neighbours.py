"""How far each sample of a column lies from what the samples around it predict, and how likely
that is of samples that are sound, that jump, or that are torn.
"""
import math
from dataclasses import dataclass, fields

import numpy as np
from scipy import ndimage

from ...capture import registers

PAGE = 256  # counts that share a high byte
FEWEST = 50  # samples before the noise of a column is known, to a sixth
# Standard deviations that the six neighbours of a sample at rest may span: of normal noise they
# span 2.5 on average, and more than 8 in less than one of a million.
CALM = 8.0
LONG = 25  # samples on each side: their median errs by a sixth of the noise
BLURRED = 100.0  # counts: with wider noise a page more or less tells nothing
# The same where a hand or a slow wave moves the level: what is foreseen there is off with the very
# samples whose page is compared, so a page must lie where noise of any tail seldom comes.
BLURRED_MOVING = PAGE / CALM
WHITE = 0.1  # correlation with the sample before, up to which a level at rest is known beside it
BESIDE = 5  # samples: itself and the four by which it is foreseen where the level moves
NEAR = 2.0  # standard deviations beyond which a sample may be a jump, and counts as so far
AT_A_TIME = 1 << 16  # samples that are looked at at once: memory, not time
SHARES = tuple(10.0 ** np.arange(-5.0, -0.49, 0.25))  # tried, of torn samples and of jumps
WIDE = 4096.0  # counts: jumps of any size are spread evenly that far to both sides
CROSSED = 0.1  # chance of a sample to lie on another page than the one before, where it may
LEAST = 1e-200  # of a density: what a float still divides by
KNOCKED = (5.0, 15.0, 50.0)  # times the noise: what knocks, gaits and chattering contacts make


@dataclass(frozen=True, eq=False)
class Samples:
    """n samples against those around them: off, moved (n,): what those predict, and that by whole
    pages but 0, in standard deviations sigma (n,) counts; calm (n,) bool: those around agree;
    before, after (n,) bool: the page is that of the sample before, of the one after; stale, ahead
    (n,) codes a count: one in as many as the axis counts in, where the page is another one than
    before, or after, and the low byte is that of the sample there, 0 elsewhere."""

    off: np.ndarray
    moved: np.ndarray
    sigma: np.ndarray
    calm: np.ndarray
    before: np.ndarray
    after: np.ndarray
    stale: np.ndarray
    ahead: np.ndarray

    def __len__(self):
        return len(self.off)

    def subset(self, chosen):
        """Samples of a slice or a mask."""
        return Samples(*(getattr(self, f.name)[chosen] for f in fields(self)))


def together(tables):
    """Samples of several, None left out."""
    tables = [table for table in tables if table is not None]
    return Samples(*(np.concatenate([getattr(table, f.name) for table in tables] or [np.zeros(0)])
                     for f in fields(Samples)))


def tabled(column, banded, at_rest=None, again=None, width=PAGE, beside=0):
    """Samples of a column (n,) of whole numbers that are not at its ends, or None where noise
    hides a page; banded: a reading of 0 says nothing; at_rest (n,): which of them are in a rest,
    None: all; again (n,): which are rows read again: where the box turns, their page is that of
    the row before; width: counts of a page; beside: how far from the edges of bytes those of pages
    are: not 0, low bytes are not looked at, for what they say is the same wherever pages end."""
    around = np.lib.stride_tricks.sliding_window_view(column, 7)
    noise = 1.4826 / np.sqrt(2.0) * float(np.median(np.abs(np.diff(column))))
    span, middle = _beside(around)
    calm = span < CALM * max(noise, 1.0)
    level, same = _long(column, noise)
    same &= np.abs(level - middle) < 2.0 * max(noise, 1.0)
    level = np.where(calm, np.where(same, level, middle),
                     (4.0 * (around[:, 2] + around[:, 4]) - around[:, 1] - around[:, 5]) / 6.0)
    off = around[:, 3] - level
    sigma = np.ones(len(off))
    known = calm & same & (True if at_rest is None else at_rest[3:-3])
    for mask in (known, calm & ~known, ~calm):
        if mask.any():
            sigma[mask] = max(1.4826 * float(np.median(np.abs(off[mask]))), 1.0)
    # A hand is steady in one move and jerky in the next: there more is usual, for tails are not.
    here = 1.4826 * ndimage.median_filter(np.abs(off), 2 * LONG + 1, mode="nearest")
    sigma = np.where(calm, sigma, np.maximum(sigma, here))
    widest = np.where(known & _white(off / sigma, known), BLURRED, BLURRED_MOVING)
    keep = (sigma < widest) & ~_shadows(off, sigma, calm)
    if banded:
        keep &= (around != 0).all(axis=1)
    if again is not None:
        keep &= calm | ~np.lib.stride_tricks.sliding_window_view(again, 7).any(axis=1)
    if keep.sum() < FEWEST:
        return None
    off, sigma, page = off[keep], sigma[keep], (column + beside) // width
    pages = np.rint(off / width)
    pages = np.where(pages == 0.0, np.where(off < 0.0, -1.0, 1.0), pages)
    (before, after), (stale, ahead) = (
        [(byte[3:-3] == byte[3 + k:len(byte) - 3 + k])[keep] for k in (-1, 1)]
        for byte in (page, column % width))
    values, times = np.unique(column, return_counts=True)
    # What was read once may lie anywhere: a jump, a rail.
    codes = 0.0 if beside else 1.0 / registers.steps(values[times > 1][:, None])[0]
    return Samples(off / sigma, (off - width * pages) / sigma, sigma, calm[keep], before, after,
                   codes * (stale & ~before), codes * (ahead & ~after))


def _shadows(off, sigma, calm):
    """(n,) whether a sample, foreseen by the four beside it, is off because one of them jumps: by
    two thirds of the jump next to it, by a sixth behind that, which would be jumps of their own.
    """
    far = np.abs(off)
    largest = ndimage.maximum_filter1d(far, BESIDE)
    return ~calm & (largest > CALM * sigma) & (far < largest)


def _beside(around):
    """((n,) how far the six around each sample span, (n,) their median) of (n, 7)."""
    span, middle = np.empty(len(around)), np.empty(len(around))
    for first in range(0, len(around), AT_A_TIME):
        part = slice(first, first + AT_A_TIME)
        ordered = np.sort(around[part][:, [0, 1, 2, 4, 5, 6]], axis=1)
        span[part] = ordered[:, 5] - ordered[:, 0]
        middle[part] = 0.5 * (ordered[:, 2] + ordered[:, 3])
    return span, middle


def _long(column, noise):
    """((n,) median of many samples around, whether it is the same all the while). A page's
    edge stands still while a level known by few neighbours moves: which page a sample is likely
    to have had would be told from how far that level is off."""
    level = ndimage.median_filter(column, 2 * LONG + 1, mode="nearest").astype(float)
    change = ndimage.maximum_filter1d(level, 2 * LONG + 1) \
        - ndimage.minimum_filter1d(level, 2 * LONG + 1)
    return level[3:-3], change[3:-3] < max(noise, 1.0)


def _white(z, among):
    """Whether standardised residuals z (n,) among those (n,) tell little of the next ones."""
    pairs = among[1:] & among[:-1]
    z = np.clip(z, -NEAR, NEAR)
    now, following = z[:-1][pairs], z[1:][pairs]
    return float(now @ following) <= WHITE * float(now @ now)


@dataclass(frozen=True, eq=False)
class Densities:
    """How likely Samples are, their noise Student's t of so much freedom, some of them at a time:
    sound, a share of them jumping as `other` says, or jumping by what a function of a part says.
    """

    samples: Samples
    freedom: float
    share: float = 0.0
    other: object = None

    def _parts(self):
        """Triples of Samples, some at a time, their density (n,) when none jumps by pages, and
        (n,) when all do."""
        for first in range(0, len(self.samples), AT_A_TIME):
            part = self.samples.subset(slice(first, first + AT_A_TIME))
            paged_by = student(part.moved, self.freedom) / part.sigma
            density = student(part.off, self.freedom) / part.sigma
            if self.share:
                density = density + self.share * self.other(part, paged_by)
            yield part, density, paged_by

    def best(self, *jumps):
        """(log likelihood when none jumps by pages, [(gain in nats, share)] of the likeliest share
        of SHARES of samples that jump as each of jumps says, pairs of a function of a part and
        of its density moved by pages, and among how many of them). To samples that are not far
        off a jump adds to first order only."""
        alone = len(self.samples) * math.log1p(-self.share)
        gains = [np.array([among * math.log1p(-share) for share in SHARES])
                 for _, among in jumps]
        for part, density, paged_by in self._parts():
            alone += float(np.log(density).sum())
            far = np.abs(part.off) > NEAR
            for gain, (jump, _) in zip(gains, jumps):
                ratio = jump(part, paged_by) / density
                gain += np.array(SHARES) * ratio[~far].sum()
                ratio = ratio[far]
                ratio = ratio[ratio > 0.0]
                gain += [np.log1p(share * ratio).sum() for share in SHARES]
        places = [int(gain.argmax()) for gain in gains]
        return alone, [(float(gain[k]), SHARES[k]) for gain, k in zip(gains, places)]

    def otherwise(self):
        """(log likelihood as it is, [(gain, share)] of those that jump anywhere or are knocked,
        (share, jump) of the likeliest of them)"""
        others = [anywhere, *(louder(times, self.freedom) for times in KNOCKED)]
        alone, gains = self.best(*((jump, len(self.samples)) for jump in others))
        likeliest = max(range(len(others)), key=lambda k: gains[k][0])
        return alone, gains, (gains[likeliest][1], others[likeliest])

    def held(self, jump, share):
        """Expected number of samples that jump."""
        return float(sum(_held(density, share * jump(part, paged_by))
                         for part, density, paged_by in self._parts()))


def anywhere(part, paged_by):
    """A jump of any size."""
    return 0.5 / WIDE


def louder(times, freedom):
    """A jump: noise so many times as wide."""
    return lambda part, _: student(part.off / times, freedom) / (part.sigma * times)


def moved(part, paged_by):
    """A jump by pages, up or down."""
    return 0.5 * paged_by


def led_back(part, paged_by):
    """What a torn read is held against: a jump from wherever a page more or less leads, which way
    it was being known. Knocks and gaits are no noise, and some of theirs look torn by chance."""
    return paged_by


def torn_by(side):
    """A jump by a page that the sample before, or after, does not have; or to where the low byte
    before, or after, leads on another page, which is one count."""
    if side in ("stale", "ahead"):
        return lambda part, _: CROSSED * getattr(part, side)
    return lambda part, paged_by: paged_by * getattr(part, side)


def _held(sound, jump):
    return (jump / (sound + jump)).sum()


def student(z, freedom):
    """Density of Student's t."""
    peak = math.exp(math.lgamma(0.5 * (freedom + 1.0)) - math.lgamma(0.5 * freedom)
                    ) / math.sqrt(math.pi * freedom)
    return peak * np.maximum((1.0 + z * z / freedom) ** (-0.5 * (freedom + 1.0)), LEAST)
