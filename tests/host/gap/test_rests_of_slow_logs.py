"""A log of a few rows a second rests where it stands, as one of many does."""
import copy
import warnings

import numpy as np
import pytest

from sixflip_host.capture import rests_by_variance
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
