"""Two logs of one motion of which the times of one jump or wander against the other's."""
import numpy as np
import pytest
from scipy import ndimage

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import alignment, clock_course, lag_path, traces
from tests.worlds import guided
from tests.worlds.tumbled import META, RATE_HZ, read, tumbled

SECONDS = 90.0
RUNS = (9, 14, 22, 17)  # rows that are lost at once


def without(capture, runs, steady=True):
    """A Capture that lost runs of rows, its stamps made by counting those left."""
    keep = np.ones(len(capture), bool)
    for k, rows in enumerate(runs):
        first = int((k + 1.3) * len(capture) / (len(runs) + 2))
        keep[first:first + rows] = False
    t_us = capture.t_us[:keep.sum()] if steady else capture.t_us[keep]
    return Capture(dict(META), t_us, capture.accel[keep], capture.gyro[keep])


def stamped(capture, t):
    """The Capture with other stamps, s."""
    return Capture(dict(META), np.rint(1e6 * (t - t[0])).astype(np.int64), capture.accel,
                   capture.gyro)


def pair(seed=1):
    motion = tumbled(seed, SECONDS)
    return read(*motion, seed), read(*motion, seed + 100)


def put_right(real, simulated):
    """clock_course.PutRight of two Captures, or None where their times go alike."""
    logs = traced(real, simulated)
    course = clock_course.found(*logs, alignment.align(*logs))
    return course and clock_course.put_right(course, *logs, (real, simulated))


def traced(real, simulated):
    return traces.trace_from_capture("real", real), traces.trace_from_capture("sim", simulated)


def told(right):
    """{name: difference} of the numbers that differ."""
    return {p.name: p.difference for p in right.parameters}


def alike(right):
    """Whether the times that were put right go with those of a whole log."""
    found = alignment.align(*traced(right.real, right.sim))
    return found.correlation > 0.99999 and abs(found.drift) < 1e-5


@pytest.mark.parametrize("of_real", [True, False])
def test_rows_that_are_missing_under_steady_stamps_are_counted(of_real):
    """A clock that is off, shaking, a saturated axis and another motion were named instead."""
    real, simulated = pair()
    right = put_right(without(real, RUNS), simulated) if of_real else put_right(
        real, without(simulated, RUNS))
    assert told(right) == {"lost_rows": sum(RUNS) * (1 if of_real else -1)} and alike(right)


def test_one_run_is_lost_rows_or_a_clock_that_was_set():
    real, simulated = pair(2)
    right = put_right(without(real, (12,)), simulated)
    assert set(told(right)) == {"clock_jump"} and alike(right)
    assert told(right)["clock_jump"] == pytest.approx(-120.0, abs=1.0)
    assert "12 rows are missing" in right.remarks[0] and "was set back" in right.remarks[0]


def test_a_clock_that_is_set_shows_in_its_stamps():
    real, simulated = pair(3)
    t = 1e-6 * real.t_us
    right = put_right(stamped(real, t + 0.9 * (t > 41.3)), simulated)
    assert set(told(right)) == {"clock_jump"} and alike(right)
    assert told(right)["clock_jump"] == pytest.approx(900.0, abs=1.0)


def test_a_clock_that_wanders_is_told_by_how_much():
    real, simulated = pair(4)
    t = 1e-6 * real.t_us
    off = 0.012 * np.sin(2.0 * np.pi * t / 41.0) + 0.006 * np.sin(2.0 * np.pi * t / 23.0 + 1.0)
    right = put_right(stamped(real, t + off), simulated)
    off = off - np.polyval(np.polyfit(t, off, 1), t)
    assert told(right) == {"clock_wander": pytest.approx(1e3 * off.std(), rel=0.2)}
    left = 1e-6 * right.real.t_us - t
    left -= np.polyval(np.polyfit(t, left, 1), t)
    assert left.std() < 0.1 * off.std()


@pytest.mark.parametrize("pace", [1.0, 1.01, 1.05])
def test_a_clock_of_another_pace_neither_jumps_nor_wanders(pace):
    real, simulated = pair(5)
    assert put_right(stamped(real, pace * 1e-6 * real.t_us), simulated) is None


def test_a_log_that_is_late_and_smooth_neither_jumps_nor_wanders():
    real, simulated = pair(6)
    late = [np.rint(ndimage.shift(ndimage.gaussian_filter1d(x.astype(float), 1.5, axis=0), (
        2.5, 0), order=1, mode="nearest")).astype(np.int16) for x in (real.accel, real.gyro)]
    assert put_right(Capture(dict(META), real.t_us, *late), simulated) is None


def test_another_run_of_the_same_kind_is_no_jump():
    assert put_right(pair(7)[0], pair(8)[1]) is None


def test_rows_that_are_missing_by_their_stamps_move_no_clock():
    """Straight lines over what is missing pulled the offset by a third of a millisecond."""
    real, simulated = traced(*pair(9))
    lost, _ = traced(without(pair(9)[0], RUNS * 3, steady=False), pair(9)[1])
    whole, found = (alignment.align(log, simulated) for log in (real, lost))
    assert found.correlation > 1.0 - 3.0 * (1.0 - whole.correlation)
    assert abs(found.offset_s - whole.offset_s) < 5e-5


@pytest.mark.long
def test_what_a_lossy_log_lacks_is_a_cause_with_its_share():
    real, simulated = pair(10)
    found = diagnose([("real", without(real, RUNS))], [("sim", simulated)])
    assert [f.effect for f in found.findings] == ["dropped_samples"]
    assert found.findings[0].value["chance"] == pytest.approx(
        100.0 * sum(RUNS) / (SECONDS * RATE_HZ), rel=0.05)
    assert found.verdict == "explained"
    assert [p.name for p in found.comparisons[0].differs] == ["lost_rows"]


def test_jumps_that_touch_stay_as_they_are():
    """There was no row between them to place either by: a traceback."""
    logs = lag_path.Turns(*traced(*pair(11)))
    line = lag_path.Line(0.0, 0.0, np.array([30.0, 30.0, 60.0]), np.array([0.1, -0.1, 0.0]),
                         np.zeros(0))
    right = clock_course.placed(logs, lag_path.fitted(logs, line))
    assert len(right.times) == 3 and (np.diff(right.times) >= 0.0).all()


@pytest.mark.parametrize("seed", [8, 40])
def test_hands_that_turn_alike_here_and_there_are_no_clock_that_jumps(seed):
    """Two sessions on the same faces in the same order: "4912 rows are missing in 2 places", of a
    course that found a tenth of the turns in the other log, and left out the others."""
    calm = guided.session(seed, rest_s=2.0, lean=0.02)
    lively = guided.session(seed + 1, rest_s=5.0, lean=0.25)
    assert put_right(calm, lively) is None
