"""Readings that stand over several rows while what they are of goes on.

The sensor is slower than the rows are. Either the same counts stand there again
(a board that reads faster than the chip measures, a simulator that publishes faster than it
steps), or the value is held and noise is drawn anew for every row (a noise model behind the slow
source), so that no two rows are alike.
"""
from dataclasses import dataclass, replace

import numpy as np

from ..detect import unread_rows
from . import convention_findings, conventions

WINDOW_ROWS = 40  # over which it is told whether a sensor moves: more than LONGEST
# Eighths of a step that a reading has to change by, a row on average over a window: with less, two
# rows of a moving sensor are often alike without being held.
MOVING = 8.0
LONGEST = 25  # rows that a reading is looked for to be held under noise: 4 Hz at 100 rows a second
# Of the changes from row to row, the largest: each says no more than the smallest of them, so that
# odd rows, as of a knock, tell nothing. A quarter of the rises that the longest stairs have.
ODD = 0.01
LEAST = 1.5  # rows from which on a reading is held at all: half of the rows say nothing new
SLOWER = 0.8  # of the real log's own rate of new readings: oscillators differ by 2 % (ITG-3205)
# Of a change from row to row, in counts: each row is rounded by 1/12 of a square count.
ROUNDED = 1.0 / 6.0


@dataclass(frozen=True)
class Hold:
    """rows that a reading stands for, 1.0 where every row is new; starts (n,) bool: rows with
    which a new reading begins."""

    rows: float
    starts: np.ndarray

    @property
    def held(self):
        return self.rows >= LEAST


def holds(trace):
    """{sensor: Hold} of a Trace."""
    return {kind: sensor_hold(None if values is None else _as_read(values, step), step,
                              trace.rests)
            for kind, values, step in (("accel", trace.force, trace.quantum[0]),
                                       ("gyro", trace.rate, trace.quantum[1]))}


def _as_read(values, quantum):
    """values (n, 3) with a straight line over the rows that nobody read."""
    unread = unread_rows.nobody_read(np.rint(values / quantum).astype(np.int64))
    if not len(unread):
        return values
    read = np.setdiff1d(np.arange(len(values)), unread)
    return np.stack([np.interp(np.arange(len(values)), read, x[read]) for x in values.T], 1)


def sensor_hold(values, quantum, rests=()):
    """The Hold of a sensor's values (n, 3) or None, read in steps of quantum; rests: where
    it stands still."""
    if values is None or len(values) < 4 * WINDOW_ROWS:
        return Hold(1.0, np.ones(0 if values is None else len(values), bool))
    change = np.abs(np.diff(values, axis=0)).max(axis=1)
    fresh = change > 0.25 * quantum
    wide = np.convolve(change, np.ones(WINDOW_ROWS), "same")
    moving = wide > max(MOVING * quantum * WINDOW_ROWS / 8.0, np.quantile(wide, 0.6))
    if moving.sum() < 2 * WINDOW_ROWS:
        return Hold(1.0, np.ones(len(values), bool))
    rows = float(1.0 / max(fresh[moving].mean(), 1e-3))
    at_random = Hold(rows, np.concatenate([[True], change > 0]))
    stairs = under_noise(values / quantum, moving, rests)
    if at_random.held and not (stairs.held and likelier(stairs, values / quantum, moving, rests)):
        return at_random
    return stairs


def likelier(stairs, counts, moving, rests):
    """Whether a Hold of stairs says more of counts (n, 3) than that readings come at random rows,
    each other than the last: noise of a tenth of a count changes a held reading, too, where it
    lies between two codes."""
    change = np.diff(counts, axis=0)[moving]
    rises = stairs.starts[1:][moving]
    fresh = change.any(axis=1)
    noise = noise_of_changes(counts, rests)
    of_stairs = normal(change[rises]) + normal(change[~rises], noise)
    share = np.clip(fresh.mean(), 1e-3, 1.0 - 1e-3)
    of_random = normal(change[fresh]) + fresh.sum() * np.log(share) + (
        ~fresh).sum() * np.log(1.0 - share)
    return of_stairs > of_random


def normal(change, variance=None):
    """Log likelihood of changes (n, 3) in counts, with the variance that suits them best."""
    if not len(change):
        return 0.0
    if variance is None:
        variance = np.maximum((change ** 2).mean(axis=0), ROUNDED)
    return -0.5 * (change ** 2 / variance + np.log(2.0 * np.pi * variance)).sum()


def noise_of_changes(counts, rests):
    """(3,) variance of the change of counts (n, 3) from row to row at rest, of rounding at least;
    None without a rest."""
    still = [np.diff(counts[a:b], axis=0) for a, b in rests if b - a > 2]
    return np.maximum(np.concatenate(still).var(axis=0), ROUNDED) if still else None


