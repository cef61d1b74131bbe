"""Samples that mix the bytes of two readings.

Each sample is judged by those around it. Sound, it lies as far from what they predict as the
noise of the axis allows. Torn, it has the page (high byte) of the sample before, or after, and
would lie so near with a page more or less; or it has a page of its own and the low byte of the
sample before, or after. What has no name jumps by any amount, or by whole pages whatever the
pages around. Torn reads are found where a share of the samples being torn
makes all samples likelier than the same jumps do without a name. What moves has peaks and kinks
that look torn as often wherever pages end, and of other widths, too: only what is beyond those is
of bytes.
"""
import math
from dataclasses import dataclass

import numpy as np

from ...capture import registers
from .. import odds
from .detection import Finding, present
from .sample_neighbours import (
    FEWEST,
    PAGE,
    SHARES,
    Densities,
    anywhere,
    led_back,
    louder,
    moved,
    tabled,
    together,
    torn_by,
)

FREEDOM = (5.0, 15.0, 200.0)  # of Student's t: how heavy the tails of the noise are
LOUD = (2.0, 3.0, 5.0)  # times the noise, of samples that are louder without a name
# Counts that no byte is wide: what speaks for pages of these too is the motion of legs, wheels or
# a knock, not the bytes. As far from a page as two samples differ where a page is looked at.
NO_PAGES = (150, 163, 181, 300, 337, 367)
# Counts beside a page's edge, where no byte ends: what motion makes look torn looks so there, too.
NO_EDGES = (PAGE // 4, PAGE // 2, 3 * PAGE // 4)
# Standard deviations that a page is wide at least, where the pages around say nothing: of normal
# noise one sample in 16,000 is so far off, and a heavier tail competes.
BEYOND = 4.0


def finding(sessions, sensor, banded=()):
    """[Finding] of torn reads in a sensor, or []; banded: axes on which readings near 0 read 0,
    which are jumps with a name."""
    samples = _samples(sessions, sensor, banded, PAGE)
    # Beside what has no name being torn gains less, so that most sensors need no competition.
    if not len(samples) or not present(_at_most(samples, [
            (torn_by(side), among) for side, among in _chances(samples).items()])):
        return []
    nats, number, torn = competed(samples)
    if present(nats):
        unlike = [*(_samples(sessions, sensor, banded, width) for width in NO_PAGES),
                  *(_samples(sessions, sensor, banded, PAGE, beside) for beside in NO_EDGES)]
        nats = _beyond(nats, [competed(other)[0] for other in unlike if len(other)])
    if not present(nats):
        return []
    # Of the samples looked at: whose page changed, and whose change the tear hid.
    chances = float((samples.before == 0).sum()) + number
    percent = 100.0 * number / max(chances, 1.0)
    half = 1.645 * percent / np.sqrt(max(number, 1.0))
    return [Finding("torn_reads", sensor, [], {"chance": round(percent, 3)}, "%", nats, "noise",
                    "about %.0f samples mix the bytes of two readings" % number,
                    {"chance": (max(percent - half, 0.0), percent + half)}, **torn.share())]


def _beyond(nats, of_no_page):
    """What nats of pages are beyond the most that widths and edges which are none of a page have,
    in standard deviations, of which nats are half the square."""
    most = max([*of_no_page, 0.0])
    return 0.5 * max(math.sqrt(2.0 * max(nats, 0.0)) - math.sqrt(2.0 * most), 0.0) ** 2


def _samples(sessions, sensor, banded, width, beside=0):
    """Samples of all sessions and axes against pages so many counts wide, which end so many counts
    beside those of bytes."""
    return together([
        tabled(counts[:, axis].astype(np.int64), axis in banded, s.at_rest,
               _again(counts), width, beside)
        for s in registers.of_counts(sessions, sensor)
        for counts in [getattr(s.capture, sensor)] if len(counts) >= FEWEST
        for axis in range(3)])


def _again(counts):
    """(n,) which rows of counts (n, 3) are the same as the one before."""
    return np.concatenate([[False], (counts[1:] == counts[:-1]).all(axis=1)])


def jumps(sessions, without=()):
    """[(sensor, sentence, p)] of jumps by whole pages that nothing torn explains."""
    sentences = []
    for sensor, words in registers.SENSORS.items():
        if sensor in without or any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        counted = registers.of_counts(sessions, sensor)
        columns = [getattr(s.capture, sensor) for s in counted]
        # A hand trembles as far as a page is wide: only rests are quiet enough.
        rests = [np.concatenate([counts[run.first:run.end] for run in s.runs])
                 for s, counts in zip(counted, columns) if s.runs]
        by_width = (together([tabled(counts[:, axis].astype(np.int64), False, width=width)
                              for counts in rests if len(counts) >= FEWEST for axis in range(3)])
                    for width in (PAGE, *NO_PAGES))
        nats, number = paged(next(by_width))
        if present(nats):
            nats = _beyond(nats, [paged(other)[0] for other in by_width])
        if present(nats):
            sentences.append((
                sensor, "about %.0f samples of the %s are off by 256 counts: a bit that is read "
                "wrongly" % (number, words), odds.chance(nats)))
    return sentences


def paged(samples):
    """(nats of jumps by whole pages over none, over jumps of any size and over samples that are
    louder, as where the box is put down; their number) of Samples, among calm ones."""
    samples = samples.subset(samples.calm.astype(bool) & (samples.sigma < PAGE / BEYOND))
    if len(samples) < FEWEST or not present(_at_most(samples, [(moved, len(samples))])):
        return 0.0, 0.0
    whole, other, number = [], [], len(samples)
    for freedom in FREEDOM:
        densities = Densities(samples, freedom)
        alone, ((gain, share), *rivals) = densities.best(
            (moved, number), (anywhere, number),
            *((louder(times, freedom), number) for times in LOUD))
        whole.append((alone + gain, densities, share))
        other += [alone, *(alone + gain for gain, _ in rivals)]
    score, densities, share = max(whole, key=lambda jumping: jumping[0])
    return score - max(other) - math.log(len(SHARES)), densities.held(moved, share)


def competed(samples):
    """(nats over what has no name, samples torn, the likeliest Torn) of Samples, torn with the
    page, or with the low byte, of the sample before or of the one after. Shares of jumps and tails
    of the noise are the likeliest of those tried, in each hypothesis by itself; what was tried for
    the name's sake is paid."""
    chances, number, named, nameless = _chances(samples), len(samples), [], []
    for freedom in FREEDOM:
        densities = Densities(samples, freedom)
        alone, knocked, otherwise = densities.otherwise()
        nameless += [alone, *(alone + other for other, _ in knocked)]
        beside = Densities(samples, freedom, *otherwise)
        for noise in (densities, beside):  # without others, and beside the likeliest share of them
            alone, ((by_pages, _), *torn) = noise.best(
                (led_back, number), *((torn_by(side), among) for side, among in chances.items()))
            nameless.append(alone + by_pages)
            named += [(alone + gain, noise, side, own) for side, (gain, own) in zip(chances, torn)]
    score, densities, side, own = max(named, key=lambda tear: tear[0])
    torn = Torn(densities, torn_by(side), own)
    tried = math.log(len(chances) * len(SHARES))
    return score - max(nameless) - tried, torn.number, torn


def _chances(samples):
    """{side: among how many of Samples one may be torn so}"""
    chances = {side: float(len(samples) - getattr(samples, side).sum())
               for side in ("before", "after")}
    return {**chances, "stale": chances["before"], "ahead": chances["after"]}


def _at_most(samples, jumps):
    """Nats that Samples gain at most by jumps, as Densities.best takes them, whatever competes."""
    return max(gain for freedom in FREEDOM
               for gain, _ in Densities(samples, freedom).best(*jumps)[1])


@dataclass(frozen=True, eq=False)
class Torn:
    """That a share of samples is torn, jumping as a function of a part of them says, with the
    Densities that they have else."""

    densities: object
    jump: object
    often: float

    @property
    def number(self):
        """How many of all samples are expected to be torn."""
        return self.densities.held(self.jump, self.often)

    def share(self):
        """{share, number} of a Finding: of the samples that jump, where those around agree,
        those that are torn (noise with tails is near, and no jump); where a hand moves the box
        it makes some as loud, which is no departure. None where too few samples are calm."""
        calm = self.densities.samples.subset(self.densities.samples.calm.astype(bool))
        if len(calm) < FEWEST:
            return {"share": None}
        beside = Densities(calm, self.densities.freedom, self.often, self.jump)
        (gain, often), = beside.best((anywhere, len(calm)))[1]
        if not present(gain):
            return {"share": 1.0, "number": max(1, round(self.number))}
        others = beside.held(anywhere, often)
        torn = Densities(calm, self.densities.freedom).held(self.jump, self.often)
        return {"share": torn / (torn + others), "number": max(1, round(torn + others))}
