"""What recordings of one sensor are compared by: white noise, Allan deviation, amplitude spectrum,
steps of the counts, the strongest line.

x is (n, k), n samples of k channels, in any unit, which the results are in as well.
"""
import numpy as np

MEDIAN_OF_SQUARE = 0.4549  # of a standard normal


def white(x):
    """Standard deviation of what changes from sample to sample, per column of x (n, k)."""
    return np.diff(x, axis=0).std(axis=0) / np.sqrt(2.0)


def allan(x, m):
    """Allan deviation (k,) of x (n, k) over m samples, overlapping; nan when x is too short.

    Source: IEEE Std 952-1997, annex C.
    """
    if len(x) < 3 * m:
        return np.full(x.shape[1], np.nan)
    total = np.vstack([np.zeros((1, x.shape[1])), np.cumsum(x - x.mean(axis=0), axis=0)])
    second = (total[2 * m:] - 2.0 * total[m:-m] + total[:-2 * m]) / m
    return np.sqrt(0.5 * np.mean(second ** 2, axis=0))


def spectrum(x, rate_hz, length=1024):
    """(frequencies, amplitude density (f, k) in units per root Hz): Welch's, Hann windows."""
    from scipy.signal import welch
    length = min(length, len(x))
    frequencies, density = welch(x, rate_hz, nperseg=length, axis=0)
    return frequencies, np.sqrt(density)


def band(x, rate_hz, low, high):
    """Root mean square amplitude density (k,) between two frequencies."""
    frequencies, density = spectrum(x, rate_hz)
    inside = (frequencies >= low) & (frequencies < high)
    return np.sqrt(np.mean(density[inside] ** 2, axis=0))


def step(counts):
    """Greatest common divisor (k,) of all counts: the size of a step."""
    return np.gcd.reduce(np.abs(np.asarray(counts, dtype=np.int64)), axis=0)


def line(x, rate_hz, above_hz=5.0):
    """(frequency, amplitude, phase in rad at the first sample) of the strongest line in x (n,),
    the frequency refined between the bins by the least squares fit of a sine."""
    n = len(x)
    amplitude = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(n)))
    frequencies = np.fft.rfftfreq(n, 1.0 / rate_hz)
    amplitude[frequencies < above_hz] = 0.0
    near = frequencies[amplitude.argmax()]
    best = max(near + np.linspace(-1.0, 1.0, 81) * rate_hz / n,
               key=lambda f: sine(x, rate_hz, f)[0])
    return (best,) + sine(x, rate_hz, best)


def sine(x, rate_hz, frequency):
    """(amplitude, phase) of the sine a·sin(2 pi f t + phase) nearest to x (n,)."""
    angle = 2.0 * np.pi * frequency * np.arange(len(x)) / rate_hz
    columns = np.stack([np.sin(angle), np.cos(angle), np.ones(len(x))], 1)
    s, c, _ = np.linalg.lstsq(columns, x, rcond=None)[0]
    return float(np.hypot(s, c)), float(np.arctan2(c, s))


def railed(counts, rail=32764):
    """Share (k,) of samples on a rail."""
    return (np.abs(np.asarray(counts, dtype=np.int64)) >= rail).mean(axis=0)
