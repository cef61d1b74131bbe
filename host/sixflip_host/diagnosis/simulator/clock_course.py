"""How the times of one log go against those of another of one motion: by an offset and a pace, or
by jumps and a slow wander besides. That is asked before anything else is compared, as a time that
is wrong looks like another scale, axis or motion. Where they jump or wander that is said, and both
logs are compared with their times put right.
"""
from dataclasses import dataclass, replace

import numpy as np

from .. import odds
from . import alignment, row_times, timing
from .lag_path import (
    BLURRED_S,
    FINE_S,
    GRID_HZ,
    INDEPENDENT_HZ,
    KNOT_S,
    PRESENT,
    REACH_S,
    Line,
    Turns,
    fine_path,
    first_path,
    fitted,
    interpolated,
)
from .parameters import Parameter

FINER = 2  # times that the path is looked for with what is known of the turns, and jumps placed
# Of the power that a line leaves, before jumps are placed to the row: 0.03 at most was seen of
# times that jump or wander. And of the turns: two hands that lay a box on the same faces turn it
# alike here and there, in a tenth of all (1.0 was seen where the times jump).
HALF = 0.5
NEAR_S = 2.0  # in which a jump that the path found is placed to the row: rests say nothing of it
SET = "nothing: a clock was set"


def found(real, sim, aligned):
    """The Fitted of two Traces by which the times of one run otherwise than by a line against the
    other's, or None: where it is likelier, and closes the gap but for a tenth of the turns, of
    most of them. What differs besides, as a robot's own ways, is then no matter of time."""
    if any(x.rate is None or not np.ptp(x.rate, axis=0).any() for x in (real, sim)) or min(
            real.seconds, sim.seconds) < alignment.LEAST_S:
        return None
    logs = Turns(real, sim)
    reach = np.clip(1.5 * max(abs(real.seconds - sim.seconds), abs(aligned.drift) * sim.seconds),
                    *REACH_S)
    path = first_path(logs, aligned, reach)
    if path is None:
        return None
    straight = [fitted(logs, line) for line in (
        Line(aligned.offset_s, aligned.drift, *np.zeros((3, 0))), _straight(*path))]
    if None in straight:
        return None
    base = min(straight, key=lambda one: one.power)
    tried = [one for one in (
        _along(logs, path, wanders, base.power) for wanders in (False, True)) if one]
    # What is left of the line is alike for longer than what is left of the right times.
    number = base.left.size / max(alignment.independent(one.left) for one in (base, *tried))

    def log(one):
        return -0.5 * number * np.log(one.power) - one.cost
    best = max(tried, key=log, default=base)
    likelier = log(best) - log(base) > PRESENT
    closes = best.power < (1.0 - odds.CLOSED) * base.power
    return best if likelier and closes and best.found > HALF else None


def _straight(drift, lags, block_s):
    """The Line of a path (drift, lags, s of a block) that has no jumps and no wander: of clocks
    that are further from each other than those that are tried for an alignment."""
    pace, offset = np.polyfit(block_s * (np.arange(len(lags)) + 0.5), lags / GRID_HZ, 1)
    return Line(offset, drift + pace, *np.zeros((3, 0)))


def _along(logs, path, wanders, power):
    """The Fitted whose jumps a path (drift, lags, s of a block) has, in finer blocks and placed to
    the row; None where too little of both logs is there, or where they close less than HALF of a
    power: those of another motion, of which each is costly to place."""
    best, t = None, FINE_S * (np.arange(int(len(logs.sim) / GRID_HZ / FINE_S)) + 0.5)
    for _ in range(FINER):
        line = fine_path(logs, *path, wanders)
        for _ in range(FINER):
            one = line and fitted(logs, line, wanders)
            if one is None or best is None and one.power > HALF * power:
                return best
            if best is None or one.power < best.power:
                best = one
            line = placed(logs, one)
        drift = best.line.drift
        path = drift, np.rint(GRID_HZ * (best.line.of_simulator(t) - (1.0 + drift) * t)), FINE_S
    return best


