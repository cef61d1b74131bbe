"""When the rows of a log were read, and those that nobody read: what is smoothed, turned and put
on another log's times from row to row needs even rows, at the times that they belong to."""
import copy
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.ndimage import median_filter, uniform_filter1d

from ...capture import clock, stamp_envelope

PUT_IN_S = 0.15  # of lost rows in one place: a period of the band that is compared
# Of a period, by which a stamp is late that matters; rows that are, before it is asked what their
# readings say of it; times as much as by the stamps, that these bend between the rows beside them
# where they were read in time: noise alone bends as much by both.
LATE, FEWEST, LESS = 0.3, 8, 0.8
WIDE = 2 * stamp_envelope.REACH + 1  # rows, of which those of one late row are less than half
# Of a row, that a run of lost ones is no whole number of them in what is fitted, standard
# deviation; share of the runs that something else spoils, as another one within a second.
WHOLE, SPOILT = 0.05, 0.1
APART = 3.0  # nats by which it is one of two, lost rows or a clock that was set [GAP stage 4]
SOME = 0.25  # of the intervals, at most, where stamps are told from a clock that is coarse


def as_read(trace, measured):
    """The Trace with the times at which its rows were read, by its SampleClock: a row that was
    handed over late was read in time, or was itself late. Its readings, between those beside it,
    say which. Even is the clock from row to row; over more of them it goes with the stamps."""
    if measured is None or measured.pauses or not measured.late:
        return trace
    period = 1.0 / measured.rate_hz
    even = _along(trace.t, period * (
        np.arange(len(trace.t)) + np.cumsum(_missing(len(trace.t), measured))))
    late = np.abs(trace.t - even) > LATE * period
    late[:-1] |= late[1:]
    late[1:] |= late[:-1]
    rows = 1 + np.flatnonzero(late[1:-1])
    if len(rows) < FEWEST:
        return trace
    bends = [sum(_bend(t, values, rows) for values in (trace.force, trace.rate)
                 if values is not None) for t in (trace.t, even)]
    return replace(trace, t=even - even[0]) if bends[1] < LESS * bends[0] else trace


def pace_sigma(measured):
    """Relative standard error of the pace of stamps some of which are late, by their SampleClock:
    what holds up rows holds them up for longer, too, and the pace of stretches then differs."""
    if measured is None or not measured.late:
        return 0.0
    low, high = measured.interval_hz
    return float((high - low) / (2.0 * clock.NORMAL_95 * measured.rate_hz))


def _along(t, even):
    """(n,) times of an even clock that follows the stamps t (n,) over more rows than a late one
    holds up: single rows that were lost among late ones, and a rate that is not known well, are
    in them. Rows that a link still held at the start have no times of their own."""
    held = stamp_envelope.backlog(1e6 * t)
    slow = median_filter((t - even)[held:], WIDE, mode="nearest")
    slow = uniform_filter1d(slow, WIDE, mode="nearest")
    return even + np.concatenate([np.full(held, slow[0]), slow])


def _missing(n, measured):
    """(n,) int: rows that were lost just before each."""
    missing = np.zeros(n, int)
    for row, samples in measured.lost_after:
        missing[row + 1] = samples
    return missing


def _bend(t, values, rows):
    """How far readings (n, 3) at rows are from a straight line between those beside them, squares
    together in units of what noise alone is, of each channel beside how far all of them are from
    the mean of the two."""
    before, after = t[rows - 1], t[rows + 1]
    share = np.clip((t[rows] - before) / np.maximum(after - before, 1e-9), 0.0, 1.0)[:, None]
    off = values[rows] - (1.0 - share) * values[rows - 1] - share * values[rows + 1]
    off2 = off ** 2 / (1.0 + share ** 2 + (1.0 - share) ** 2)
    usual = values[1:-1] - 0.5 * (values[:-2] + values[2:])
    return float((off2 / np.maximum((usual ** 2).mean(axis=0), 1e-30)).sum())


