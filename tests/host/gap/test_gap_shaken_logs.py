"""What shakes a log that moves on: motors and wheels do, hands and legs do not."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import line_wander, shake_detector, spectral_lines
from sixflip_host.experiment import blocks
from tests.worlds.still_session import at_rest, flicker


def shaken(hz, moving):
    """Session of a log that rests for a while, and is then shaken at hz or moved by a hand."""
    generator = np.random.default_rng(9)
    still = at_rest(flicker(5, 9000)).capture
    t = np.arange(9000) / 100.0
    wave = 400.0 * np.sin(2.0 * np.pi * hz * t) if hz else 0.0
    sway = 900.0 * np.sin(np.cumsum(0.3 + 0.5 * generator.standard_normal(9000)))
    still.accel = still.accel.copy()
    still.accel[3000:, 2] += np.rint((wave + (sway if moving else 0.0)) * np.ones(9000))[
        3000:].astype(np.int16)
    still.pose = np.where(t < 30.0, 1, 0).astype(np.int16)
    return blocks.session_of("s", still)


def test_what_runs_beside_a_log_shows_outside_of_its_rests():
    """A pump that ran half of the time cut the rests, and was "no gap"."""
    found, = shake_detector.steady([shaken(24.2, moving=False)])
    assert found.axes == ["z"] and found.hz["z"] == pytest.approx(24.2, abs=0.01)
    assert shake_detector.steady([shaken(0.0, moving=True)]) == []


def test_what_goes_on_legs_has_strides_and_no_vibration():
    """A trot's strides, and its knocks at a multiple of them, were a vibration of 25 mg."""
    assert shake_detector.steady([shaken(4.3, moving=False)]) == []
    lines = [SimpleNamespace(hz=hz) for hz in (4.3, 12.9, 18.1)]
    assert [line.hz for line in line_wander.without_strides(lines, [])] == [18.1]
    assert line_wander.without_strides(lines[1:], []) == lines[1:]


@pytest.mark.parametrize("motor", [0.0, 24.2])
def test_what_is_loudest_at_the_fifth_of_its_strides_walks(motor):
    """Only lines of 2 Hz and more were looked for, so that strides of 1.9 Hz had no name for their
    multiples: a walk was a vibration of 10 Hz. What a motor does beside it keeps its own."""
    walk = shaken(0.0, moving=True)
    t = np.arange(9000) / 100.0
    course = sum(size * np.sin(2.0 * np.pi * times * 1.9 * t) for times, size in (
        (1, 150.0), (2, 200.0), (5, 500.0)))
    walk.capture.accel[3000:, 1] += np.rint(course)[3000:].astype(np.int16)
    if motor:
        walk.capture.accel[3000:, 0] += np.rint(
            300.0 * np.sin(2.0 * np.pi * motor * t))[3000:].astype(np.int16)
    found = shake_detector.steady([walk])
    assert [one.axes for one in found] == ([["x"]] if motor else [])


@pytest.mark.parametrize("rate, hz, named", [
    (50.0, 0.0, False), (50.0, 21.0, True), (100.0, 0.0, False), (100.0, 25.0, True)])
def test_a_hand_that_trembles_is_no_vibration_and_what_is_faster_is(rate, hz, named):
    """At 50 rows a second a tremor of 9 Hz is nearly as fast as what changes from row to row."""
    generator, t = np.random.default_rng(3), np.arange(6000) / rate
    held = np.arange(6000) % 1000 > 250
    tremor = 500.0 * np.sin(2.0 * np.pi * 9.0 * t + np.cumsum(generator.normal(0.0, 0.05, 6000)))
    wave = 300.0 * np.sin(2.0 * np.pi * hz * t)
    accel = held * (tremor + wave) + generator.normal(0.0, 20.0, 6000)
    capture = Capture({"sensor": "mpu6050", "rate_hz": rate, "accel_lsb_per_g": 16384},
                      np.rint(1e6 * t).astype(np.int64),
                      np.rint(accel[:, None] + [0.0, 0.0, 16384.0]).astype(np.int16))
    found = shake_detector.shaken([blocks.session_of("held", capture)])
    assert len(found) == named
    if named:
        assert found[0].value["x"] == pytest.approx(300.0 / 16.384, rel=0.1)


def test_a_motion_without_a_rest_has_no_line_that_is_not_steady():
    moving = shaken(0.0, moving=True)
    moving.capture.pose[:] = 0
    moving.capture.accel = np.roll(moving.capture.accel, -3000, axis=0)[:6000]
    whole = shake_detector.Moving("s", moving.capture, 100.0)
    assert spectral_lines.strongest([whole], "accel", 2).hz < spectral_lines.MOTION_HZ
    assert spectral_lines.line_of_axis([whole], "accel", 2) is None


