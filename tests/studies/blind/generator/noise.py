"""Noise of the parts: white, 1/f shaped in the frequency domain, and recorded noise."""

import numpy as np


def one_over_f(rng, n, rate, rms, exponent=1.0, slowest_s=2000.0):
    """(n,) of spectral density f**-exponent, flat below 1/slowest_s, of the given RMS."""
    if rms == 0:
        return np.zeros(n)
    coarse = max(1, int(rate / 5))
    m = n // coarse + 3
    length = int(2 ** np.ceil(np.log2(max(2 * m, slowest_s * rate / coarse))))
    f = np.fft.rfftfreq(length, coarse / rate)
    shape = np.maximum(f, 1 / slowest_s) ** (-exponent / 2)
    shape[0] = 0
    spectrum = shape * (rng.normal(size=f.size) + 1j * rng.normal(size=f.size))
    series = np.fft.irfft(spectrum, length)
    series *= rms / np.std(series)
    start = rng.integers(0, length - m)
    return np.interp(np.arange(n), np.arange(m) * coarse, series[start:start + m])


def synthetic(rng, chip, n, rate):
    """(accel (n, 3) g, gyro (n, 3) deg/s) of a healthy part."""
    accel = rng.normal(size=(n, 3)) * chip.white_g
    gyro = rng.normal(size=(n, 3)) * chip.white_dps
    for axis in range(3):
        accel[:, axis] += one_over_f(rng, n, rate, chip.flicker_g)
        gyro[:, axis] += one_over_f(rng, n, rate, chip.flicker_dps)
    return accel, gyro


def recorded(arrays):
    """A noise source from recordings at rest.

    arrays: list of (m, 6) counts (accel, gyro) of the chip a case uses, at rest, at its rate.
    Returns f(rng, chip, n, rate) like `synthetic`: one recording from a random moment on,
    without its mean, walked forward and backward until n samples are there (so no step where
    it ends), each channel with a random sign. What it holds of drift, colour and quantisation
    stays.
    """
    arrays = [np.asarray(a, float) for a in arrays if len(a) >= 100]
    if not arrays or any(a.ndim != 2 or a.shape[1] != 6 for a in arrays):
        raise ValueError("recorded noise wants a list of (m, 6) arrays of 100 rows or more")

    def source(rng, chip, n, rate):
        piece = arrays[rng.integers(len(arrays))]
        there_and_back = np.concatenate([piece, piece[-2:0:-1]])
        where = (rng.integers(len(there_and_back)) + np.arange(n)) % len(there_and_back)
        out = (there_and_back - piece.mean(axis=0))[where] * rng.choice([-1.0, 1.0], 6)
        return out[:, :3] / chip.accel_lsb_per_g, out[:, 3:] / chip.gyro_lsb_per_dps

    return source
