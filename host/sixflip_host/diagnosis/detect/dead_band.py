"""A dead band without a code that is missing, by two things that it does.

At rest an axis within it reads 0 with no noise, or with less than its sensor's others let it have;
where all of them do, with less than any such part has, as far as it has that in motion: what has
no noise there either is a simulator's, or smoothed, and reads 0 because it stands still.
What passes through it, where readings begin at 0 at its edges, stays at 0 for as long as the band
takes: each time a column goes through 0 its rate before and after says how far it has come, and
the readings say how far it seems to have come. What is missing is twice the band. Only what moves
much faster than the noise is asked, and a pause at 0 is no band.
"""
from dataclasses import dataclass

import numpy as np
from scipy import special

from ...capture import registers
from ...capture.registers import RAIL, steps
from ..odds import Z_90
from . import codes, lattice
from .detection import Finding, agreed_by_axis, present
from .lattice import LEAST_NOISE, WINDOW, of_zeros

FASTER = 3.0  # than the noise, from a sample to the next: its sign is that of the motion
LONGEST = 8  # samples at 0 while something passes; more is a pause
# Of a window's samples at 0: more are held there. All that rests may lie near 0, and what moves is
# not quiet; a narrower band leaves too little noise, and takes too little off what is missing.
HELD = 0.5
LEVELS, APART = (0.2, 0.3, 0.4, 0.6, 0.7, 0.8), 4.0  # quantiles of the readings; bands off 0
FEWEST = 20  # passages, whose median is known to a fifth of their scatter
# Standard deviation of a median over that of a mean, and of a normal one over the median of its
# sizes [Kendall & Stuart, The Advanced Theory of Statistics 1, section 10.10].
OF_MEDIAN, OF_SIZES = 1.2533, 1.4826
SILENT = 0.05  # counts of noise: one sample in four hundred is another code
QUIETER = 2.0  # times that an axis' noise is below the others' at most: Z of a MEMS gyro, 1.5
QUIET = 0.1  # share of the windows that is at rest


@dataclass(frozen=True)
class Band:
    """counts: half the width, with its standard error; number of passages it is told from."""

    counts: float
    error: float
    number: int

    @property
    def nats(self):
        """Log likelihood ratio over no band; one that is less than nothing has none."""
        return 0.5 * max(self.counts / self.error, 0.0) ** 2 if self.number else 0.0

    @property
    def interval(self):
        """(low, high) of 90 %."""
        return self.counts - Z_90 * self.error, self.counts + Z_90 * self.error


NOTHING = Band(0.0, 1.0, 0)


def findings(sensor, columns, at_rest, noise=0.0):
    """[Finding] of readings near 0 that are 0, by the codes that are missing or too frequent; on
    other axes by how the readings pass through 0, and by how quiet they are at rest there; noise:
    counts that any such part has at least."""
    words = "counts near 0 read 0"
    about = [[codes.resting(column) for column in c.T] for c in columns]
    if np.any(about):  # a bias was taken off before, and put back on
        words = "counts near %s read the same" % ", ".join(
            str(code) for code in dict.fromkeys(np.ravel(about).tolist()))
    columns = [np.clip(c.astype(np.int32) - np.array(code), -RAIL - 1, RAIL)
               for c, code in zip(columns, about)]
    lattices = [lattice.of_columns(c) for c in columns]
    numbers = [np.stack([one.numbers(column) for one, column in zip(ones, c.T)], 1)
               for c, ones in zip(columns, lattices)]
    spacings = [np.array([one.spacing for one in ones]) for ones in lattices]
    bands = [of_codes(c) for c in numbers]
    findings = agreed_by_axis(
        "dead_band", sensor, [np.rint(size * wide) for (size, _), wide in zip(bands, spacings)],
        [nats for _, nats in bands], words, [codes.zeros(c) for c in numbers])
    known = {axis for f in findings for axis in f.axes}
    nats, least = nats_of_rests(columns, at_rest, noise, lattices)
    value, interval, score, number = {}, {}, 0.0, 0
    for k, axis in enumerate("xyz"):
        if axis in known:
            continue
        band = band_of_columns([c[:, k] for c in columns])
        if band.counts > 1.0 and present(band.nats):
            value[axis], interval[axis] = round(band.counts), band.interval
            score, number = score + band.nats, number + band.number
        elif present(nats[k]):
            value[axis] = max(1, round(least[k]))
            # Beyond the largest reading it does not reach; more is not known.
            interval[axis] = value[axis], float(max(np.abs(c[:, k]).max() for c in columns))
            score, number = score + nats[k], number + int(np.sum([codes.zeros(c)[k]
                                                                  for c in columns]))
    if not value:
        return findings
    for f in findings:
        value, interval = {**f.value, **value}, {**f.interval, **interval}
        score, number = score + f.score, number + f.number
    return [Finding("dead_band", sensor, sorted(value), value, "counts", score, "amplitude", words,
                    interval, share=1.0, number=number)]


def of_codes(counts):
    """((3,) counts up to which an axis reads 0, by the codes that are missing or else by how often
    0 is read; (3,) nats)."""
    missing, nats = registers.dead_band(counts), codes.band_nats(counts)
    flat = np.array([of_zeros(column) for column in counts.T])
    return tuple(np.where((missing > 0) | (nats > flat[:, 1]), (missing, nats), flat.T))


