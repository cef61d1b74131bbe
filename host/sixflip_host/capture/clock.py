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
from .stamp_envelope import PAUSE_ROWS, PAUSE_S

# Of a period, by which a gap lifts the envelope at least where most intervals are whole periods:
# less than a row has to be late (stamp_envelope.PART), for the last stamp before a gap is a late
# one as often as an early one; and a loss that is not seen makes the period longer, which hides
# more of them.
LIFTED = 0.6
FEWEST_PHASES, FEWEST = 4, 2
BLOCKS = 10             # parts whose rates give the interval of the whole
ROUNDS = 4              # until the period is settled to a millionth
STAMP_STEP = "stamp_step_us"    # in a header: of stamps whose rows were spread
# 97.5 % quantiles: of the normal distribution, of Student's with 2 to 9 degrees of freedom
NORMAL_95, STUDENT_95 = 1.96, (4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)


@dataclass(frozen=True)
class SampleClock:
    """rows; rate_hz and interval_hz (95 %); losses and loss_gaps (samples, places), losses_known
    those of them that a link is known to have lost, loss_periods how long each other gap is,
    lost_after ((row, samples), ...) the last row before each and what it lacks;
    pauses, pause_s and longest_pause_s; late, bursts and longest_late_ms (rows, groups of them);
    jitter_ms; resolution_ms of the stamps; paces ((first row, Hz), ...) of parts that have a rate
    each, where it changed on the way; expected: rows and losses together."""

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
    paces: tuple = ()

    @property
    def expected(self):
        return self.rows + self.losses


def measure(t_us, recorder=(), lost=()):
    """SampleClock of int64 (n,) µs that do not decrease; None where they do not run.

    recorder    indices of the intervals that are known to be the recorder's pauses
    lost        indices of the intervals in which samples are known to be missing
    """
    n, stamps = len(t_us), t_us
    if n < FEWEST or t_us[-1] <= t_us[0]:
        return None
    known = np.union1d(np.asarray(recorder, int), np.asarray(lost, int))
    held = 0 if len(known) else stamp_envelope.backlog(t_us)
    if held:
        later = measure(t_us[held:])
        if later is None or stamp_envelope.hurries(t_us, held, 1e6 / later.rate_hz):
            return _after_a_backlog(later, held, t_us)
    period, width, each = stamp_envelope.first_guess(t_us, known)
    resolution = stamp_envelope.resolution(t_us)
    if width == 1 and resolution <= stamp_envelope.COARSE * period:
        stamps = stamp_envelope.renewed(t_us, period)
    least = LIFTED * period if each and resolution < LIFTED * period else None
    anew = False
    for _ in range(ROUNDS):
        gaps = stamp_envelope.Gaps(stamps, period, width, resolution, known, least)
        was = anew
        pause, missing, anew = _sorted_out(gaps, period, np.asarray(recorder, int),
                                           np.asarray(lost, int), anew)
        if anew and not was:  # it may have stood still for less than a sample, too
            least = stamp_envelope.NOISE * gaps.jitter
            continue
        running = float(stamps[-1] - stamps[0]) - gaps.lift[pause].sum()
        refined = running / (n - 1 + int(missing.sum()))
        if not refined > 0:
            return None
        close, period = abs(refined / period - 1) < 1e-6, refined
        if close:
            break
    is_known = np.isin(gaps.places, lost)
    measured = SampleClock(
        n, 1e6 / period, _interval(stamps, period, gaps, missing, pause),
        int(missing.sum()), int((missing > 0).sum()),
        float(gaps.lift[missing > 0].max(initial=0)) / 1e3,
        int(missing[is_known].sum()),
        tuple((gaps.lift[(missing > 0) & ~is_known] / period).tolist()),
        int(pause.sum()), float(gaps.lift[pause].sum()) / 1e6,
        float(gaps.lift[pause].max(initial=0)) / 1e6,
        gaps.late, gaps.bursts, gaps.latest / 1e3, gaps.jitter / 1e3, resolution / 1e3,
        tuple(zip(gaps.places[missing > 0].tolist(), missing[missing > 0].tolist())))
    # A recorder that was late catches up within REACH rows.
    if len(known) or pause.any() or measured.late <= stamp_envelope.REACH * measured.bursts:
        return measured
    return _with_paces(measured, t_us)


