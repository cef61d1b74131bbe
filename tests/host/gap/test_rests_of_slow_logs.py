"""A log of a few rows a second rests where it stands, as one of many does."""
import copy
import warnings

import numpy as np
import pytest

from sixflip_host.capture import rests_by_variance
from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.simulator import log_rests, rest_or_course
from tests.worlds.tumbled import RATE_HZ, read, tumbled


@pytest.fixture(scope="module")
def fast():
    return read(*tumbled(3, 600.0), 3)


@pytest.mark.parametrize("hz", [2, 5, 10, 20])
def test_a_slow_log_rests_where_it_stands(fast, hz):
    """The variance of a single row is none, and the noise was told over a hundred rows, in which
    no robot stands: at 10 Hz the whole log was a rest, at 20 and below 10 nothing was."""
    slow, every = copy.copy(fast), int(RATE_HZ / hz)
    for name in ("t_us", "accel", "gyro"):
        setattr(slow, name, getattr(fast, name)[::every])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        runs = log_rests.calm(slow, float(hz))
    t = 1e-6 * slow.t_us % 20.0
    stands = (t <= 3.0) | (t >= 19.5)
    found = np.zeros(len(slow), bool)
    for run in runs:
        found[run.first:run.end] = True
    assert found[stands].mean() > 0.7 and stands[found].mean() > 0.9


def test_a_single_row_has_no_variance():
    with pytest.raises(ValueError, match="no variance"):
        rests_by_variance.sliding_variance(np.zeros((10, 3)), 1)


@pytest.mark.parametrize("hz", [0.1, 0.3, 0.5, 1.0])
def test_what_rolls_rests_at_no_rate_of_rows(hz):
    """A piece of eight means tells no course from noise, one of none or of one cannot be cut."""
    t = np.arange(0.0, 400.0 / hz, 1.0 / hz)
    rng = np.random.default_rng(1)
    rate = 8.0 * np.sin(2.0 * np.pi * 0.06 * hz * t)[:, None] * [1.0, 0.5, 0.2]
    rate = rate + 0.02 * rng.standard_normal(rate.shape)
    found = rest_or_course.resting(rate, [(0, len(t))], hz, 0.003, 0.015)
    assert sum(b - a for a, b in found) < 0.2 * len(t)


def stops_and_an_even_turn(stop_s, turn_dps, bias_dps=(0.0, 0.0, 0.0)):
    """(Capture, (n,) bool: it turns evenly): stops between moves, and 3 s of an even turn."""
    rate_hz, rng = 100.0, np.random.default_rng(3)
    parts, even = [], []
    for k in range(7):
        move = 40.0 * np.sin(np.linspace(0.0, np.pi, 150))[:, None] * rng.uniform(-1, 1, 3)
        turn = np.tile((0.1 * turn_dps, turn_dps, 0.0), (300 if k == 3 else 0, 1))
        stop = np.zeros((int(stop_s * rate_hz), 3))
        parts += [move, stop, turn, stop[:len(stop) // 2] if k == 3 else stop[:0]]
        even += [np.zeros(len(move) + len(stop)), np.ones(len(turn)), np.zeros(len(parts[-1]))]
    rate, even = np.concatenate(parts), np.concatenate(even) > 0
    moving = np.abs(rate).max(axis=1) > 0
    gyro = rate + bias_dps + 0.06 * rng.standard_normal(rate.shape)
    force = np.tile((0.0, 0.0, 1.0), (len(rate), 1)) + 0.004 * rng.standard_normal(rate.shape)
    force += 0.03 * (moving & ~even)[:, None] * rng.standard_normal(rate.shape)
    meta = {"sensor": "mpu6050", "rate_hz": rate_hz, "accel_lsb_per_g": 8192, "accel_range_g": 4,
            "gyro_lsb_per_dps": 65.5, "gyro_range_dps": 500}
    t_us = np.rint(1e6 / rate_hz * np.arange(len(rate))).astype(np.int64)
    return Capture(meta, t_us, np.rint(force * 8192).astype(np.int16),
                   np.rint(gyro * 65.5).astype(np.int16)), even


@pytest.mark.parametrize("turn_dps", [66.0, -25.0])
def test_an_even_turn_is_no_rest_beside_stops_that_are_too_short(turn_dps):
    """Its rate was the gyro's bias."""
    capture, even = stops_and_an_even_turn(0.45, turn_dps)
    rests, _, calm = log_rests.of_capture(capture, 100.0)
    assert not any(even[a:b].any() for a, b in (*rests, *calm))


def test_an_even_turn_that_nothing_else_is_calm_beside_is_none_either():
    capture, even = stops_and_an_even_turn(0.02, 66.0)
    assert not any(even[a:b].any() for a, b in log_rests.of_capture(capture, 100.0)[0])


def test_a_large_bias_is_a_rest():
    capture, even = stops_and_an_even_turn(1.5, 66.0, (0.0, -35.0, 8.0))
    rests = log_rests.of_capture(capture, 100.0)[0]
    assert len(rests) >= 6 and not any(even[a:b].any() for a, b in rests)
