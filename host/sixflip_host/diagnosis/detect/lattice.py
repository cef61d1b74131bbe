"""The values that a column lies on, and how often the one at 0 is read.

A chip's steps may be wider than a file's own counts, and a bias that was taken off shifts them:
an import of decimals scales counts to its largest reading, so that steps of 0.061 deg/s become
5.35 of them, and a logger that calibrates rounds to finer ones. 0 may be no value at all then, and
a code that is missing near 0 is missing everywhere: a dead band is one only by the values that the
column has. How often each count is read has a line in its spectrum at one over the spacing, whose
phase says where the values lie. Columns that lie on whole counts, or on none, have no such line.
A converter whose steps differ leaves codes of the same low bits out, which its wide steps hold.

Where no code is missing, 0 is read often by a band that reads 0 and beyond which readings begin
at 0 again, or by the noise alone. About a mean of its own each window has noise of its own; noise
through a band competes with noise through none, and with what is rounded towards 0. Where a
window rests in one part and shakes in another its zeros are many and its flanks wide, too: so the
width of the noise may change on the way, with a band and without one.
"""
import math
from dataclasses import dataclass

import numpy as np
from scipy import special

from ...capture import registers
from ...capture.capture_header import ACCEL, GYRO
from ...capture.imports import chip_steps
from ...capture.registers import RAIL
from .detection import present

# Counts to either side of 0 that are looked at: what is farther away tells nothing of a dead band.
# Spacings that are looked for: at two counts each line has its mirror
# image, and 2.39 of 1/2048 rad/s is the narrowest of a public log; above, too few values lie near.
NEAR, LEAST, MOST = 512, 2.1, 64.0
FINER = 16  # values of a spectrum in the width of a line
# Of all readings, in phase: rounding to counts leaves 0.64 of the line of 5 counts and more in
# public logs with a chip's steps, and 0.45 is the most of one without.
IN_PHASE = 0.55
# The same where another axis of the sensor tells the spacing, so that no other is looked for, to
# within what a calibration takes the scales of two axes apart.
BESIDE, SCALED = 0.35, 0.03
BROAD = 0.1  # below this the spectrum is no longer that of how far the readings reach
TOLD = 0.005  # of a spacing: half a count over the readings next to 0
COMMON = 0.75  # quantile of the counts that are read, of which no more counts: what rests at one

# Of a converter's missing codes: the longest period of low bits, in codes; how often a code is
# read that says anything, and how seldom a missing one, of it; places where they are missing, of
# which a gain or chance leaves out one or two; and times as often as those around it, that a code
# is read which has another's part as well; codes beyond that may be as seldom, at the foot of
# narrow noise (of steps of two counts all are); and the share of the samples that is elsewhere,
# which is less in a recording of a sensor that is sold calibrated (codes.MANY).
LONGEST, READ, SELDOM, PLACES, SWALLOWS, AWAY, MISSING = 16, 20.0, 0.1, 4, 1.4, 0.4, 0.1
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


@dataclass(frozen=True)
class Lattice:
    """spacing and offset (counts) of the values, of which the one with number 0 is next to 0."""

    spacing: float = 1.0
    offset: float = 0.0

    def numbers(self, column):
        """int32 (n,) numbers of the values that a column reads."""
        return np.clip(np.rint((column - self.offset) / self.spacing), -RAIL - 1, RAIL).astype(
            np.int32)


COUNTS = Lattice()


def of_columns(counts):
    """[Lattice] of each axis of counts (n, 3) of a sensor, whose axes share a converter."""
    alone = [of_column(column) for column in counts.T]
    told = [one.spacing for one in alone if one is not COUNTS]
    return [of_column(column, told[0]) if told and one is COUNTS else one
            for one, column in zip(alone, counts.T)]


def steps(counts, sensor, per_unit):
    """(3,) counts from a value to the next of columns (n, 3) of "accel" or "gyro": their common
    divisor, or, where an offset or a factor leaves them none, the whole number next to the spacing
    of their values; 1 where that is a chip's own step, beside which the file's are finer.
    per_unit: counts per g or deg/s."""
    kind = {"accel": ACCEL, "gyro": GYRO}[sensor]
    spacings = [1 if chip_steps.is_a_chips(kind, one.spacing / per_unit, TOLD) else one.spacing
                for one in of_columns(counts)]
    divisors = registers.steps(counts)
    return np.where(divisors > 1, divisors, np.rint(spacings)).astype(int)


