"""A sine goes on; a hump, or what is there in one rest alone, has no steady frequency."""
import numpy as np
from scipy import signal

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import spectral_lines
from sixflip_host.experiment import blocks

RATE, HZ, SEEDS = 100.0, 5.8, 12


def lines(waves):
    """The lines that are told of rests of so many mg (n,) each, beside 1 mg of noise."""
    rng = np.random.default_rng(len(waves[0]))
    n = sum(map(len, waves))
    accel = rng.normal(0.0, 1.0, (n, 3)) + [0.0, 0.0, 1000.0]
    accel[:, 0] += np.concatenate(waves)
    pose = np.repeat(1 + np.arange(len(waves)), [len(wave) for wave in waves])
    meta = {"sensor": "other", "rate_hz": RATE, "accel_lsb_per_g": 16384.0}
    found = spectral_lines.findings([blocks.session_of("s", Capture(
        meta, 10_000 * np.arange(n), np.rint(16.384 * accel).astype(np.int16),
        pose=pose.astype(np.int16)))])
    return [line for f in found for line in f.lines if line.letter == "x"]


def hump(seed, n, size=1.5):
    """(n,) mg, root mean square, of noise through a resonance at HZ that is 0.3 Hz wide."""
    width = np.exp(-np.pi * 0.3 / RATE)
    x = signal.lfilter([1.0], [1.0, -2.0 * width * np.cos(2 * np.pi * HZ / RATE), width ** 2],
                       np.random.default_rng(seed).normal(size=n + 2000))[2000:]
    return size * x / x.std()


def test_a_hump_that_one_rest_shows_has_no_steady_frequency():
    """Of ten seconds, in which it swings by some dozens of cycles: its top is next to HZ."""
    told = [line for seed in range(SEEDS) for line in lines([hump(seed, 975)])]
    assert len(told) > SEEDS / 2
    assert sum(line.steady for line in told) <= 1
    assert np.median([abs(line.hz - HZ) for line in told]) < 0.2


def test_what_is_in_the_shorter_rest_alone_is_not_told_by_the_noise_of_the_longer_one():
    """A rocket on its rail: a hump in 5 s, and nothing in 7 s later."""
    told = [line for seed in range(4 * SEEDS)
            for line in lines([hump(seed, 530, 2.0), np.zeros(730)])]
    assert len(told) > 2 * SEEDS and sum(line.steady for line in told) <= 1
    assert np.median([abs(line.hz - HZ) for line in told]) < 0.2


def test_a_sine_in_one_rest_is_steady_and_has_its_own_frequency():
    t = np.arange(975) / RATE
    for phase in np.linspace(0.0, 6.0, SEEDS):
        line, = lines([1.4 * np.sin(2 * np.pi * HZ * t + phase)])
        assert line.steady and line.low < HZ < line.high
        assert abs(line.amplitude - 1.4) < 0.25
