"""The noise of the simulated sensors: the same bit for bit in numpy, and Gaussian."""

import numpy as np

from sixflip_sim import noise


def vectorised(stream, k):
    """noise.gauss_int for an int64 array, written for numpy from its docstring."""
    x = noise.bits(stream, k)
    body = np.array(list(noise.BODY) + [0], dtype=np.int64)
    tail = np.array(noise.TAIL, dtype=np.int64)
    cell = (x >> 24) & 0x7F
    i = np.minimum(cell, 126)
    value = body[i] + (((body[i + 1] - body[i]) * (x & 0xFFFFFF)) >> 24)
    j = (x >> 18) & 0x3F
    far = tail[j] + (((tail[j + 1] - tail[j]) * (x & 0x3FFFF)) >> 18)
    value = np.where(cell == 127, far, value)
    return np.where(x >> 31, -value, value)


def test_same_integers_in_numpy():
    k = np.concatenate([np.arange(20000), 2**32 - 1 - np.arange(20000)]).astype(np.int64)
    for seed, channel in ((1, 0), (0xFFFFFFFF, 6), (12345, 0x400)):
        stream = noise.key(seed, channel)
        scalar = [noise.gauss_int(stream, int(i)) for i in k]
        assert np.array_equal(vectorised(stream, k), scalar)


def test_products_fit_a_small_int():
    assert noise.MASK * 0x31848BAB < 2**62
    assert noise.MASK * 0x21F0AAAD < 2**62
    assert noise.MASK * 0x1E3779B1 < 2**62


def test_moments_and_tails():
    x = vectorised(noise.key(7, 2), np.arange(2_000_000, dtype=np.int64)) * noise.UNIT
    assert abs(x.mean()) < 4 / np.sqrt(len(x))
    assert abs(x.std() - 1) < 0.003
    assert abs((x**3).mean()) < 0.02
    assert abs((x**4).mean() - 3) < 0.06
    assert abs(np.mean(np.abs(x) > 3) / 0.0027 - 1) < 0.1


def test_streams_and_samples_are_independent():
    k = np.arange(200_000, dtype=np.int64)
    streams = [vectorised(noise.key(s, c), k) * noise.UNIT
               for s in (1, 2) for c in range(7)]
    table = np.corrcoef(streams) - np.eye(len(streams))
    assert np.abs(table).max() < 5 / np.sqrt(len(k))
    x = streams[0]
    for lag in (1, 2, 5, 100):
        assert abs(np.mean(x[lag:] * x[:-lag])) < 5 / np.sqrt(len(k))
    # the mean of 400 samples scatters by 1/20, as white noise does
    assert abs(x.reshape(-1, 400).mean(axis=1).std() * 20 - 1) < 0.15


def test_uniform_covers_its_interval():
    stream = noise.key(3, 9)
    u = np.array([noise.uniform(stream, k) for k in range(20000)])
    assert -1 <= u.min() < -0.999 and 0.999 < u.max() < 1
    assert abs(u.mean()) < 0.02 and abs(u.std() - 1 / np.sqrt(3)) < 0.01
