"""The even clock under the stamps of a recording: a first guess of its period, and where its
lower envelope is lifted.

A stamp cannot be earlier than its sample, unless it is that of a row before, which the recorder
did not renew. So the even clock is the lower envelope of the others: what rises above it and comes
back is late, what lifts it for good is a gap.
"""

import math

import numpy as np

ON_GRID, MOSTLY = 0.25, 0.9     # intervals within a quarter of whole periods, and how many are
SPANS = tuple(2 ** k for k in range(1, 12))     # rows that a burst may have
PACE_ROWS = 8           # a span that tells the pace
FORGOTTEN = 8           # rows in a row whose stamps are not renewed, at most
REACH = 64              # rows in which a recorder that was late catches up
EVEN = 0.1              # scatter of spans, of their length, that are beyond the bursts
PART = 0.7              # of a period: less is no sample
MOST_WHOLE = 2.0        # periods a row on the mean: with more the usual interval is a burst's
COARSE = 1.5            # periods that a step of the stamps has where rows share a stamp
PAUSE_S, PAUSE_ROWS = 1.0, 10   # a gap that is longer than both is a pause whatever its phase
NOISE = 6.0             # times the envelope's own scatter: gaps below are none
COUNTED = 1 << 16       # rows at a time
STANDS = 0.1  # of the gaps of a recorder that loses samples, at most, in which it stood still
LATE = 0.001  # periods, at least: how exactly a stamp tells the time of a sample, 10 us at 100 Hz
# Times as exactly, tried: stamps have other tails than normal ones. By up to three of them a gap
# is shorter: it begins with a row as late as any, while the clock goes by the earliest ones.
WIDER, SHORTER = (1.0, 4.0, 16.0), (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
# Of the later pace, what rows that a link still held when the recording began take at most; times
# their interval, up to which a later row that catches up comes as fast; and how many of those
# there are at least. Seen: 0.25, 1.1 to 1.2 and a tenth of the rows; a recorder whose rate was
# changed has none.
HURRIED, AS_FAST, CATCH_UP = 0.5, 1.25, 0.02


def first_guess(t_us, known):
    """(period in µs, rows that a burst has at most, whether most intervals tell by themselves how
    many periods they last)."""
    even, step = float(t_us[-1] - t_us[0]) / (len(t_us) - 1), resolution(t_us)
    if PART * even < step < COARSE * even and np.ptp(
            (t_us - t_us[0]) - np.arange(len(t_us)) * even) < 2.0 * step:
        return even, 1, False  # stamps cut off to about a period: the usual interval is their step
    gaps = np.diff(t_us[:COUNTED + 1]).astype(float)
    gaps = np.delete(gaps, known[known < len(gaps)])
    if not len(gaps):
        gaps = np.diff(t_us).astype(float)
    usual = float(np.median(gaps))
    if usual > 0:
        whole = np.rint(gaps / usual)
        near = ((whole >= 1) | _not_renewed(gaps, whole)) & (
            np.abs(gaps / usual - whole) < ON_GRID)
        if near.mean() >= MOSTLY and (whole.mean() < MOST_WHOLE
                                      or step < ON_GRID * usual and _loses_rows(gaps, whole)):
            return _pace(gaps, whole == 1), 1, True
    times = np.concatenate([[0.0], np.cumsum(gaps)])
    for rows in SPANS:
        if rows * 4 > len(times):
            break
        spans = times[rows:] - times[:-rows]
        middle = float(np.median(spans))
        if middle > 0 and 1.4826 * np.median(np.abs(spans - middle)) < EVEN * middle:
            return middle / rows, rows, False
    return float(t_us[-1] - t_us[0]) / (len(t_us) - 1), max(1, len(t_us) // 8), False


def _not_renewed(gaps, whole):
    """bool (n,): intervals, gaps (n,) µs, of nothing beside one that is several periods, whole
    (n,), long: a row has the stamp of the one before it, or came late and with the next one. Where
    a link hands rows over by twos such intervals are as many as those of a period."""
    several = np.concatenate([[False], whole >= 2, [False]])
    again = (gaps == 0) & (several[:-2] | several[2:])
    return again & (again.sum() < (whole == 1).sum())


def _loses_rows(gaps, whole):
    """True where a tenth of the intervals, gaps (n,) µs, are several periods, whole (n,), long,
    which those within a burst are not, and it is the recorder's pauses that make their mean long:
    what comes in bursts whose ends are so far apart has a row a period on the mean of each."""
    usual = float(np.median(gaps))
    pause = (gaps > PAUSE_S * 1e6) & (gaps > PAUSE_ROWS * usual)
    shorter, ends = whole[~pause], np.flatnonzero(pause) + 1
    if not len(shorter) or shorter.mean() >= MOST_WHOLE or (shorter > 1).mean() < 1.0 - MOSTLY:
        return False
    paces = np.diff(np.cumsum(gaps)[ends - 1]) / np.diff(ends)
    return len(paces) < 2 or bool(np.ptp(paces) > EVEN * np.median(paces))


def _pace(gaps, usual):
    """The usual interval, µs, by spans of intervals (n,) that most often hold no gap: after a
    late row a recorder may hurry for a while, which is not its pace. usual: bool (n,)."""
    wide = 1.0 - usual.mean()
    rows = PACE_ROWS if wide < 0.05 else 1
    times = np.concatenate([[0.0], np.cumsum(gaps)])
    spans = (times[rows:] - times[:-rows]) / rows
    if not len(spans):
        return float(gaps.mean())
    middle = float(np.median(spans))
    near = np.abs(spans - middle) <= (0.05 if rows > 1 else 0.5) * middle
    return float(spans[near].mean())


def renewed(t_us, period):
    """(n,) t_us with stamps that are one of a row before, as where a recorder did not renew it,
    where their rows were: those of FORGOTTEN rows at most between others that came on time. (Of
    rows that were handed over together the first comes late, and the next at once.) Where that is
    not the exception the stamps tell something else, and stay; one that equals the stamp before it
    is no other row's, and up to a quarter of the rows may have one."""
    beyond = (t_us - t_us[0]) - np.arange(len(t_us)) * period
    raised, steps = beyond.copy(), np.diff(beyond)
    near = ON_GRID * period
    on_time = np.append(False, np.abs(steps) < near)  # as much as the row before it
    for first in (np.flatnonzero(steps < -PART * period) + 1).tolist():
        if on_time[first - 1]:
            back = np.flatnonzero(np.abs(
                beyond[first + 1:first + FORGOTTEN + 1] - raised[first - 1]) < near)
            if len(back):
                end = first + 1 + int(back[0])
                raised[first:end], on_time[first:end + 1] = raised[first - 1], True
    others = (raised != beyond) & np.append(True, np.diff(t_us) != 0)
    rare = others.mean() < 1.0 - MOSTLY and (raised != beyond).mean() < ON_GRID
    return t_us + (raised - beyond) if rare else t_us


def backlog(t_us):
    """Rows at the start that a link or a buffer held when the recording began, and handed over as
    fast as it could; 0 where there are none. It is as fast as that later, too, where a row is late
    and those behind it catch up; without such rows the sensor may have been faster at first."""
    n = len(t_us)
    along = (t_us - t_us[0]) - np.arange(n) * (float(t_us[-1] - t_us[0]) / max(n - 1, 1))
    k = int(along.argmin())  # the bend from a quick pace to a slow one is furthest below the chord
    if k < REACH or n - 1 - k < k // 2 + REACH:
        return 0
    gaps = np.diff(t_us)
    quick, later = float(np.median(gaps[:k])), float(t_us[-1] - t_us[k]) / (n - 1 - k)
    middle = (k + n) // 2
    halves = (t_us[middle] - t_us[k]) / (middle - k), (t_us[-1] - t_us[middle]) / (n - 1 - middle)
    steady = abs(halves[1] - halves[0]) < EVEN * later
    hurried = quick < HURRIED * later and hurries(t_us, k, later)
    catches_up = (gaps[k:] <= AS_FAST * quick).mean() > CATCH_UP
    # Rows that share a stamp have the step of a coarse clock, which tells no pace.
    return k if quick and steady and hurried and catches_up else 0


def hurries(t_us, rows, period):
    """True where the first rows come as fast as a link's that were held, by the period of those
    behind them, µs."""
    return (t_us[rows] - t_us[0]) / rows < HURRIED * period


def resolution(t_us):
    """The step of the stamps, µs: what all their differences are multiples of."""
    return float(np.gcd.reduce(np.diff(t_us[:COUNTED]))) or 1.0


class Gaps:
    """Where the envelope of the stamps is lifted, and how far they are above it.

    places, lift    indices of intervals, µs beyond a period; known ones and those found
    late, bursts, latest, jitter    rows, groups, µs, µs
    """

    def __init__(self, t_us, period, width, resolution, known, least=None):
        """least: µs that a gap lifts them by, None: as much as a row has to be late."""
        reach = max(REACH, 2 * width)
        places, lifts = [], []
        self.late = self.bursts = 0
        self.latest, squares, number = 0.0, 0.0, 0
        limit = resolution if resolution > COARSE * period else PART * period
        least = limit if least is None else max(least, resolution)
        for first in range(0, len(t_us), COUNTED):
            some = t_us[first:first + COUNTED + reach + 1]
            beyond = (some - some[0]) - np.arange(len(some)) * period
            lowest = _lowest_ahead(beyond, reach)
            rows = min(COUNTED, len(some))
            jumps = np.diff(lowest)[:rows]
            here = known[(known >= first) & (known < first + len(jumps))] - first
            some = jumps[jumps != 0] if width > 1 else jumps
            spread = 1.4826 * float(np.median(np.abs(some))) if len(some) else 0.0
            lifted = np.flatnonzero(jumps > max(least, NOISE * spread))
            for place in np.union1d(lifted, here).astype(int).tolist():
                places.append(first + place)
                lifts.append(max(float(jumps[place]), 0.0))
            above = (beyond - lowest)[:rows]
            late = above > limit
            self.late += int(late.sum())
            self.bursts += int((np.diff(late.astype(np.int8), prepend=0) == 1).sum())
            self.latest = max(self.latest, float(above[late].max(initial=0)))
            rest = above[~late]
            if len(rest):
                squares += float(((rest - rest.mean()) ** 2).sum())
                number += len(rest)
        self.places, self.lift = np.array(places, int), np.array(lifts, float)
        self.jitter = math.sqrt(squares / max(number, 1))


def _lowest_ahead(values, reach):
    """The least of each value and those up to `reach` behind it."""
    least, span = values.astype(float), 1
    while span <= reach:        # spans of 2, 4, 8 … values; the last one overlaps
        step = min(span, reach + 1 - span)
        np.minimum(least[:-step], least[step:], out=least[:-step])
        span += step
    return least


def loss_nats(late, jitter):
    """Log likelihood ratio of gaps, late (n,) periods beyond one, if they are lost samples: a
    whole number each, as exactly as stamps tell that scatter by jitter periods; against a recorder
    that stands still, as often and as long, at any phase: a loop that does something else now and
    then."""
    nats = []
    for width in np.multiply(max(jitter, LATE), WIDER):
        nearest = math.erf(0.5 / (width * math.sqrt(2.0)))  # to which whole number it is
        for shorter in np.multiply(width, SHORTER):
            whole = late + shorter
            off = (whole - np.maximum(np.rint(whole), 1.0)) / width
            lost = np.exp(-0.5 * off ** 2) / (width * math.sqrt(2.0 * math.pi) * nearest)
            nats.append(float(np.log(STANDS + (1.0 - STANDS) * lost).sum()))
    return float(np.logaddexp.reduce(nats)) - math.log(len(nats))
