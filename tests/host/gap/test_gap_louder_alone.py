"""One long rest that nobody labelled, in which the noise of one sensor alone is not the same all
the while."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import noise_bursts
from sixflip_host.experiment import blocks

RATE, SECONDS = 100.0, 150.0
T = np.arange(int(RATE * SECONDS)) / RATE
NOISE = {"accel": 40.0, "gyro": 4.0}  # counts
STEADY, BURSTS = np.ones(len(T)), np.where(T % 11.0 < 1.5, 4.0, 1.0)


def lying(loud=STEADY, but=(), turns=0.0, seed=4):
    """Session of a box that lies still; loud (n,): times the noise, of all sensors but these;
    turns (n,): deg/s about the vertical."""
    rng, counts = np.random.default_rng(seed), {}
    for sensor, noise in NOISE.items():
        times = 1.0 if sensor in but else np.asarray(loud)[..., None]
        counts[sensor] = np.rint(times * noise * rng.normal(size=(len(T), 3))).astype(np.int16)
    counts["accel"][:, 2] += 16384
    counts["gyro"][:, 2] += np.rint(131.0 * turns * STEADY).astype(np.int16)
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 131}
    return blocks.session_of("still", Capture(
        meta, np.rint(T * 1e6).astype(np.int64), counts["accel"], counts["gyro"]))


@pytest.mark.parametrize("sensor, other", [("gyro", "accel"), ("accel", "gyro")])
def test_bursts_that_cut_one_long_rest_into_many_are_said(sensor, other):
    """They ended the rest that would have shown them: no gap."""
    session = lying(BURSTS, but=[other])
    assert len(session.runs) > 5 and not session.turned_over
    (said, words, p), = noise_bursts.unsteady([session])
    assert said == sensor and "bursts" in words and p < 1e-6


def test_what_shakes_both_sensors_at_once_may_be_a_motion():
    assert noise_bursts.unsteady([lying(BURSTS)]) == []


def test_steady_noise_is_steady():
    assert noise_bursts.unsteady([lying()]) == []


def test_a_platform_that_turns_while_its_accelerometer_is_quiet_is_no_louder_gyro():
    turning = (T % 12.0 > 8.0) * 30.0 * np.sin(0.5 * np.pi * (T % 12.0 - 8.0))
    session = lying(turns=turning)
    assert len(session.runs) > 5 and noise_bursts.unsteady([session]) == []


def test_noise_whose_level_comes_and_goes_is_said():
    """A loudspeaker beside a gyro whose drive a tone is near to: "no gap" but for the rate."""
    level = np.exp(0.9 * np.sin(2.0 * np.pi * T / 7.0))
    (said, words, p), = noise_bursts.unsteady([lying(level, but=["accel"])])
    assert said == "gyro" and "comes and goes" in words and p < 1e-6


@pytest.mark.parametrize("but", [["gyro"], []])
def test_what_shakes_a_floor_for_a_while_is_no_sensor_s_noise(but):
    """The accelerometer may hear it alone; what both hear is around them."""
    level = np.exp(0.4 * np.sin(2.0 * np.pi * T / 20.0))
    assert noise_bursts.unsteady([lying(level, but=but)]) == []


def test_noise_below_a_code_that_slides_from_one_to_the_next_does_not_come_and_go():
    """A quiet gyro of 16.4 counts a deg/s was "unexplained"."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        session = lying()
        walk = np.cumsum(0.005 * rng.normal(size=(len(T), 3)), axis=0)
        session.capture.gyro[:] = np.rint(walk + 0.2 * rng.normal(size=walk.shape))
        assert noise_bursts.unsteady([session]) == [], seed


def test_a_filter_s_noise_has_no_level_that_changes():
    """White noise, and that of a slow filter, whose half seconds differ by much more."""
    rng, found = np.random.default_rng(2), []
    for wide in (1, 20):
        x = rng.normal(size=(len(T), 3)).cumsum(axis=0)
        x = np.diff(x[wide:] - x[:-wide], axis=0)[:len(T) // 50 * 50 - 50]
        power = (x.reshape(-1, 50, 3) ** 2).mean(axis=1)
        first, least = 50 * np.arange(len(power)), np.full(3, 0.5)
        found.append(noise_bursts.level_changes(power, first, 50, least)[1])
    assert min(found) > 1e-3
