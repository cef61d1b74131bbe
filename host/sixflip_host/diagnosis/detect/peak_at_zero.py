"""How often 0 is read near 0, where no code is missing: by a band that reads 0 and beyond which
readings begin at 0 again, or by the noise alone.

About a mean of its own each window has noise of its own; noise through a band competes with noise
through none, and with what is rounded towards 0. Where a window rests in one part and shakes in
another its zeros are many and its flanks wide, too: so the width of the noise may change on the
way, with a band and without one.
"""
import numpy as np
from scipy import special

from ...capture import registers

WINDOW = 32  # samples
FEWEST_NEAR, LEAST_NOISE = 50, 0.3  # samples beside 0; steps: with less noise 0 may be all
CROSSINGS, MOST_WINDOWS = 4, 400  # of 0 in a window, what passes through has one; to save time
# Steps: none, rounding towards 0, and bands a quarter wider each, as well as a width is known.
NONE, BANDS = (0.0, 0.5), np.unique(np.rint(1.25 ** np.arange(20)))
LEVELS_NEAR, WIDTHS_NEAR = 25, 24  # of the mean and the noise in a window: both to a fifth
ODD = 0.1  # chance that a window does not keep still: 0 piles up in it and thins out anyhow
# Chance that a window's noise changes, and of each sample that it does there: as what shakes for
# a quarter of a window does, from rest to it and back; widths to choose from, twice as wide each
# where the widest is some hundred steps.
CHANGING, CHANGE, WIDTHS_OF_CHANGE = 0.3, 0.125, 12
SILENT = 0.1  # steps of noise: less reads 0 as always; between what shakes a rest may have none


def of_zeros(column):
    """(half the width (counts) of a band that reads 0 and that what is beyond it begins at 0
    again, nats) of a column (n,), where no code is missing. About a mean of its own near 0 each
    window has noise of its own; that through a band competes with the noise alone, and with what
    is rounded towards 0. A sensor whose bias was taken off reads 0 most often by its noise."""
    x = column.astype(np.int64)
    step = _step(x)
    windows = x[:len(x) // WINDOW * WINDOW].reshape(-1, WINDOW) / step
    windows = windows[registers.sign_changes(windows) >= CROSSINGS]
    windows = windows[::-(-max(len(windows), 1) // MOST_WINDOWS)]
    if np.count_nonzero(windows) < FEWEST_NEAR:
        return 0.0, 0.0
    plain, banded = ([_log_of_band(windows, band).sum() for band in bands]
                     for bands in (NONE, BANDS))
    nats = np.array(banded) - max(plain) - np.log(len(BANDS))
    best, zero = int(nats.argmax()), (windows == 0).ravel()
    runs = registers.number_of_runs(zero) / max(zero.sum(), 1)  # which slow noise makes: one counts
    return (BANDS[best] * step, nats[best] * runs) if nats[best] > 0.0 else (0.0, 0.0)


def _log_of_band(windows, band):
    """(n,) log likelihood of windows (n, WINDOW) of steps through a band, over all means and
    noises that each may have."""
    size, zeros = np.abs(windows), (windows == 0).sum(axis=1)
    number = windows.shape[1] - zeros
    noise = np.geomspace(LEAST_NOISE, max(1.0, float(size.max())), WIDTHS_NEAR)[:, None]
    mean = np.linspace(-1.0, 1.0, LEVELS_NEAR) * (band + 2.0 * noise)
    at_zero = np.subtract(*(special.ndtr((end - mean) / noise) for end in (band + .5, -band - .5)))
    width = np.sqrt(noise ** 2 + 1.0 / 12.0)  # of whole steps [Sheppard's correction]
    true = windows + band * np.sign(windows)
    logs = (np.multiply.outer(zeros, np.log(np.maximum(at_zero, 1e-300)))
            - np.multiply.outer(number, np.log(width * np.sqrt(2.0 * np.pi)) + 0.0 * mean)
            - 0.5 * ((true ** 2).sum(axis=1)[:, None, None]
                     - 2.0 * np.multiply.outer(true.sum(axis=1), mean)
                     + np.multiply.outer(number, mean ** 2)) / width ** 2)
    held = special.logsumexp(logs, axis=(1, 2)) - np.log(mean.size)
    # Zeros of any share, and flanks that are exponential, as wide as they are.
    reach = np.maximum(size.sum(axis=1) / np.maximum(number, 1), 1.0)
    odd = special.betaln(zeros + 1, number + 1) - number * (1.0 + np.log(2.0 * reach))
    return special.logsumexp([np.log(1.0 - ODD - CHANGING) + held, np.log(ODD) + odd,
                              np.log(CHANGING) + _log_of_changes(windows, band)], axis=0)


def _log_of_changes(windows, band):
    """(n,) log likelihood of windows (n, WINDOW) of steps through a band, of noise about 0 whose
    width now and then changes to any other from one sample to the next."""
    size = np.abs(windows)[..., None]
    noise = np.geomspace(SILENT, max(1.0, float(size.max())), WIDTHS_OF_CHANGE)
    at_zero = special.erf((band + 0.5) / noise / np.sqrt(2.0))
    width = np.sqrt(noise ** 2 + 1.0 / 12.0)
    beside = np.exp(-0.5 * ((size + band) / width) ** 2) / (width * np.sqrt(2.0 * np.pi))
    likely = np.maximum(np.where(size == 0, at_zero, beside), 1e-300)
    chance, logs = np.full(len(noise), 1.0 / len(noise)), 0.0
    for k in range(windows.shape[1]):
        chance = chance * likely[:, k]
        total = chance.sum(axis=1, keepdims=True)
        logs = logs + np.log(total[:, 0])
        chance = (1.0 - CHANGE) * chance / total + CHANGE / len(noise)
    return logs


def _step(x):
    """Greatest common divisor of the distances of the codes that a column (n,) reads, however few
    they are: of codes that it never reads, these say nothing about 0."""
    values = registers.codes(x)
    values = values[np.abs(values) < registers.RAIL]
    return int(np.gcd.reduce(np.diff(values))) if len(values) > 1 else 1
