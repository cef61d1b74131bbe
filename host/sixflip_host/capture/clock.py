"""The times of the samples: the rate by count over time; what arrived late, what was lost, when
the recorder stood still, and how much the stamps scatter.

Four things look alike in a list of intervals and are not:

late        a row was stamped late, and those after it caught up: nothing is lost. Links and
            operating systems hand samples over in bursts
jitter      the stamps scatter about an even clock
losses      the clock went on by whole periods without a row
pauses      the recorder did not record; what the sensor did meanwhile nobody knows

A stamp cannot be earlier than its sample, so the even clock is the lower envelope of the
stamps: what rises above it and comes back is late, what lifts it for good is a gap. Arrivals and
losses make up what an even clock expects over the time without pauses, always.
"""

import math
from dataclasses import dataclass

import numpy as np

from . import capture_binary
from .board_extras import EXTRAS

ON_GRID, MOSTLY = 0.25, 0.9     # intervals within a quarter of whole periods, and how many are
SPANS = tuple(2 ** k for k in range(1, 12))     # rows that a burst may have
PACE_ROWS = 8           # a span that tells the pace
REACH = 64              # rows in which a recorder that was late catches up
EVEN = 0.1              # scatter of spans, of their length, that are beyond the bursts
PART = 0.7              # of a period: less is no sample
MOST_WHOLE = 2.0        # periods a row on the mean: with more the usual interval is a burst's
COARSE = 1.5            # periods that a step of the stamps has where rows share a stamp
NOISE = 6.0             # times the envelope's own scatter: gaps below are none
PAUSE_S, PAUSE_ROWS = 1.0, 20   # a gap that is longer than both is a pause whatever its phase
IN_PHASE = 0.5          # mean cosine of the phases of gaps that are losses, 0 by chance
FEWEST_PHASES = 4
BLOCKS = 10             # parts whose rates give the interval of the whole
COUNTED = 1 << 16       # rows at a time
FEWEST = 2
# 97.5 % quantiles: of the normal distribution, of Student's with 2 to 9 degrees of freedom
NORMAL_95, STUDENT_95 = 1.96, (4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)


@dataclass(frozen=True)
class SampleClock:
    """rows; rate_hz and interval_hz (95 %); losses and loss_gaps (samples, places), losses_known
    those of them that a link is known to have lost, loss_periods how long each other gap is;
    pauses, pause_s and longest_pause_s; late, bursts and longest_late_ms (rows, groups of them);
    jitter_ms; resolution_ms of the stamps; expected: rows and losses together."""

    rows: int
    rate_hz: float
    interval_hz: tuple
    losses: int
    loss_gaps: int
    longest_loss_ms: float
    losses_known: int
    loss_periods: tuple
    pauses: int
    pause_s: float
    longest_pause_s: float
    late: int
    bursts: int
    longest_late_ms: float
    jitter_ms: float
    resolution_ms: float

    @property
    def expected(self):
        return self.rows + self.losses


def measure(t_us, recorder=(), lost=()):
    """SampleClock of int64 (n,) µs that do not decrease; None where they do not run.

    recorder    indices of the intervals that are known to be the recorder's pauses
    lost        indices of the intervals in which samples are known to be missing
    """
    n = len(t_us)
    if n < FEWEST or t_us[-1] <= t_us[0]:
        return None
    known = np.union1d(np.asarray(recorder, int), np.asarray(lost, int))
    period, width = _first_guess(t_us, known)
    resolution = _resolution(t_us)
    for _ in range(3):
        gaps = _Gaps(t_us, period, width, resolution, known)
        pause, missing = _sorted_out(gaps, period, np.asarray(recorder, int),
                                     np.asarray(lost, int))
        running = float(t_us[-1] - t_us[0]) - gaps.lift[pause].sum()
        again = running / (n - 1 + int(missing.sum()))
        if not again > 0:
            return None
        close, period = abs(again / period - 1) < 1e-6, again
        if close:
            break
    is_known = np.isin(gaps.places, lost)
    return SampleClock(
        n, 1e6 / period, _interval(t_us, period, gaps, missing, pause),
        int(missing.sum()), int((missing > 0).sum()),
        float(gaps.lift[missing > 0].max(initial=0)) / 1e3,
        int(missing[is_known].sum()),
        tuple((gaps.lift[(missing > 0) & ~is_known] / period).tolist()),
        int(pause.sum()), float(gaps.lift[pause].sum()) / 1e6,
        float(gaps.lift[pause].max(initial=0)) / 1e6,
        gaps.late, gaps.bursts, gaps.latest / 1e3, gaps.jitter / 1e3, resolution / 1e3)