def test_what_folds_into_a_slow_log_shakes_it():
    """A robot on wheels whose chip is read 20 times a second: nothing is faster than 10 Hz."""
    generator = np.random.default_rng(6)
    driving = np.arange(1400) % 350 > 100
    accel = (1.0 + 4.0 * driving)[:, None] * generator.normal(0.0, 300.0, (1400, 3))
    accel += [0.0, 0.0, 16384.0] + 800.0 * np.sin(np.arange(1400) / 9.0)[:, None]
    capture = Capture({"sensor": "mpu6050", "rate_hz": 20.0, "accel_lsb_per_g": 16384},
                      50_000 * np.arange(1400), np.rint(accel).astype(np.int16))
    found, = shake_detector.shaken([blocks.session_of("driving", capture)])
    assert found.axes == ["x", "y", "z"]


@pytest.mark.parametrize("rate", [2.0, 10.0, 20.0])
def test_noise_of_a_slow_log_shakes_nothing(rate):
    """A second of ten rows has two independent values beyond the motion: by chance one of fifty
    seconds is a fifth as loud as most, and a box that lay still was shaken most of the time."""
    generator = np.random.default_rng(7)
    accel = generator.normal(0.0, 16.0, (9000, 3)) + [0.0, 0.0, 16384.0]
    capture = Capture({"sensor": "mpu6050", "rate_hz": rate, "accel_lsb_per_g": 16384},
                      np.arange(9000) * int(1e6 / rate), np.rint(accel).astype(np.int16))
    assert shake_detector.shaken([blocks.session_of("still", capture)]) == []


@pytest.mark.parametrize("rows", [2, 20, 63])
def test_of_a_log_of_few_rows_nothing_is_shaken(rows):
    capture = Capture({"sensor": "mpu6050", "rate_hz": 50.0, "accel_lsb_per_g": 16384},
                      20_000 * np.arange(rows), np.zeros((rows, 3), np.int16))
    assert shake_detector.findings([blocks.session_of("short", capture)]) == []


@pytest.mark.parametrize("jerks", [0.0, 400.0])
def test_what_is_next_to_nothing_of_all_that_is_fast_does_not_shake_it(jerks):
    """A pen that was moved now and then was shaken most of the time, by a three-hundredth of the
    power that its jerks have."""
    rng, second = np.random.default_rng(8), np.arange(120 * 100) // 100
    noise = np.where(second % 3 == 0, 2.0, 20.0) + jerks * (second % 20 == 7)
    accel = noise[:, None] * rng.standard_normal((len(second), 3))
    capture = Capture({"sensor": "mpu6050", "rate_hz": 100.0, "accel_lsb_per_g": 16384},
                      10_000 * np.arange(len(second)), np.rint(accel).astype(np.int16), None, None)
    found = shake_detector.shaken([blocks.session_of("pen", capture)])
    assert [f.axes for f in found] == ([["x", "y", "z"]] if not jerks else [])


@pytest.mark.parametrize("rate", [50.0, 100.0, 400.0])
def test_gravity_does_not_shake_what_it_turns_about(rate):
    """A thousandth of it came through the filter: an axis of little noise that lies level in some
    seconds was quiet then, and was shaken by 1 mg wherever it did not."""
    t = np.arange(0.0, 120.0, 1.0 / rate)
    angle = 2.0 * np.pi * t / 60.0
    force = np.stack([np.sin(angle), np.full(len(t), 0.1), np.cos(angle)], 1)
    assert np.abs(shake_detector._fast(1000.0 * force, rate)).max() < 0.1
    noise = 0.00015 * np.random.default_rng(4).standard_normal(force.shape)
    capture = Capture({"sensor": "other", "rate_hz": rate, "accel_lsb_per_g": 16384},
                      np.rint(1e6 * t).astype(np.int64),
                      np.rint(16384.0 * (force + noise)).astype(np.int16))
    assert shake_detector.shaken([blocks.session_of("turned", capture)]) == []


@pytest.mark.parametrize("shares, axes", [((1.0, 1.0, 1.0), "xyz"), ((0.0, 0.0, 1.3), "z")])
def test_what_shakes_all_axes_alike_is_told_of_all_or_none(shares, axes):
    """A rover three times as loud in most seconds as in the few in which it stands: by chance one
    axis was a little more than that, and the others a little less."""
    told = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        loud = np.repeat(np.where(rng.random(180) < 0.1, 0.0, rng.uniform(45.0, 72.0, 180)), 100)
        accel = rng.normal(0.0, 20.0, (18000, 3)) + loud[:, None] * shares * rng.normal(
            size=(18000, 3)) + [0.0, 0.0, 16384.0]
        capture = Capture({"sensor": "mpu6050", "rate_hz": 100.0, "accel_lsb_per_g": 16384},
                          10_000 * np.arange(18000), np.rint(accel).astype(np.int16))
        told += [found.axes for found in shake_detector.shaken([blocks.session_of("r", capture)])]
    assert len(told) >= 5 and all(one == list(axes) for one in told)
