"""Strides and their multiples: what goes on legs does so steadily, and its steps and knocks are
lines that no sensor is shaken at.
"""
import numpy as np

# What runs on legs has strides of a frequency in between, and is shaken at multiples of it: so
# many are tried, each off by this share at most.
SLOWEST_HZ, STRIDES_HZ, MULTIPLES, MULTIPLE = 0.7, 5.0, 12, 0.005
# A stride stands that far out of the power around it, from two thirds of its frequency to one and
# a half times, but for its own lobe: noise of one axis does so once in a million bins.
STANDS, AROUND, LOBE = 20.0, 1.5, 4


def without(lines, moves):
    """Those of the lines of what moves that are no strides, nor multiples of one; moves: Sessions,
    or stretches of them, of which the accelerometer tells strides that are no line."""
    strides = [line.hz for line in lines if line.hz < STRIDES_HZ]
    return [line for line in lines if not any(_multiple(line.hz, hz) for hz in strides)
            and not _of_a_stride(line.hz, moves)]


def _multiple(hz, stride):
    times = hz / stride
    return round(times) >= 1 and abs(times - round(times)) < MULTIPLE * times


def _of_a_stride(hz, moves):
    """Whether something stands out at a part of a frequency, as nothing does of what is shaken by
    itself: its multiples are above it."""
    spectra = [_spectrum(move) for move in moves if move.capture.accel is not None]
    return any(_stands(*spectrum, hz / times) for spectrum in spectra
               for times in range(2, MULTIPLES + 1) if SLOWEST_HZ <= hz / times < STRIDES_HZ)


def _spectrum(move):
    """(Hz (k,), power (k,) of all axes) of the accelerometer of all of a move."""
    x = move.capture.accel - move.capture.accel.mean(axis=0)
    power = np.abs(np.fft.rfft(x * np.hanning(len(x))[:, None], axis=0)) ** 2
    return np.fft.rfftfreq(len(x), 1.0 / move.rate), power.sum(axis=1)


def _stands(hz, power, stride):
    near = np.abs(hz - stride) <= max(MULTIPLE * stride, hz[1])
    around = (hz > stride / AROUND) & (hz < stride * AROUND)
    around &= np.abs(hz - stride) > MULTIPLE * stride + LOBE * hz[1]
    return near.any() and around.any() and power[near].max() > STANDS * np.median(power[around])