def of(capture):
    """The SampleClock of a Capture. Where a board's own file says that it wrote to its flash, it
    read nothing meanwhile; that is no loss."""
    _, places = capture_binary.lost_on_the_way(capture)
    recorder = np.setdiff1d(capture_binary.write_pauses(capture), places)
    return measure(capture.t_us, recorder, places)


def of_a_board(capture):
    """True for a capture that a board of ours recorded."""
    return EXTRAS in capture.meta


def is_measured(meta):
    """True where the rate of a capture's header was measured from its own times, so that
    nothing can be held against it."""
    return meta.get("rate", "stated" if "imported_from" not in meta else "measured") == "measured"


def header(measured):
    """The keys of a capture's header that a measured rate has."""
    low, high = measured.interval_hz
    digits = 3 - min(0, math.floor(math.log10(max(high - low, 1e-9))))
    return {"rate_hz": round(measured.rate_hz, min(digits, 9)), "rate": "measured",
            "rate_interval_hz": [round(low, min(digits, 9)), round(high, min(digits, 9))]}


def as_json(measured):
    """The SampleClock for --json."""
    return {"rows": measured.rows, "expected": measured.expected, "rate_hz": measured.rate_hz,
            "interval_95_hz": list(measured.interval_hz),
            "losses": {"samples": measured.losses, "places": measured.loss_gaps,
                       "longest_ms": measured.longest_loss_ms,
                       "by_the_link": measured.losses_known},
            "pauses": {"number": measured.pauses, "seconds": measured.pause_s,
                       "longest_s": measured.longest_pause_s},
            "late": {"rows": measured.late, "bursts": measured.bursts,
                     "longest_ms": measured.longest_late_ms},
            "jitter_ms": measured.jitter_ms, "resolution_ms": measured.resolution_ms}


def words(measured):
    """Sentences: the rate first, then what there is of the other four."""
    lines = ["%.6g Hz (%.6g to %.6g) by count over time: %d rows and %d lost are the %d expected"
             % (measured.rate_hz, *measured.interval_hz, measured.rows, measured.losses,
                measured.expected)]
    return lines + [line for line in (loss_words(measured), pause_words(measured),
                                      burst_words(measured), jitter_words(measured)) if line]


def loss_words(measured):
    """A sentence on losses, or ""."""
    if not measured.losses:
        return ""
    return "losses: %s missing in %s under a clock that went on, %.4g ms at most" % (
        _number(measured.losses, "sample"), _number(measured.loss_gaps, "place"),
        measured.longest_loss_ms)


def pause_words(measured):
    """A sentence on pauses, or ""."""
    if not measured.pauses:
        return ""
    return ("pauses: the recorder stood still %s, %.3g s together, %.3g s at most; nothing is "
            "taken as lost there" % (_number(measured.pauses, "time"), measured.pause_s,
                                     measured.longest_pause_s))


def burst_words(measured):
    """A sentence on rows that came late, or ""."""
    if not measured.late:
        return ""
    return "bursts: %s came late and %s caught up, in %s, %.3g ms at most; none is lost" % (
        _number(measured.late, "row"), "was" if measured.late == 1 else "were",
        _number(measured.bursts, "burst"), measured.longest_late_ms)


def jitter_words(measured):
    """A sentence on jitter of more than a hundredth of a period, or ""."""
    if measured.jitter_ms * measured.rate_hz <= 10:
        return ""
    return "jitter: the stamps scatter by %.3g ms" % measured.jitter_ms


def _number(number, what):
    return "%d %s%s" % (number, what, "" if number == 1 else "s")