def placed(logs, one):
    """The Line of a Fitted with each jump at the row after which the times beyond it fit better,
    and parted in two where these are much better apart. By the rows of that log which is the
    shorter there, all of which the other one has."""
    line, times, sizes = one.line, [], []
    ends = np.concatenate([[-np.inf], line.times, [np.inf]])
    for k, (time, size) in enumerate(zip(line.times, line.sizes)):
        lacks = max(-size, 0.0)
        t = np.arange(max(time - NEAR_S - lacks, 0.5 * (ends[k] + time)),
                      min(time + NEAR_S, 0.5 * (ends[k + 2] + time)), 1.0 / GRID_HZ)
        if len(t) < 2:  # two jumps that the path has from block to block
            times, sizes = [*times, time], [*sizes, size]
            continue
        before = line.of_simulator(t) - np.where(t >= time, size, 0.0)
        off = []
        steps = np.linspace(0.0, abs(size), 1 + max(int(abs(size) * GRID_HZ + 0.5), 1))
        for step in steps:
            real, sim = (interpolated(values, at + step * own) for values, at, own in (
                (logs.real_read, before, size > 0.0), (logs.sim_read, t, size < 0.0)))
            off.append(((real @ one.turn[:3] + one.turn[3] - sim) ** 2).sum(axis=1))
        cuts, middle = _cuts(np.array(off))
        times += [t[0] + (cut - 0.5) / GRID_HZ + lacks * share for cut, share in zip(
            cuts, (middle / (len(steps) - 1), 1.0)[-len(cuts):])]
        parts = np.array([middle, len(steps) - 1 - middle][-len(cuts):])
        sizes += list(size * parts / parts.sum())
    order = np.argsort(times)
    return replace(line, times=np.array(times)[order], sizes=np.array(sizes)[order])


def _cuts(off):
    """((k,) rows at which the lag changes, step of the lag between, 0 for one change) of squares
    off (steps, rows): from the first step to the last at once, or by one that shows between, where
    a jump more earns what it costs."""
    sums = np.concatenate([np.zeros((len(off), 1)), np.cumsum(off, axis=1)], 1)
    whole, shows = sums[0] - sums[-1], int(2.0 * BLURRED_S * GRID_HZ)
    single, best = int(whole.argmin()), (np.inf,)
    for k in range(1, len(off) - 1 if off.shape[1] > shows else 1):
        first = (sums[0] - sums[k])[:-shows]
        both = np.minimum.accumulate(first) + (sums[k] - sums[-1])[shows:]
        end = int(both.argmin())
        best = min(best, (both[end], (int(first[:end + 1].argmin()), end + shows), k))
    power = [max(one + sums[-1, -1], 1e-30) for one in (whole[single], best[0])]
    earns = 0.5 * INDEPENDENT_HZ * off.shape[1] / GRID_HZ * -np.diff(np.log(power))[0]
    return best[1:] if earns > np.log(off.size * off.shape[1]) else ((single,), 0)


@dataclass(frozen=True)
class PutRight:
    """real, sim: Captures whose times go alike; parameters: [Parameter]; remarks: sentences."""

    real: object
    sim: object
    parameters: list
    remarks: list


