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
from dataclasses import dataclass

import numpy as np

from . import capture_binary, stamp_envelope
from .board_extras import EXTRAS

PAUSE_S, PAUSE_ROWS = 1.0, 10   # a gap that is longer than both is a pause whatever its phase
# Of the mean cosine that the phases of losses have as the stamps scatter; by chance it is 0.
IN_PHASE = 0.5
FEWEST_PHASES = 4
BLOCKS = 10             # parts whose rates give the interval of the whole
FEWEST = 2
ROUNDS = 4              # until the period is settled to a millionth
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
    period, width = stamp_envelope.first_guess(t_us, known)
    resolution = stamp_envelope.resolution(t_us)
    if width == 1 and resolution <= stamp_envelope.COARSE * period:
        t_us = stamp_envelope.renewed(t_us, period)
    least = None
    for _ in range(ROUNDS):
        gaps = stamp_envelope.Gaps(t_us, period, width, resolution, known, least)
        pause, missing, anew = _sorted_out(gaps, period, np.asarray(recorder, int),
                                           np.asarray(lost, int), least is not None)
        if anew and least is None:  # it may have stood still for less than a sample, too
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
        gaps.late, gaps.bursts, gaps.latest / 1e3, gaps.jitter / 1e3, resolution / 1e3)


def sample_clock(capture):
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


def _sorted_out(gaps, period, recorder, lost, anew=False):
    """(bool: pauses, int: samples missing) of every gap, and whether the clock began anew after
    each of them, which is known already where `anew`."""
    samples = np.rint(gaps.lift / period).astype(int)
    pause = (gaps.lift > PAUSE_S * 1e6) & (gaps.lift > PAUSE_ROWS * period)
    pause |= np.isin(gaps.places, recorder)
    is_lost = np.isin(gaps.places, lost)
    open_ = ~pause & ~is_lost
    turn = 2 * np.pi / period
    coherent = math.exp(-0.5 * (turn * gaps.jitter) ** 2)  # the mean cosine of losses
    if open_.sum() * coherent ** 2 >= FEWEST_PHASES:
        anew = anew or np.cos(turn * gaps.lift[open_]).mean() < IN_PHASE * coherent
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
