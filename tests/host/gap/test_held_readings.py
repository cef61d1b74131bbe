"""Readings that a simulator makes slower than its rows: how long each stands, and how late it is
besides."""
from dataclasses import replace

import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import (
    comparison,
    convention_findings,
    evidence_of_logs,
    held_readings,
    traces,
)
from tests.worlds.tumbled import RATE_HZ, read, tumbled


def stairs(rate, rows, late=0, phase=0):
    """Rates (n, 3) of every so many rows, of so many rows before, until the next."""
    at = np.maximum((np.arange(len(rate)) - phase) // rows * rows + phase - late, 0)
    return rate[at]


def of_poses(rate, rows):
    """What the poses of every so many rows say of the rate between them: backward differences,
    each held until the next."""
    angle = np.cumsum(np.vstack([np.zeros((1, 3)), rate]), axis=0)
    at = np.arange(len(rate)) // rows * rows
    return (angle[at] - angle[np.maximum(at - rows, 0)]) / rows


def in_counts(rate, noise, seed=3):
    return np.rint(32.8 * rate + noise * np.random.default_rng(seed).standard_normal(rate.shape))


def held(counts, t):
    """The Hold of counts (n, 3), at rest in every twenty seconds' first three."""
    starts = np.arange(0, len(t), int(20 * RATE_HZ))
    rests = tuple((k, k + int(2.9 * RATE_HZ)) for k in starts)
    return held_readings.sensor_hold(counts.astype(float), 1.0, rests)


@pytest.mark.parametrize("rows, phase", [(2, 0), (5, 3), (11, 4)])
@pytest.mark.parametrize("noise", [0.0, 0.1, 3.0])
def test_noise_that_changes_a_code_here_and_there_is_no_new_reading(rows, phase, noise):
    """With a tenth of a count stairs of 20 Hz were readings of 46."""
    t, _, rate = tumbled(2, 60.0)
    hold = held(in_counts(stairs(rate, rows, phase=phase), noise), t)
    assert hold.rows == pytest.approx(rows, rel=0.02)
    assert set(np.flatnonzero(hold.starts[500:1500]) % rows) == {(phase - 500) % rows}


@pytest.mark.parametrize("per_second", [46.0, 30.0])
def test_readings_between_two_rows_stand_for_a_part_of_one(per_second):
    """They are no stairs of whole rows."""
    t, _, rate = tumbled(2, 60.0)
    at = np.floor(np.floor(t * per_second) / per_second * RATE_HZ).astype(int)
    counts = in_counts(rate, 1.0)[at]
    assert held(counts, t).rows == pytest.approx(RATE_HZ / per_second, rel=0.04)


@pytest.mark.parametrize("noise", [0.0, 0.1, 3.0])
def test_what_is_new_in_every_row_is_not_held(noise):
    t, _, rate = tumbled(2, 60.0)
    assert not held(in_counts(rate, noise), t).held


def test_how_late_poses_are_is_told_beside_how_long_they_stand():
    """39 ms were said, and an unknown convention, as if every change of a code was a new reading.
    The middle of the five rows of which the difference is taken is three rows before the row in
    which it is new."""
    t, force, rate = tumbled(2, 40.0)
    sim = read(t, force, rate, 102)
    sim.gyro = np.rint(2.0 * in_counts(of_poses(rate, 5), 0.1)).astype(np.int16)
    found = comparison.compare([("real", read(t, force, rate, 2))], "sim", sim)
    held_at, = found.conventions
    assert held_at.name == "gyro_rate_held" and held_at.value["rate"] == pytest.approx(20.0)
    assert found.gap["gyro"][1] < 0.02
    # The mean of five rows; what is made of rows between two poses is none of the simulator's.
    smooth, = (p for p in found.parameters if (p.name, p.sensor) == ("smoothness", "gyro"))
    assert smooth.difference == pytest.approx(-0.5 * (5.0 ** 2 - 1.0) / 12.0 * 100.0, abs=15.0)
    # Beside the pole that bends a slow motion as much, and is late by itself.
    late, = (p for p in found.parameters if p.name == "delay")
    low, high = (x - np.sqrt(-2.0 * smooth.difference) for x in late.difference_interval)
    assert low < -30.0 < high and high - low < 4.0


def test_a_delay_says_what_its_repeated_rows_add():
    delay = convention_findings.finding("gyro_delay", "gyro", 1.0, 50.0, "take 25.0 ms out of it")
    holds = {"gyro": held_readings.Hold(5.0, np.ones(9, bool))}
    assert held_readings.beside(delay, RATE_HZ, holds).set_to == (
        "take 25.0 ms out of it, besides the 20.0 ms by which its rows are late on average "
        "because they repeat readings")
    assert held_readings.beside(delay, RATE_HZ, {
        "gyro": held_readings.Hold(1.0, np.ones(9, bool))}) is delay


def test_what_is_freed_of_a_hold_goes_on_to_the_end_of_the_log():
    t, force, _ = tumbled(2, 60.0)
    ramp = np.outer(t, (3.0, -2.0, 1.0))
    trace = traces.trace_from_capture("one", read(t, force, np.zeros_like(ramp), 1))
    starts = np.arange(len(t)) % 7 == 3
    starts[0] = True
    trace = replace(trace, rate=stairs(ramp, 7, phase=3))
    freed = held_readings.free(trace, {"accel": held_readings.Hold(1.0, starts),
                                       "gyro": held_readings.Hold(7.0, starts)}).rate
    np.testing.assert_allclose(freed[3:], ramp[3:], atol=1e-9)


@pytest.mark.parametrize("rows", [0.75, -0.75, 6.3, -6.3])
def test_a_signal_goes_on_straight_beyond_the_ends_of_the_log(rows):
    """Held there, it had a bend of thousands of times its noise at the last of its rows, by which
    late logs were held for unknown."""
    ramp = np.outer(np.arange(200.0), (1.0, -2.0))
    late = evidence_of_logs.shifted(ramp, rows)
    np.testing.assert_allclose(late, ramp - np.outer(np.full(200, rows), (1.0, -2.0)), atol=1e-9)
    np.testing.assert_allclose(evidence_of_logs.shifted(ramp, rows, 3), late[::3], atol=1e-9)