def _first_guess(t_us, known):
    """(period in µs, rows that a burst has at most)."""
    gaps = np.diff(t_us[:COUNTED + 1]).astype(float)
    gaps = np.delete(gaps, known[known < len(gaps)])
    if not len(gaps):
        gaps = np.diff(t_us).astype(float)
    usual = float(np.median(gaps))
    if usual > 0:
        whole = np.rint(gaps / usual)
        near = (whole >= 1) & (np.abs(gaps / usual - whole) < ON_GRID)
        if near.mean() >= MOSTLY and whole.mean() < MOST_WHOLE:
            return _pace(gaps, whole == 1), 1
    times = np.concatenate([[0.0], np.cumsum(gaps)])
    for rows in SPANS:
        if rows * 4 > len(times):
            break
        spans = times[rows:] - times[:-rows]
        middle = float(np.median(spans))
        if middle > 0 and 1.4826 * np.median(np.abs(spans - middle)) < EVEN * middle:
            return middle / rows, rows
    return float(t_us[-1] - t_us[0]) / (len(t_us) - 1), max(1, len(t_us) // 8)


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


def _resolution(t_us):
    """The step of the stamps, µs: what all their differences are multiples of."""
    return float(np.gcd.reduce(np.diff(t_us[:COUNTED]))) or 1.0


class _Gaps:
    """Where the envelope of the stamps is lifted, and how far they are above it.

    places, lift    indices of intervals, µs beyond a period; known ones and those found
    late, bursts, latest, jitter    rows, groups, µs, µs
    """

    def __init__(self, t_us, period, width, resolution, known):
        reach = max(REACH, 2 * width)
        places, lifts = [], []
        self.late = self.bursts = 0
        self.latest, squares, number = 0.0, 0.0, 0
        limit = resolution if resolution > COARSE * period else PART * period
        for first in range(0, len(t_us), COUNTED):
            some = t_us[first:first + COUNTED + reach + 1]
            beyond = (some - some[0]) - np.arange(len(some)) * period
            lowest = _lowest_ahead(beyond, reach)
            rows = min(COUNTED, len(some))
            jumps = np.diff(lowest)[:rows]
            here = known[(known >= first) & (known < first + len(jumps))] - first
            some = jumps[jumps != 0] if width > 1 else jumps
            spread = 1.4826 * float(np.median(np.abs(some))) if len(some) else 0.0
            lifted = np.flatnonzero(jumps > max(limit, NOISE * spread))
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


def _sorted_out(gaps, period, recorder, lost):
    """(bool: pauses, int: samples missing) of every gap."""
    samples = np.rint(gaps.lift / period).astype(int)
    pause = (gaps.lift > PAUSE_S * 1e6) & (gaps.lift > PAUSE_ROWS * period)
    pause |= np.isin(gaps.places, recorder)
    is_lost = np.isin(gaps.places, lost)
    open_ = ~pause & ~is_lost
    if gaps.jitter < 0.1 * period and open_.sum() >= FEWEST_PHASES:
        phase = np.cos(2 * np.pi * gaps.lift[open_] / period).mean()
        if phase < IN_PHASE:        # the clock began anew each time: it stood still as well
            pause |= open_
    pause &= ~is_lost
    return pause, np.where(pause, 0, samples)


def _interval(t_us, period, gaps, missing, pause):
    """(low, high) of the rate by the rates of parts of the recording."""
    n = len(t_us)
    number = min(BLOCKS, n // 20)
    edges = np.linspace(0, n - 1, max(number, 1) + 1).astype(int)
    off = np.concatenate([[0.0], np.cumsum(np.where(pause, gaps.lift, missing * period))])
    before = np.searchsorted(gaps.places, edges)        # gaps that lie before each edge
    running = np.diff((t_us[edges] - t_us[0]) - off[before])
    parts = running / np.diff(edges)
    ends = math.sqrt(2.0) * (gaps.jitter + 0.5) / (n - 1)       # µs of the period
    error = ends * NORMAL_95
    if number >= 3:
        error = max(error, float(parts.std(ddof=1)) / math.sqrt(number)
                    * STUDENT_95[number - 3])
    return 1e6 / (period + error), 1e6 / max(period - error, 1e-3)
