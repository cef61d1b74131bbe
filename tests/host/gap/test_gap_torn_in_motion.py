"""Motion that looks torn where no byte ends as it does where one does, and real torn reads."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis.detect import torn_reads


def flight(generator, n=20000):
    """A gyro in a quadrotor at 1 kHz: its rotors, quiet and then loud, about a slow turn. Peaks
    of theirs lie a page off the median of the samples beside them."""
    t = np.arange(n) / 1000.0
    loud = np.interp(t / t[-1], [0.0, 0.42, 0.5, 1.0], [22.0, 22.0, 450.0, 450.0])
    return np.stack([loud * np.sin(2.0 * np.pi * 118.0 * t + axis)
                     + 1200.0 * np.sin(2.0 * np.pi * t / 9.1 + axis)
                     + 5.0 * generator.standard_normal(n) for axis in range(3)], axis=1)


def slewed(generator, n=12000, most=700.0):
    """A swaying trunk that knocks once in 100 samples, of which firmware lets no sample differ by
    more than `most` counts from the one before: its kinks are a third of that off."""
    t = np.arange(n) / 225.0
    wanted = np.stack([700.0 * np.sin(2.0 * np.pi * 1.1 * t + axis) for axis in range(3)], axis=1)
    wanted += 4.0 * generator.standard_normal((n, 3))
    for column in wanted.T:
        for first in np.arange(40, n - 60, 100):
            start = first + generator.integers(0, 50)
            column[start:start + 3] += 4000.0 * generator.choice([-1, 1])
    rows = np.zeros((n, 3))
    for k in range(1, n):
        rows[k] = rows[k - 1] + np.clip(wanted[k] - rows[k - 1], -most, most)
    return rows


def torn(counts, generator):
    """One reading in twenty has the high byte of the one before."""
    before = np.vstack([counts[:1], counts[:-1]])
    return np.where(generator.random(counts.shape) < 0.05, before // 256 * 256 + counts % 256,
                    counts)


def said(counts):
    session = SimpleNamespace(capture=SimpleNamespace(meta={}, gyro=counts.astype(np.int16)),
                              at_rest=np.zeros(len(counts), bool))
    return [found.effect for found in torn_reads.finding([session], "gyro")]


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("motion", [flight, slewed])
def test_motion_that_looks_torn_beside_the_edges_of_bytes_is_not(motion, seed):
    generator = np.random.default_rng(seed)
    counts = np.rint(motion(generator)).astype(int)
    assert said(counts) == []
    assert said(torn(counts, generator)) == ["torn_reads"]