def evened(trace, measured):
    """The Trace with the rows that its SampleClock says were lost put in, on a cubic through the
    others (a straight line would cut the peaks off): what is smoothed and turned from row to row
    needs even ones. Not in its rests, whose readings are those that were read; and where more are
    lost than a curve can be drawn through, the rows beside them are known instead."""
    if measured is None or not measured.lost_after:
        return trace
    missing, beside, resting = (np.zeros(len(trace.t), kind) for kind in (int, bool, bool))
    for first, end in trace.rests:
        resting[first:end] = True
    for row, samples in measured.lost_after:
        if samples > PUT_IN_S * measured.rate_hz:
            beside[row:row + 2] = True
        elif not resting[row:row + 2].all():
            missing[row + 1] = samples
    at = np.arange(len(trace.t)) + np.cumsum(missing)
    every = np.arange(at[-1] + 1)

    def between(values, quantum):
        if values is None:
            return None
        course = np.rint(CubicSpline(at, values, axis=0)(every) / quantum) * quantum
        course[at] = values
        return course

    put_in, railed = ~np.isin(every, at), np.zeros(len(every), bool)
    put_in[at], railed[at] = beside, trace.railed
    return replace(
        trace, t=np.interp(every, at, trace.t), force=between(trace.force, trace.quantum[0]),
        rate=between(trace.rate, trace.quantum[1]),
        celsius=None if trace.celsius is None else np.interp(every, at, trace.celsius),
        rate_hz=measured.rate_hz, railed=railed, put_in=put_in,
        **{name: tuple((int(at[a]), int(at[b - 1]) + 1) for a, b in getattr(trace, name))
           for name in ("rests", "calm")})


def on_even_times(t, values, rate_hz):
    """(t, values (n, k)) on an even clock, where rows were read far from one: what is smoothed
    from row to row takes them for even. By a curve that does not overshoot where two lie close;
    where most stamps are coarse they say nothing of single rows."""
    off = np.abs(np.diff(t) * rate_hz - 1.0) > LATE
    if not off.any() or off.mean() > SOME:
        return t, values
    even = t[0] + np.arange(int((t[-1] - t[0]) * rate_hz + 0.5) + 1) / rate_hz
    even[-1] = min(even[-1], t[-1])
    return even, PchipInterpolator(*increasing(t, values))(even)


def increasing(t, values):
    """(t, values) without rows whose time does not grow."""
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(t)) > 0])
    return t[keep], values[keep]


def gap_near(t, span, size, off):
    """The first of stamps t (n,) s after a gap that is longer than a period by size, to so much
    off, where it is the longest in a span of times; or None."""
    first, end = np.searchsorted(t, span)
    first = max(first - 1, 0)
    apart = np.diff(t[first:end + 1])
    if not len(apart):
        return None
    longest = int(apart.argmax())
    fits = abs(apart[longest] - np.median(np.diff(t)) - size) < off
    return float(t[first + longest + 1]) if fits else None


def whole_nats(rate_hz, runs):
    """Nats by which runs [(s, size in s, its standard error)] of a log are whole numbers of rows,
    as lost ones are, over sizes of any kind."""
    rows, sigma = rate_hz * np.array(runs)[:, 1:].T
    width = np.hypot(sigma, WHOLE)
    near = np.exp(-0.5 * ((rows - np.rint(rows)) / width) ** 2) / (width * np.sqrt(2.0 * np.pi))
    return float(np.log(SPOILT + (1.0 - SPOILT) * np.where(width < LATE, near, 1.0)).sum())


def whole_runs(rate_hz, runs):
    """[(from s on, by s)] of such runs, in whole rows where they may be lost ones."""
    sizes = np.array([rate_hz * size for _, size, _ in runs])
    if whole_nats(rate_hz, runs) > -APART:
        sizes = np.maximum(np.rint(sizes), 1.0)
    return [(run[0], size / rate_hz) for run, size in zip(runs, sizes)]


def with_times(capture, later):
    """The Capture with stamps later by so many s as a function says of times (n,) s from its first
    row on."""
    def right(t_us):
        moved = np.rint(1e6 * later(1e-6 * (t_us - capture.t_us[0]))).astype(t_us.dtype)
        return np.maximum.accumulate(t_us + moved)
    if not np.any(right(capture.t_us) != capture.t_us):
        return capture
    put = copy.copy(capture)
    put.t_us = right(capture.t_us)
    if put.recorded is not None:
        put.recorded = right(put.recorded[0]), put.recorded[1]
    return put
