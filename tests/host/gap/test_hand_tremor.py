"""A box that a hand holds in some of its rests: it trembles there, and its sensors do not."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.capture.rests import Run
from sixflip_host.diagnosis.detect import shake_detector, spectral_lines
from sixflip_host.experiment import blocks

RATE, REST, NUMBER = 100.0, 450, 16


def rests(shaken, hz=8.5, wanders=1.0, size=1.4, pushes_mg=0.0, seed=6):
    """Session of rests, shaken (NUMBER,) times as much as size, deg/s, about a frequency that
    wanders by so many Hz."""
    rng = np.random.default_rng(seed)
    n = NUMBER * (REST + 100)
    accel = rng.normal(0.0, 2.0, (n, 3)) + [0.0, 0.0, 1000.0]
    gyro = rng.normal(0.0, 0.05, (n, 3))
    runs, slow = [], np.ones(40) / 40.0
    for k, times in enumerate(shaken):
        first = k * (REST + 100)
        runs.append(Run(1 + k % 12, first, first + REST))
        for axis in range(3):
            course = np.convolve(rng.normal(size=REST + 39), slow, "valid") * 40.0 ** 0.5
            phase = 2.0 * np.pi * np.cumsum(hz + wanders * course) / RATE
            wave = times * np.sin(phase + rng.uniform(0.0, 6.0))
            gyro[first:first + REST, axis] += size * wave
            accel[first:first + REST, axis] += pushes_mg * wave
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 16384.0,
            "gyro_lsb_per_dps": 65.5}
    capture = Capture(meta, np.rint(np.arange(n) * 1e6 / RATE).astype(np.int64),
                      np.rint(16.384 * accel).astype(np.int16),
                      np.rint(65.5 * gyro).astype(np.int16))
    return blocks.session_of("s", capture, runs)


HELD = np.arange(NUMBER) % 3 == 1


def told(session):
    """(findings before, findings after, sentences)."""
    lines = spectral_lines.findings([session])
    return (lines, *shake_detector.without_tremor(lines, [session]))


def test_a_hand_that_trembles_in_some_of_the_rests_is_no_effect_of_the_gyro():
    lines, left, (said,) = told(rests(HELD))
    assert [f.sensor for f in lines] == ["gyro"] and not left and "hand" in said


@pytest.mark.parametrize("more", [
    {"shaken": np.ones(NUMBER)},  # whoever holds it
    {"shaken": np.random.default_rng(2).exponential(1.0, NUMBER) ** 0.5},  # a resonance
    {"shaken": HELD, "wanders": 0.0},  # a machine that runs for a while
    {"shaken": HELD, "hz": 23.0},  # faster than any hand
    {"shaken": HELD, "pushes_mg": 15.0}])  # a floor
def test_what_shakes_the_gyro_otherwise_keeps_its_name(more):
    lines, left, said = told(rests(**more))
    assert any(f.sensor == "gyro" for f in lines) and left == lines and not said
