"""A log of a few rows a second rests where it stands, as one of many does."""
import copy
import warnings

import numpy as np
import pytest

from sixflip_host.capture import rests_by_variance
from sixflip_host.diagnosis.simulator import log_rests
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
