"""The times of the samples: the rate by count over time; what arrived late, what was lost, when
the recorder stood still, and how much the stamps scatter.

Four things look alike in a list of intervals and are not:

late        a row was stamped late, and those after it caught up: nothing is lost. Links and
            operating systems hand samples over in bursts
jitter      the stamps scatter about an even clock
losses      the clock went on by whole periods without a row
pauses      the recorder did not record; what the sensor did meanwhile nobody knows

They are told by the lower envelope of the stamps (stamp_envelope.py). Arrivals and losses make up
what an even clock expects over the time without pauses, always.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from . import capture_binary, stamp_envelope
from .board_extras import EXTRAS

# Of a period, by which a gap lifts the envelope at least where most intervals are whole periods:
# less than a row has to be late (stamp_envelope.PART), for the last stamp before a gap is a late
# one as often as an early one; and a loss that is not seen makes the period longer, which hides
# more of them.
LIFTED = 0.6
PAUSE_S, PAUSE_ROWS = 1.0, 10   # a gap that is longer than both is a pause whatever its phase
FEWEST_PHASES = 4
STANDS = 0.1  # of the gaps of a recorder that loses samples, at most, in which it stood still
LATE = 0.001  # periods, at least: how exactly a stamp tells the time of a sample, 10 us at 100 Hz
# Times as exactly, tried: stamps have other tails than normal ones. By up to three of them a gap
# is shorter: it begins with a row as late as any, while the clock goes by the earliest ones.
WIDER, SHORTER = (1.0, 4.0, 16.0), (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
BLOCKS = 10             # parts whose rates give the interval of the whole
FEWEST = 2
ROUNDS = 4              # until the period is settled to a millionth
# 97.5 % quantiles: of the normal distribution, of Student's with 2 to 9 degrees of freedom
NORMAL_95, STUDENT_95 = 1.96, (4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)


@dataclass(frozen=True)
class SampleClock:
    """rows; rate_hz and interval_hz (95 %); losses and loss_gaps (samples, places), losses_known
    those of them that a link is known to have lost, loss_periods how long each other gap is,
    lost_after ((row, samples), ...) the last row before each and what it lacks;
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
    lost_after: tuple = ()

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
    held = 0 if len(known) else stamp_envelope.backlog(t_us)
    if held:
        return _after_a_backlog(measure(t_us[held:]), held, t_us)
    period, width, each = stamp_envelope.first_guess(t_us, known)
    resolution = stamp_envelope.resolution(t_us)
    if width == 1 and resolution <= stamp_envelope.COARSE * period:
        t_us = stamp_envelope.renewed(t_us, period)
    least = LIFTED * period if each and resolution < LIFTED * period else None
    anew = False
    for _ in range(ROUNDS):
        gaps = stamp_envelope.Gaps(t_us, period, width, resolution, known, least)
        was = anew
        pause, missing, anew = _sorted_out(gaps, period, np.asarray(recorder, int),
                                           np.asarray(lost, int), anew)
        if anew and not was:  # it may have stood still for less than a sample, too
            least = stamp_envelope.NOISE * gaps.jitter
            continue
        running = float(t_us[-1] - t_us[0]) - gaps.lift[pause].sum()
        refined = running / (n - 1 + int(missing.sum()))
        if not refined > 0:
            return None
        close, period = abs(refined / period - 1) < 1e-6, refined
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
        gaps.late, gaps.bursts, gaps.latest / 1e3, gaps.jitter / 1e3, resolution / 1e3,
        tuple(zip(gaps.places[missing > 0].tolist(), missing[missing > 0].tolist())))


def _after_a_backlog(measured, held, t_us):
    """The SampleClock of all rows, by that of those after the first `held`, which had been read
    before they were handed over."""
    if measured is None:
        return None
    late_ms = held * 1e3 / measured.rate_hz - float(t_us[held] - t_us[0]) / 1e3
    return replace(measured, rows=measured.rows + held, late=measured.late + held,
                   bursts=measured.bursts + 1,
                   longest_late_ms=max(measured.longest_late_ms, late_ms),
                   lost_after=tuple((row + held, k) for row, k in measured.lost_after))


def within(measured, part):
    """The SampleClock with an interval of the rate that is at least such a part of it to either
    side: for times that say less than they look like."""
    low, high = measured.interval_hz
    return replace(measured, interval_hz=(min(low, measured.rate_hz * (1.0 - part)),
                                          max(high, measured.rate_hz * (1.0 + part))))


def sample_clock(capture):
    """The SampleClock of a Capture. Where a board's own file says that it wrote to its flash, it
    read nothing meanwhile; that is no loss. Rows that were left out had their stamps, too: they
    are missing, and make none of the others late."""
    _, places = capture_binary.lost_on_the_way(capture)
    recorder = np.setdiff1d(capture_binary.write_pauses(capture), places)
    recorded = getattr(capture, "recorded", None)
    if recorded is None or len(recorded[1]) != len(capture.t_us):
        return measure(capture.t_us, recorder, places)
    t_us, kept = recorded
    measured = measure(t_us, kept[recorder], kept[places])
    if measured is None:
        return None
    missing = np.zeros(len(t_us), int)      # between each row and the one before it
    for row, samples in measured.lost_after:
        missing[row + 1] = samples
    all_before = (np.arange(len(t_us)) + np.cumsum(missing))[kept]
    lacks = np.diff(all_before) - 1
    rows = np.flatnonzero(lacks)
    return replace(measured, lost_after=tuple(zip(rows.tolist(), lacks[rows].tolist())))


def recorded_without(capture, rows):
    """What Capture.recorded is without some of its rows (k,)."""
    t_us, kept = getattr(capture, "recorded", None) or (
        capture.t_us, np.arange(len(capture.t_us)))
    return t_us, np.delete(kept, rows)


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


def _sorted_out(gaps, period, recorder, lost, anew=False):
    """(bool: pauses, int: samples missing) of every gap, and whether the clock began anew after
    each of them, which is known already where `anew`."""
    samples = np.rint(gaps.lift / period).astype(int)
    pause = (gaps.lift > PAUSE_S * 1e6) & (gaps.lift > PAUSE_ROWS * period)
    pause |= np.isin(gaps.places, recorder)
    is_lost = np.isin(gaps.places, lost)
    open_ = ~pause & ~is_lost
    if open_.sum() >= FEWEST_PHASES:
        anew = anew or loss_nats(gaps.lift[open_] / period, gaps.jitter / period) < 0.0
    if anew:                        # it stood still as well
        pause |= open_
    pause &= ~is_lost
    return pause, np.where(pause, 0, samples), anew


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
