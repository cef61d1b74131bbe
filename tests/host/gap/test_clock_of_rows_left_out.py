"""The clock of a log whose rows were left out, as of samples that were not read, is that of all
rows that were recorded: they had their stamps, and make none of the others late."""

import copy

import numpy as np
import pytest

from sixflip_host.capture import clock
from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.detect import held_values


def log(rows=12000, seed=2):
    """A log of 1000 Hz whose stamps scatter by a sixth of a period, of noise."""
    rng = np.random.default_rng(seed)
    t_us = np.maximum.accumulate(np.rint(1000 * np.arange(rows) + rng.uniform(
        0, 500, rows)).astype(np.int64))
    meta = {"sensor": "other", "rate_hz": 1000.0, "accel_lsb_per_g": 1365.0,
            "gyro_lsb_per_dps": 65.5}
    return Capture(meta, t_us, *(rng.normal(0, 30, (rows, 3)).astype(np.int16) for _ in "ag"))


def test_rows_that_were_not_read_make_no_others_late():
    capture = log()
    whole = clock.sample_clock(capture)
    out = np.flatnonzero(np.random.default_rng(3).random(12000) < 0.08)
    out = out[(out > 0) & (out < 11999)]
    for name in ("accel", "gyro"):
        for row in out:
            getattr(capture, name)[row] = getattr(capture, name)[row - 1]
    (_, shorter), = held_values.as_read([("a.csv", capture)])[0]
    assert len(capture) - len(shorter) == pytest.approx(len(out), abs=3)
    measured = clock.sample_clock(shorter)
    assert measured.late == whole.late and measured.jitter_ms == whole.jitter_ms
    assert measured.rate_hz == whole.rate_hz
    # what is put in between the rows that are left are the rows that were left out
    gone = sorted(set(capture.t_us) - set(shorter.t_us))
    lost = [(capture.t_us > shorter.t_us[row]) & (capture.t_us < shorter.t_us[row + 1])
            for row, _ in measured.lost_after]
    assert sum(some.sum() for some in lost) == len(gone)
    assert [some.sum() for some in lost] == [samples for _, samples in measured.lost_after]


def test_what_was_lost_besides_is_missing_as_well():
    capture = log()
    lost = np.arange(6000, 6005)
    for name in ("t_us", "accel", "gyro"):
        setattr(capture, name, np.delete(getattr(capture, name), lost, axis=0))
    shorter = held_values.without_rows(capture, np.array([100, 101, 6002]))
    again = held_values.without_rows(shorter, np.array([5000]))
    assert clock.sample_clock(again).lost_after == ((99, 2), (4999, 1), (5996, 5), (5998, 1))
    assert clock.sample_clock(again).losses == 5


def test_another_times_are_another_clock():
    shorter = copy.copy(held_values.without_rows(log(), np.array([100])))
    shorter.t_us = shorter.t_us[:6000]
    assert clock.sample_clock(shorter).rows == 6000