def under_noise(counts, moving, rests):
    """The Hold of counts (n, 3) that stand for some rows but for noise: stairs against a ramp.

    Where a sensor moves, a row differs from the row before by the slope and whatever shakes the
    robot, of any size. On stairs of k rows it differs by no more than at rest, but at each k-th,
    where the whole step comes. Half of the differences count, since neighbours share a row; every
    k and first row is as likely. rests: ((first, end), ...), where that noise is known from.
    """
    n = len(counts)
    everywhere = Hold(1.0, np.ones(n, bool))
    noise = noise_of_changes(counts, rests)
    if noise is None:
        return everywhere
    change, row = np.diff(counts, axis=0), np.arange(1, n)
    mask = np.concatenate([moving[1:], [False]]) & moving
    most = np.quantile(np.abs(change[mask]), 1.0 - ODD, axis=0)
    change = np.clip(change, -most, most)  # stairs are told by many rises, not by an odd row
    best = (0.0, 1, 0)
    for k in range(2, LONGEST + 1):
        # The change over k rows does not depend on where the stairs begin; smooth over k again.
        kernel = np.convolve(np.ones(k), np.ones(k)) / k ** 2
        slope = np.column_stack([np.convolve(c, kernel, "same") for c in change.T])
        ramp = (change - slope) ** 2
        level = ramp[mask].mean(axis=0) + ROUNDED
        told = 0.25 * (ramp / level + np.log(level) - change ** 2 / noise
                       - np.log(noise)).sum(axis=1)[mask]
        # each first row leaves out the rows on which its stairs rise
        nats = told.sum() - np.bincount(row[mask] % k, told, minlength=k)
        first = int(np.argmax(nats))
        if nats[first] > best[0]:
            best = nats[first], k, first
    nats, k, first = best
    ways = sum(range(2, LONGEST + 1))
    sure = convention_findings.CERTAIN / (1.0 - convention_findings.CERTAIN)
    if nats < np.log(ways * (1.0 - conventions.PRIOR_EACH) / conventions.PRIOR_EACH * sure):
        return everywhere
    starts = np.arange(n) % k == first
    starts[0] = True
    return Hold(float(k), starts)


def free(trace, holds):
    """The Trace with what is held in a straight line from one new reading to the next: what it
    would say without the hold. A reading is the mean of the rows it stands in."""
    freed = trace
    for name, kind in (("force", "accel"), ("rate", "gyro")):
        values = getattr(trace, name)
        if values is None or not holds[kind].held:
            continue
        at = np.flatnonzero(holds[kind].starts)
        means = np.add.reduceat(values, at, axis=0) / np.diff(np.append(at, len(values)))[:, None]
        made = np.stack([np.interp(trace.t, trace.t[at], means[:, i]) for i in range(3)], 1)
        if len(at) > 1:  # on from the last one as between the last two, until the log ends
            slope = (means[-1] - means[-2]) / max(trace.t[at[-1]] - trace.t[at[-2]], 1e-9)
            made[at[-1]:] = means[-1] + np.outer(trace.t[at[-1]:] - trace.t[at[-1]], slope)
        freed = replace(freed, **{name: made})
    return freed


def smoothing_s2(hold, trace):
    """By how much free() makes a sensor's readings smoother, as half the square of a time
    constant: straight lines from one to the next are a mean with a triangle of two periods."""
    return (hold.rows / trace.rate_hz) ** 2 / 12.0 if hold.held else 0.0


def findings(real, sim, holds_real, holds_sim):
    """Conventions of sensors that the simulator holds and the real log does not."""
    held = []
    for kind, hold in holds_sim.items():
        hz = real.rate_hz / holds_real[kind].rows, sim.rate_hz / hold.rows
        if hold.held and hz[1] <= SLOWER * hz[0]:
            held.append(convention_findings.finding(
                kind + "_rate_held", kind, 1.0, 100.0, "update it %.4g times a second: it says "
                "something new every %.3g rows" % (hz[0], hold.rows), value={"rate": hz[1]},
                unit="Hz"))
    return held


def beside(delay, rate_hz, holds_sim):
    """The Convention of a sensor that is late, told from how long its readings stand: a reading
    counts from the row with which it begins, and its rows are later than that on average."""
    kind = delay.sensor
    if not holds_sim[kind].held:
        return delay
    ms = 1e3 * (holds_sim[kind].rows - 1.0) / 2.0 / rate_hz
    return replace(delay, set_to="%s, besides the %.1f ms by which its rows are late on average "
                   "because they repeat readings" % (delay.set_to, ms))