def _with_paces(measured, t_us):
    """The SampleClock of rows whose rate changed on the way, by those before and after the place
    that is furthest from one rate; as it was where they have one, or come as late with two."""
    beyond = (t_us - t_us[0]) - np.arange(len(t_us)) * (t_us[-1] - t_us[0]) / (len(t_us) - 1)
    k = int(np.abs(beyond).argmax())
    if min(k, len(t_us) - 1 - k) < stamp_envelope.REACH:
        return measured
    first, second = measure(t_us[:k + 1]), measure(t_us[k:])
    apart = max(first.interval_hz[0], second.interval_hz[0]) > min(
        first.interval_hz[1], second.interval_hz[1])
    late = first.late + second.late
    if not apart or late > measured.late / 2 or first.pauses or second.pauses:
        return measured
    paces = (first.paces or ((0, first.rate_hz),)) + tuple(
        (row + k, rate) for row, rate in second.paces or ((0, second.rate_hz),))
    return replace(
        measured, late=late, bursts=first.bursts + second.bursts, paces=paces,
        longest_late_ms=max(first.longest_late_ms, second.longest_late_ms),
        losses=first.losses + second.losses, loss_gaps=first.loss_gaps + second.loss_gaps,
        longest_loss_ms=max(first.longest_loss_ms, second.longest_loss_ms),
        loss_periods=first.loss_periods + second.loss_periods,
        jitter_ms=math.sqrt((first.rows * first.jitter_ms ** 2 + second.rows
                             * second.jitter_ms ** 2) / (first.rows + second.rows)),
        lost_after=first.lost_after + tuple((row + k, n) for row, n in second.lost_after))


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


def of_stamps(measured, step_us, part=0.0):
    """The SampleClock of rows spread between stamps so many µs apart, which resolve no more of
    when a row was read, nor the rate to less than such a part to either side."""
    (low, high), rate = measured.interval_hz, measured.rate_hz
    return replace(measured, resolution_ms=max(measured.resolution_ms, step_us / 1e3),
                   interval_hz=(min(low, rate * (1.0 - part)), max(high, rate * (1.0 + part))))


def sample_clock(capture):
    """The SampleClock of a Capture, or None. Where a board's own file says that it wrote to its
    flash, it read nothing meanwhile; that is no loss. Rows that were left out had their stamps,
    too: they are missing, and make none of the others late."""
    _, places = capture_binary.lost_on_the_way(capture)
    recorder = np.setdiff1d(capture_binary.write_pauses(capture), places)
    t_us, kept = getattr(capture, "recorded", None) or (capture.t_us, ())
    if len(kept) != len(capture.t_us):
        measured = measure(capture.t_us, recorder, places)
        return measured and of_stamps(measured, capture.meta.get(STAMP_STEP, 0.0))
    measured = measure(t_us, kept[recorder], kept[places])
    if measured is None:
        return None
    missing = np.zeros(len(t_us), int)      # between each row and the one before it
    for row, samples in measured.lost_after:
        missing[row + 1] = samples
    all_before = (np.arange(len(t_us)) + np.cumsum(missing))[kept]
    lacks = np.diff(all_before) - 1
    rows = np.flatnonzero(lacks)
    lost_after = tuple(zip(rows.tolist(), lacks[rows].tolist()))
    return of_stamps(replace(measured, lost_after=lost_after), capture.meta.get(STAMP_STEP, 0.0))


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
        anew = anew or stamp_envelope.loss_nats(
            gaps.lift[open_] / period, gaps.jitter / period) < 0.0
    if anew:                        # it stood still as well
        pause |= open_
    pause &= ~is_lost
    return pause, np.where(pause, 0, samples), anew


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
