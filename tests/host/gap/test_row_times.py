"""Rows whose stamps are late: read in time and handed over late, or late themselves."""
from dataclasses import replace

import numpy as np
import pytest

from sixflip_host.capture import clock
from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.simulator import alignment, comparison, row_times, timing, traces
from tests.worlds.tumbled import META, RATE_HZ, read, tumbled


def late_by(n, seed=2):
    """(n,) s by which rows are late: of some, and those after them catch up."""
    rng, late = np.random.default_rng(seed), np.zeros(n)
    for row in rng.choice(np.arange(50, n - 50), n // 60, replace=False):
        behind = rng.uniform(0.012, 0.024)
        for k in range(4):
            late[row + k] = max(late[row + k], behind - 0.009 * k, 0.0)
    return late


def stamped(late, read_late):
    """(real, simulated) captures of one motion: of the real one rows are stamped late, and read
    at their stamps (read_late) or on an even clock."""
    t, force, rate = tumbled(1, 60.0)
    at = t + late
    if read_late:
        force, rate = (np.stack([np.interp(at, t, x) for x in values.T], 1)
                       for values in (force, rate))
    capture = read(t, force, rate, 1)
    real = Capture(dict(META), np.rint(1e6 * at).astype(np.int64), capture.accel, capture.gyro)
    return real, read(*tumbled(1, 60.0), 101)


@pytest.mark.parametrize("read_late", [False, True])
def test_the_readings_say_when_rows_were_read(read_late):
    late = late_by(int(60.0 * RATE_HZ))
    real, _ = stamped(late, read_late)
    t = traces.trace_from_capture("real", real).t
    off = t - np.arange(len(t)) / RATE_HZ - (late if read_late else 0.0)
    assert np.abs(off - np.median(off)).max() < 1e-3


@pytest.mark.parametrize("read_late", [False, True])
def test_late_stamps_are_nothing_that_a_simulator_lacks(read_late):
    """Both sensors of a healthy rover were something that no convention explains: a curve through
    rows that were caught up overshoots."""
    real, simulated = stamped(late_by(int(60.0 * RATE_HZ)), read_late)
    found = comparison.compare([("real", real)], "sim", simulated)
    assert found.conventions == () and not found.left and not found.shaken
    before, after, noise = found.gap["gyro"]
    assert after < 2.0 * noise


def test_rows_that_a_link_still_held_are_no_other_clock():
    """By the count of all rows a healthy log had 120 rows a second, and its clock was off by
    percents."""
    late = late_by(int(60.0 * RATE_HZ))
    held = np.arange(800)
    late[held] += 0.009 * (len(held) - held)
    real, simulated = stamped(late, False)
    trace = traces.trace_from_capture("real", real)
    assert trace.rate_hz == pytest.approx(RATE_HZ, rel=2e-4)
    off = trace.t - np.arange(len(late)) / RATE_HZ
    assert np.abs(off - np.median(off)).max() < 2e-3
    found = comparison.compare([("real", real)], "sim", simulated)
    assert abs(found.alignment.drift) < 2e-4 and found.conventions == () and not found.differs


def test_what_holds_rows_up_now_longer_and_now_shorter_is_no_other_clock():
    n, rng = int(60.0 * RATE_HZ), np.random.default_rng(6)
    stretches = np.repeat(rng.standard_normal(12) * 0.03, n // 12) / (n // 12)
    real, simulated = stamped(late_by(n) + np.cumsum(stretches), False)
    traced = [traces.trace_from_capture(*x) for x in (("real", real), ("sim", simulated))]
    told = timing.compared(None, None, {}, alignment.align(*traced))[-1]
    assert told.name == "clock" and not told.differs


def test_over_many_rows_the_stamps_are_the_clock():
    """The even clock of a rate that is known to a per cent was the time of all rows."""
    late = late_by(int(60.0 * RATE_HZ))
    real, _ = stamped(late, False)
    trace = traces.trace_from_capture("real", real)
    stamps = replace(trace, t=1e-6 * (real.t_us - real.t_us[0]))
    measured = clock.measure(real.t_us)
    again = row_times.as_read(stamps, replace(measured, rate_hz=1.002 * measured.rate_hz))
    off = again.t - np.arange(len(late)) / RATE_HZ
    assert again is not stamps and np.abs(off - np.median(off)).max() < 2e-3


def test_stamps_that_are_in_time_stay_as_they_are():
    real, _ = stamped(np.zeros(int(60.0 * RATE_HZ)), False)
    trace = traces.trace_from_capture("real", real)
    assert np.array_equal(trace.t, 1e-6 * (real.t_us - real.t_us[0]))


@pytest.mark.parametrize("pause_s", [3.0, 60.0])
def test_a_recorder_that_stood_still_makes_no_conventions(pause_s):
    """Gravity and forces had another sign: rows over all of the time are no rate, and a curve
    across what nobody read overshoots."""
    t, force, rate = tumbled(1, 60.0)
    later = np.rint(1e6 * (t + pause_s * (t > 20.1))).astype(np.int64)
    logs = [Capture(dict(META), later, made.accel, made.gyro) for made in (
        read(t, force, rate, seed) for seed in (1, 101))]
    found = comparison.compare([("real", logs[0])], "sim", logs[1])
    assert found.alignment.same and found.conventions == () and not found.differs
    assert found.gap["gyro"][1] < 2.0 * found.gap["gyro"][2]


@pytest.mark.parametrize("read_late", [False, True])
def test_rows_that_were_lost_beside_late_ones_keep_their_place(read_late):
    late = late_by(int(60.0 * RATE_HZ))
    real, _ = stamped(late, read_late)
    kept = np.setdiff1d(np.arange(len(late)), [*range(1000, 1004), *range(3500, 3502)])
    lacking = Capture(dict(META), real.t_us[kept], real.accel[kept], real.gyro[kept])
    trace = traces.trace_from_capture("real", lacking)
    assert len(trace.t) == len(late) and trace.put_in.sum() >= 6
    off = trace.t - np.arange(len(late)) / RATE_HZ - (late if read_late else 0.0)
    assert np.abs(off - np.median(off))[~trace.put_in].max() < 1e-3


def test_noise_alone_says_nothing_of_when_a_row_was_read():
    late = late_by(int(60.0 * RATE_HZ))
    t = np.arange(len(late)) / RATE_HZ
    made = read(t, np.zeros((len(t), 3)) + (0.0, 0.0, 1.0), np.zeros((len(t), 3)), 3)
    stamps = np.rint(1e6 * (t + late)).astype(np.int64)
    still = Capture(dict(META), stamps, made.accel, made.gyro)
    assert np.array_equal(traces.trace_from_capture("still", still).t, 1e-6 * (stamps - stamps[0]))


def test_a_curve_through_rows_that_lie_close_does_not_overshoot():
    t = np.arange(500) / 100.0
    t[100::50] -= 0.0098
    noise = np.random.default_rng(4).choice([-1.0, 1.0], (500, 1))
    even, curve = row_times.on_even_times(t, noise, 100.0)
    assert np.abs(curve).max() <= 1.0 and np.allclose(np.diff(even), 0.01)


def test_stamps_of_a_coarse_clock_say_nothing_of_single_rows():
    t, values = np.floor(np.arange(500) / 2.0) / 50.0, np.zeros((500, 3))
    assert row_times.on_even_times(t, values, 100.0) == (t, values)
