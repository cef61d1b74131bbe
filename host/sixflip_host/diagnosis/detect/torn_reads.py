"""Samples that mix the bytes of two readings.

Each sample is judged by those around it. Sound, it lies as far from what they predict as the
noise of the axis allows. Torn, it has the page (high byte) of the sample before, or after, and
would lie so near with a page more or less. What has no name jumps by any amount, or by whole
pages whatever the pages around. Torn reads are found where a share of the samples being torn
makes all samples likelier than the same jumps do without a name.
"""
import math

import numpy as np
from scipy import ndimage

from ...capture import registers
from .. import odds
from .detection import Finding, present

PAGE = 256
WIDE = 4096.0  # counts: jumps of any size are spread evenly that far to both sides
FEWEST = 50  # samples before the noise of a column is known
SHARES = tuple(10.0 ** np.arange(-5.0, -0.49, 0.25))  # tried, of torn samples and of jumps
FREEDOM = (5.0, 15.0, 200.0)  # of Student's t: how heavy the tails of the noise are
CALM = 8.0  # standard deviations that the neighbours of a sample at rest may span
LONG = 25  # samples on each side: their median errs by a sixth of the noise
LOUD = (2.0, 3.0, 5.0)  # times the noise, of samples that are louder without a name
NEAR = 2.0  # standard deviations within which a sample's chance of a jump is small
LEAST = 1e-200  # of a density: what a float still divides by
BLURRED = 100.0  # counts: with wider noise a page more or less tells nothing