def of_column(column, about=None):
    """The Lattice of a column (n,) of whole numbers, COUNTS where it has no other; about: the
    spacing of another axis, near which this one's is, or None."""
    near = column[(column > -NEAR) & (column < NEAR)]
    if len(near) < 2:
        return COUNTS
    times = np.bincount(near + NEAR, minlength=2 * NEAR).astype(float)
    times = np.minimum(times, np.quantile(times[times > 0], COMMON))
    spectrum = np.fft.rfft(times, FINER * 2 * NEAR) / times.sum()
    size, per_count = np.abs(spectrum), np.arange(len(spectrum)) / (FINER * 2 * NEAR)
    beyond = int(np.argmax(size < BROAD))
    asked = (np.arange(len(size)) > beyond) & (per_count > 1.0 / MOST) & (per_count < 1.0 / LEAST)
    if about:
        asked &= np.abs(per_count * about - 1.0) < SCALED
    if size[beyond] >= BROAD or not asked.any():
        return COUNTS
    k = int(np.argmax(np.where(asked, size, 0.0)))
    # Readings that lie anywhere have a line of this power once in so many [Rayleigh, Phil. Mag.
    # 10 (1880) 73]; those of a run are one, and so many lines were looked at.
    nats = number_of_readings(near) * size[k] ** 2 - np.log(asked.sum() / FINER + 1.0)
    if size[k] < (BESIDE if about else IN_PHASE) or not present(nats):
        return COUNTS
    spacing = 1.0 / per_count[k]
    # A bit that never changes leaves every other run of codes out as well.
    if any(abs(spacing / (2 << bit) - 1.0) < SCALED
           for bit, _ in registers.fixed_bits(column.astype(np.int64))):
        return COUNTS
    first = -np.angle(spectrum[k]) / (2.0 * np.pi) * spacing - NEAR
    return Lattice(spacing, float(first - spacing * np.rint(first / spacing)))


def number_of_readings(column):
    """Number of runs of the same reading in a column (n,)."""
    return 1 + int(np.count_nonzero(np.diff(column)))


def swallowed_nats(every):
    """Log likelihood ratio (nats) of codes of one run of low bits that (n,) hardly ever reads
    because the step beside them is so wide that it holds them: a converter's missing codes. They
    are fewer than SELDOM of the rarer of both codes beside them wherever those are read, and the
    codes beyond are there; a gain leaves codes out, too, but evenly and with no code beside them
    that is read oftener."""
    if not len(every):
        return 0.0
    least = int(every.min()) - 2 * LONGEST
    times = np.bincount(every - least, minlength=int(every.max()) - least + 2 * LONGEST)
    codes_read, best = np.arange(len(times)) + least, 0.0
    for bits in range(2, LONGEST.bit_length()):
        for wide in range(1, (1 << bits) // 4 + 1):
            for low in range(1 << bits):
                first = np.flatnonzero((codes_read & ((1 << bits) - 1)) == low)
                first = first[(first > 2) & (first < len(times) - wide - 2)]
                beside = times[[first - 1, first + wide]]
                usual = beside.min(axis=0)
                own = times[first[:, None] + np.arange(wide)]
                seen = usual >= READ
                if seen.sum() < PLACES or wide * usual.sum() < MISSING * len(every) or (
                        own[seen] > SELDOM * usual[seen, None]).any():
                    continue
                beyond = times[[first - 2, first + wide + 1]]
                if (beyond[:, seen] <= SELDOM * beside[:, seen]).mean() > AWAY or (
                        beside.sum(axis=1) < SWALLOWS * 0.5 * (beyond + beside[::-1]).sum(
                            axis=1)).all():
                    continue
                best = max(best, float(wide * usual[seen].sum() - own[seen].sum()
                                       ) - math.log(len(times)))
    return best


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
    # Of zeros in a row, as slow noise makes them, one counts.
    runs = registers.number_of_runs(zero) / max(zero.sum(), 1)
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
