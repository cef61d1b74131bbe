"""What a log says anew in each row is held by no row that is odd, and what it holds under noise
stays held: stairs are told by many rises."""

from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import held_readings

ROWS, STEP = 9000, 3e-4


def resting(seed=1):
    """m/s2 of an accelerometer at rest, in steps finer than its noise: a file of floats."""
    noise = np.random.default_rng(seed).normal(0, 0.011, (ROWS, 3))
    return np.rint(([-0.4, -0.15, 9.9] + noise) / STEP) * STEP


def holds(values):
    trace = SimpleNamespace(force=values, rate=None, quantum=(STEP, STEP),
                            rests=((40, ROWS - 40),))
    return held_readings.holds(trace)["accel"]


@pytest.mark.parametrize("row", [0, 4321])
def test_a_row_that_nobody_read_holds_nothing(row):
    values = resting()
    values[row] = 0.0
    assert not holds(values).held
    assert not holds(resting()).held


@pytest.mark.parametrize("size", [0.5, 5.0])
@pytest.mark.parametrize("rows", [[4321], [4321, 4371, 4396]])
def test_a_few_odd_rows_hold_nothing(size, rows):
    """By chance at one place of twenty-five rows, those of three are odd."""
    values = resting()
    values[rows] += [size, -0.5 * size, 0.3 * size]
    assert not holds(values).held


@pytest.mark.parametrize("k", [5, 10, 25])
def test_readings_that_are_held_under_noise_are_seen_beside_an_odd_row(k):
    t = np.arange(ROWS) / 100
    course = np.stack([2 * np.sin(2.1 * t), 1.5 * np.cos(1.3 * t), 9.8 + np.sin(0.9 * t)], 1)
    course[:2000] = course[2000]
    held = course[np.arange(ROWS) // k * k]
    held += np.random.default_rng(4).normal(0, 0.011, held.shape)
    held[5000] += 3.0
    trace = SimpleNamespace(force=held, rate=None, quantum=(STEP, STEP), rests=((40, 1960),))
    found = held_readings.holds(trace)["accel"]
    assert found.rows == k
    assert (np.flatnonzero(found.starts) % k == 0).all()