def finding(sessions, sensor, banded=()):
    """[Finding] of torn reads in a sensor, or []; banded: axes on which readings near 0 read 0,
    which are jumps with a name."""
    columns = [getattr(s.capture, sensor) for s in registers.of_counts(sessions, sensor)]
    tables = [tabled(counts[:, axis].astype(np.int64), axis in banded)
              for counts in columns if len(counts) >= FEWEST for axis in range(3)]
    tables = [t for t in tables if t is not None]
    if not tables:
        return []
    table = np.concatenate(tables, axis=1)
    nats, number, others = competed(table)
    if not present(nats):
        return []
    chances = sum(int((np.diff(column // PAGE) != 0).sum()) for counts in columns
                  for column in counts.T.astype(np.int64))
    percent = 100.0 * number / max(chances, number, 1.0)
    half = 1.645 * percent / np.sqrt(max(number, 1.0))
    return [Finding("torn_reads", sensor, [], {"chance": round(percent, 3)}, "%", nats, "noise",
                    "about %.0f samples mix the bytes of two readings" % number,
                    {"chance": (max(percent - half, 0.0), percent + half)},
                    share=float(number / max(number + others, 1e-9)),
                    number=max(1, round(number + others)))]


def jumps(sessions, without=()):
    """[(sensor, sentence, p)] of jumps by whole pages that nothing torn explains."""
    found = []
    for sensor, words in (("accel", "accelerometer"), ("gyro", "gyro")):
        if sensor in without or any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        counted = registers.of_counts(sessions, sensor)
        columns = [getattr(s.capture, sensor) for s in counted]
        # A hand trembles as far as a page is wide: only rests are quiet enough.
        rests = [np.concatenate([counts[run.first:run.end] for run in s.runs])
                 for s, counts in zip(counted, columns) if s.runs]
        tables = [tabled(counts[:, axis].astype(np.int64), False)
                  for counts in rests if len(counts) >= FEWEST for axis in range(3)]
        tables = [t for t in tables if t is not None]
        table = np.concatenate(tables, axis=1) if tables else np.zeros((8, 0))
        nats, number = paged(table)
        if present(nats):
            found.append((sensor, "about %.0f samples of the %s are off by 256 counts: a bit that "
                          "is read wrongly" % (number, words), odds.chance(nats)))
    return found


def paged(table):
    """(nats of jumps by whole pages over none, over jumps of any size and over samples that are
    louder, as where the box is put down; their number) of a table (8, n) of tabled(), among
    calm samples."""
    # Without the pages around, one more is seen only beyond what neighbours may span.
    off, moved, sigma = table[:3, (table[3] > 0.0) & (table[2] < PAGE / CALM)]
    if len(off) < FEWEST:
        return 0.0, 0.0
    far, whole, other = np.abs(off) > NEAR, [], []
    for freedom in FREEDOM:
        sound, jumped = (student(z, freedom) / sigma for z in (off, moved))
        alone = float(np.log(sound).sum())
        gain, share = _best(sound, jumped, far, len(off))
        whole.append((alone + gain, float(_held(sound, share * jumped))))
        other += [alone, alone + _best(sound, np.full(len(off), 0.5 / WIDE), far, len(off))[0]]
        other += [alone + _best(sound, student(off / times, freedom) / (sigma * times), far,
                                len(off))[0] for times in LOUD]
    score, number = max(whole)
    return score - max(other) - math.log(len(SHARES)), number


def competed(table):
    """(nats over what has no name, samples torn, samples that jump otherwise) of a table (8, n)
    of tabled(), torn with the page of the sample before or of the one after. Shares of jumps and
    tails of the noise are the likeliest of those tried, in each hypothesis by itself; what was
    tried for the name's sake is paid."""
    off, moved, sigma = table[:3]
    far = np.abs(off) > NEAR
    anywhere = np.full(len(off), 0.5 / WIDE)
    pages = [(table[4 + 2 * k], table[5 + 2 * k].sum()) for k in (0, 1)]
    named, nameless = ([], []), []
    for freedom in FREEDOM:
        sound, jumped = (student(z, freedom) / sigma for z in (off, moved))
        alone = float(np.log(sound).sum())
        wide, share = _best(sound, anywhere, far, len(off))
        nameless += [alone, alone + wide, alone + _best(sound, jumped, far, len(off))[0]]
        beside = sound + share * anywhere  # beside the torn ones there may be others
        rest = alone + len(off) * math.log1p(-share) + float(np.log(beside / sound).sum())
        nameless.append(rest + _best(beside, jumped, far, len(off))[0])
        for tried, (same, chance) in zip(named, pages):
            mixed = jumped * same
            torn, own = _best(sound, mixed, far, chance)
            tried.append((alone + torn, float(_held(sound, own * mixed)), 0.0))
            torn, own = _best(beside, mixed, far, chance)
            tried.append((rest + torn, float(_held(beside, own * mixed)),
                          float(_held(sound + own * mixed, share * anywhere))))
    score, number, others = max(max(tried) for tried in named)
    return score - max(nameless) - math.log(2.0 * len(SHARES)), number, others


def _best(sound, jump, far, among):
    """(gain in nats, share) of the likeliest share of SHARES of samples that jump; `among` of
    them could. To samples that are not far off a jump adds to first order only."""
    near = float((jump[~far] / sound[~far]).sum())
    ratio = jump[far] / sound[far]
    ratio = ratio[ratio > 0.0]
    gains = [float(np.log1p(s * ratio).sum()) + s * near + among * math.log1p(-s)
             for s in SHARES]
    place = int(np.argmax(gains))
    return gains[place], SHARES[place]


def _held(sound, jump):
    """Expected number of samples that jump."""
    return (jump / (sound + jump)).sum()


def tabled(column, banded):
    """(8, n) of the samples of a column that are not at its ends: off what those around predict
    and off that by whole pages but 0, in standard deviations; these in counts; whether those
    around agree; whether the page is that of the sample before, whether a torn one would show;
    the same of the one after. None where noise hides a page."""
    around = np.lib.stride_tricks.sliding_window_view(column, 7)
    beside = around[:, [0, 1, 2, 4, 5, 6]]
    noise = 1.4826 / np.sqrt(2.0) * float(np.median(np.abs(np.diff(column))))
    calm = np.ptp(beside, axis=1) < CALM * max(noise, 1.0)
    long, same = _long(column, noise)
    same &= np.abs(long - np.median(beside, axis=1)) < 2.0 * max(noise, 1.0)
    level = np.where(calm, np.where(same, long, np.median(beside, axis=1)),
                     (4.0 * (around[:, 2] + around[:, 4]) - around[:, 1] - around[:, 5]) / 6.0)
    off = around[:, 3] - level
    sigma = np.ones(len(off))
    for mask in (calm & same, calm & ~same, ~calm):
        if mask.any():
            sigma[mask] = max(1.4826 * float(np.median(np.abs(off[mask]))), 1.0)
    keep = sigma < BLURRED
    if banded:
        keep &= (around != 0).all(axis=1)
    if keep.sum() < FEWEST:
        return None
    around, off, sigma, calm = around[keep], off[keep], sigma[keep], calm[keep]
    pages = np.rint(off / PAGE)
    pages = np.where(pages == 0.0, np.where(off < 0.0, -1.0, 1.0), pages)
    out = [off / sigma, (off - PAGE * pages) / sigma, sigma, calm]
    for neighbour in (2, 4):
        same = around[:, neighbour] // PAGE == around[:, 3] // PAGE
        out += [same, ~same]
    return np.array(out, float)


def _long(column, noise):
    """((n,) median of many samples around, whether it is the same all the while). A page's
    edge stands still while a level known by few neighbours moves: which page a sample is likely
    to have had would be told from how far that level is off."""
    level = ndimage.median_filter(column, 2 * LONG + 1, mode="nearest").astype(float)
    change = ndimage.maximum_filter1d(level, 2 * LONG + 1) \
        - ndimage.minimum_filter1d(level, 2 * LONG + 1)
    return level[3:-3], change[3:-3] < max(noise, 1.0)


def student(z, freedom):
    """Density of Student's t."""
    peak = math.exp(math.lgamma(0.5 * (freedom + 1.0)) - math.lgamma(0.5 * freedom)
                    ) / math.sqrt(math.pi * freedom)
    return peak * np.maximum((1.0 + z * z / freedom) ** (-0.5 * (freedom + 1.0)), LEAST)