def put_right(course, real, sim, captures):
    """PutRight of two Traces, the times of which go as a Fitted says, and of their two Captures.
    A log that is the shorter over a jump lacks rows under steady stamps, or its clock was set; but
    the other one's was, where its stamps have a gap as long."""
    line, parts = course.line, []
    lacking, moved = {"real": [], "sim": []}, {"real": [], "sim": []}  # [(from s on, by s)]
    for at, size, sigma in zip(line.times, line.sizes, course.sigma):
        there = float(line.of_simulator(at)) - max(size, 0.0)
        shorter, longer = (("real", there), ("sim", at))[::1 if size < 0.0 else -1]
        log, stamps = (real, captures[0].t_us) if longer[0] == "real" else (sim, captures[1].t_us)
        gap = row_times.gap_near(
            1e-6 * (stamps - stamps[0]), (longer[1] - NEAR_S, longer[1] + abs(size) + NEAR_S),
            abs(size), max(4.0 * sigma, 1.0 / log.rate_hz))
        if gap is None:
            lacking[shorter[0]].append((shorter[1], abs(size), float(sigma)))
        else:
            moved[longer[0]].append((gap, -abs(size)))
            parts.append(_set(log.name, longer[0], gap, abs(size)))
    for which, runs in lacking.items():
        if runs:
            logs = (real, sim) if which == "real" else (sim, real)
            whole = row_times.whole_runs(logs[0].rate_hz, runs)
            moved[which] += whole
            parts.append(_lacks(*logs, which, runs, whole))
    wander = _wander(line)
    if len(wander):
        parts.append(_wanders(real.name, sim.name, 1e3 * wander))

    def later(which, t):
        return sum((by * (t >= when) for when, by in moved[which]), np.zeros(len(t)))

    def wandered(t):
        if not len(wander):
            return 0.0
        steps = np.concatenate([[0.0], np.cumsum(line.sizes)])[np.searchsorted(
            line.of_simulator(line.times), t, "right")]
        return np.interp((t - steps - line.offset) / (1.0 + line.drift),
                         KNOT_S * np.arange(len(wander)), wander)
    return PutRight(
        row_times.with_times(captures[0], lambda t: later("real", t) - wandered(t)),
        row_times.with_times(captures[1], lambda t: later("sim", t)),
        list({p.name: p for p, _ in sorted(parts, key=lambda part: abs(
            part[0].difference))}.values()), [said for _, said in parts])


def _wander(line):
    """(m,) s of a Line's wander beyond a pace, none where that is nothing to tell."""
    if len(line.wander) < 3:
        return np.zeros(0)
    knots = np.arange(len(line.wander))
    wander = line.wander - np.polyval(np.polyfit(knots, line.wander, 1), knots)
    return wander if 1e3 * wander.std() > timing.LEAST_DELAY_MS else np.zeros(0)


def _told(name, unit, value, how):
    return Parameter(name, "device", "", unit, None, None, None, None, float(value), None, True,
                     None, how)


def _places(times):
    """Times (s) in words, the first three."""
    return ", ".join("%.1f s" % t for t in sorted(times)[:3]) + ", …" * (len(times) > 3)


def _set(name, which, when, size):
    ms = 1e3 * size * (1.0 if which == "real" else -1.0)
    return _told("clock_jump", "ms", ms, SET), (
        "the clock of %s was set by %.0f ms at %.1f s: its stamps have a gap there that no motion "
        "fills" % (name, abs(ms), when))


def _lacks(log, other, which, runs, whole):
    """(Parameter, sentence) of the rows that a Trace lacks beside another, or its clock's jumps;
    whole: as stamps are put right by."""
    nats, sign = row_times.whole_nats(log.rate_hz, runs), 1.0 if which == "real" else -1.0
    rows = np.rint([by * log.rate_hz for _, by in whole]).astype(int)
    ms, at = 1e3 * sum(size for _, size, _ in runs), _places([when for when, _, _ in runs])
    number = "%d places" % len(runs) if len(runs) > 1 else "one place"
    lost = "%d rows are missing in %s (%s) under steady stamps" % (rows.sum(), number, at)
    was_set = "its clock was set back by %.0f ms in %s (%s)" % (ms, number, at)
    by = "%s, by the motion of %s: " % (log.name, other.name)
    if nats > row_times.APART:
        how = "lose as many" if sign > 0.0 else "write every row of it"
        return _told("lost_rows", "rows", sign * rows.sum(), how), by + lost
    if nats < -row_times.APART:
        return _told("clock_jump", "ms", -sign * ms, SET), by + was_set
    return _told("clock_jump", "ms", -sign * ms, SET + ", or %d rows are missing" % rows.sum()), (
        "%s%s, or %s" % (by, lost, was_set))


def _wanders(name, other, ms):
    return (_told("clock_wander", "ms", ms.std(), "nothing: one of both clocks is not even"),
            "the clock of %s wanders against that of %s by %.1f ms (root mean square; %.0f to "
            "%.0f ms)" % (name, other, ms.std(), ms.min(), ms.max()))