def nats_of_rests(columns, at_rest, least=0.0, lattices=None):
    """((3,) nats of an axis' reading 0 at rest more often than the noise of its sensor's others
    lets it; (3,) counts, half the width that this takes at least). columns: list of (n, 3) counts;
    at_rest: list of (n,) bool; least: counts of noise that any such part has, where all three
    axes have none; lattices: list of 3 Lattice, what the axes count in."""
    nats, widths = np.zeros(3), np.full(3, np.inf)
    for counts, resting, ones in zip(columns, at_rest, lattices or [
            [lattice.COUNTS] * 3] * len(columns)):
        x = counts[resting].astype(np.int64)
        step = np.maximum(steps(counts), [one.spacing for one in ones])
        together = np.diff(np.flatnonzero(resting)) == 1
        if not together.any():
            continue
        change = np.diff(x, axis=0)[together]
        # Jumps are no noise of an axis. Where most samples repeat their median says nothing, and
        # jolts are none, either: it has as much as in motion at most.
        middle, moving = OF_SIZES * np.median(np.abs(change), axis=0), in_motion(counts)
        noise = np.minimum(np.where(middle > 0.0, middle, np.sqrt(2.0) * moving),
                           change.std(axis=0)) / np.sqrt(2.0)
        for axis in range(3):
            usual = float(np.median(np.delete(noise, axis)))
            if max(noise) < SILENT:
                usual = max(usual, min(least, moving))
            zero = ones[axis].numbers(x[:, axis]) == 0
            # What never leaves 0 is stuck, and what leaves it to one side has its end there.
            moves = counts[:, axis].min() < 0 < counts[:, axis].max() and counts[
                ~resting, axis].any()
            chance = special.erf(0.5 * step[axis] * QUIETER / max(usual, 1e-9) / np.sqrt(2.0))
            if middle[axis] > 0.0:  # it has noise of its own at rest, and may round it towards 0
                chance = max(chance, special.erf(step[axis] / middle[axis]))
            share = min(zero.mean(), 1.0 - 1.0 / len(x))
            if not moves or share <= chance:
                widths[axis] = 0.0
                continue
            each = share * np.log(share / chance) + (1.0 - share) * np.log(
                (1.0 - share) / (1.0 - chance))
            # What is held says one thing a window.
            nats[axis] += each * max(registers.number_of_runs(zero) / share, len(x) / WINDOW)
            widths[axis] = min(widths[axis], usual * special.ndtri(0.5 + 0.5 * share))
    return nats, widths


def in_motion(counts):
    """Counts of noise that readings (n, 3) have from one to the next where they are not 0: in the
    window in which an axis changes least, if at all; inf where there is no such window."""
    windows = counts[:len(counts) // WINDOW * WINDOW].astype(np.int64).reshape(-1, WINDOW, 3)
    change = np.diff(windows, axis=1).std(axis=1) / np.sqrt(2.0)
    return float(np.min(change[(windows != 0).all(axis=1) & (change > 0.0)], initial=np.inf))


def band_of_columns(columns):
    """Band of one axis, columns (n,) of counts of all sessions: what is missing about 0 beyond
    what seems to be about levels where no band can be, as far as the motion goes to and fro."""
    columns = [column.astype(np.int64) for column in columns]
    zero = _about(columns, 0)
    if not zero.number or zero.counts <= 0.0:
        return NOTHING
    every = np.concatenate(columns)
    levels = {int(level) for level in np.quantile(every, LEVELS)
              if abs(level) > APART * (zero.counts + zero.error)}
    others = [band for band in (_about(columns, level) for level in levels) if band.number]
    if not others:
        return NOTHING
    usual = float(np.median([band.counts for band in others]))
    error = float(np.median([band.error for band in others]))
    return Band(zero.counts - max(usual, 0.0), float(np.hypot(zero.error, error)), zero.number)


def _about(columns, level):
    """Band about a level (counts), NOTHING where too little passes through it."""
    missing = np.concatenate([passages(column - level) for column in columns])
    if len(missing) < FEWEST:
        return NOTHING
    middle = float(np.median(missing))
    scatter = OF_SIZES * float(np.median(np.abs(missing - middle)))
    # Readings are whole numbers: a median of them is known to a fraction of one at best.
    return Band(middle, OF_MEDIAN * max(scatter, 0.5) / np.sqrt(len(missing)), len(missing))


def passages(x):
    """(k,) counts that are missing on each side of 0 at each of the k passages of a column x (n,)
    through it."""
    windows = x[:len(x) // WINDOW * WINDOW].reshape(-1, WINDOW)
    away = windows[(windows == 0).mean(axis=1) < HELD]
    noise = float(np.quantile(np.diff(away, axis=1).std(axis=1), QUIET)) / np.sqrt(2.0) if len(
        away) else 0.0
    if noise < LEAST_NOISE:  # what has none pauses at 0 exactly
        return np.zeros(0)
    seen = np.flatnonzero(x)
    last, first = seen[:-1], seen[1:]
    through = (np.sign(x[last]) != np.sign(x[first])) & (first - last <= LONGEST) & (last > 0) & (
        first < len(x) - 1)
    last, first = last[through], first[through]
    sign = np.sign(x[first])
    before, after = (x[last] - x[last - 1]) * sign, (x[first + 1] - x[first]) * sign
    fast = np.minimum(before, after) > FASTER * noise
    # What swings through 0 is as fast on both sides, and of what settles towards something, as
    # behind a low-pass, each step is the same part of the one before: a mean of factors.
    rate = np.sqrt((before * after)[fast])
    came = (first - last)[fast] * rate - (np.abs(x[last]) + np.abs(x[first]))[fast]
    # The larger a step is by its noise, the likelier it is the one that goes through 0: by the
    # variance of the difference of two samples over the rate.
    return 0.5 * (came + 2.0 * noise ** 2 / rate)
