"""Zeros that are many without a band: a rest between two shakes, and steps of which few are read;
with a band they stay its own."""
import numpy as np
import pytest

from sixflip_host.capture import registers
from sixflip_host.diagnosis.detect import dead_band
from sixflip_host.diagnosis.detect.detection import present


def shaken(noise, wide, decays):
    """(12000, 3) counts of a rest with noise that is shaken three to five times a second, at 100
    rows a second, for six rows or so that it takes."""
    rng, every = np.random.default_rng(1), np.zeros(12000)
    shake, k = np.exp(-np.arange(50) / 6.0) if decays else (np.arange(50) < 12) * 1.0, 50
    while k < len(every) - 60:
        every[k:k + 50] = np.maximum(every[k:k + 50], shake)
        k += int(rng.integers(22, 34))
    return np.rint(rng.normal(0.0, noise, (len(every), 3))
                   + every[:, None] * rng.normal(0.0, wide, (len(every), 3))).astype(np.int16)


@pytest.mark.parametrize("noise, wide, decays", [
    (0.33, 16.4, True), (0.33, 16.4, False), (0.49, 4.9, False), (0.33, 49.2, False)])
def test_a_rest_between_shakes_is_no_dead_band(noise, wide, decays):
    counts = shaken(noise, wide, decays)
    assert dead_band.findings("gyro", [counts], [np.zeros(len(counts), bool)]) == []


def test_shakes_of_what_has_no_noise_are_no_dead_band():
    """Two fifths of the time they shake, for five rows each."""
    rng = np.random.default_rng(3)
    shakes = np.repeat(rng.random(4000) < 0.4, 5)[:, None]
    counts = np.rint(shakes * rng.normal(0.0, 6.0, (20000, 3))).astype(np.int16)
    assert dead_band.findings("gyro", [counts], [np.zeros(len(counts), bool)]) == []


@pytest.mark.parametrize("slow", [0.0, 0.6])
def test_a_band_in_noise_that_goes_on_is_told(slow):
    """Slow noise reads 0 in runs as well, whose width does not change."""
    rng = np.random.default_rng(5)
    levels = np.repeat(np.linspace(-4.2, 4.2, 20), 500)
    noise = rng.standard_normal(len(levels))
    for k in range(1, len(noise)):
        noise[k] = slow * noise[k - 1] + np.sqrt(1.0 - slow ** 2) * noise[k]
    true = levels + 6.0 * noise
    band, nats = dead_band.of_zeros(np.rint(np.sign(true) * np.maximum(np.abs(true) - 3, 0)))
    assert present(nats) and 2 <= band <= 3
    assert not present(dead_band.of_zeros(np.rint(true))[1])


def test_steps_of_which_few_are_read_have_no_band():
    counts = 8 * np.rint(np.random.default_rng(2).normal(0.0, 0.5, (20000, 3))).astype(np.int16)
    assert len(np.unique(counts)) < registers.FEWEST_VALUES
    assert dead_band.findings("gyro", [counts], [np.zeros(len(counts), bool)]) == []


def test_three_levels_are_no_steps_wider_than_any_that_is_paid_for():
    levels = np.random.default_rng(4).integers(-1, 2, (2000, 3))
    assert registers.steps(600 * levels).tolist() == [1, 1, 1]


def turning_at_times(noise):
    """((6000, 3) deg/s of what stands still and turns by turns, as a simulated rover does: its
    rates come and go gently; bool (6000,) where it stands still)."""
    rng = np.random.default_rng(8)
    asked = np.repeat(rng.choice([0.0, 0.0, -40.0, 25.0, 3.0], 30), 200)
    rates = np.zeros((6000, 3))
    for k in range(1, 6000):
        rates[k] = rates[k - 1] + 0.08 * (asked[k] * np.array([1.0, -0.6, 0.8]) - rates[k - 1])
    still = (np.abs(rates) < 1e-4).all(axis=1)
    return np.where(still[:, None], 0.0, rates) + rng.normal(0.0, noise, (6000, 3)), still


@pytest.mark.parametrize("jolts", [0.0, 0.3])
def test_a_simulator_that_stands_still_has_no_dead_band(jolts):
    """It has no noise in motion either: any sensor's least noise, 9 counts, says nothing, and what
    jolts it where it stands, for a row in forty, is none."""
    rates, still = turning_at_times(0.0)
    rng = np.random.default_rng(9)
    rates += jolts * still[:, None] * (rng.random((6000, 1)) < 0.025) * rng.normal(size=(6000, 3))
    counts = np.rint(360.0 * rates).astype(np.int16)
    assert dead_band.findings("gyro", [counts], [still], 9.0) == []


def test_a_band_that_takes_the_noise_of_all_three_axes_is_told_by_their_noise_in_motion():
    rates, still = turning_at_times(0.025)
    counts = np.rint(360.0 * np.sign(rates) * np.maximum(np.abs(rates) - 0.15, 0.0))
    said, = dead_band.findings("gyro", [counts.astype(np.int16)], [still], 9.0)
    assert said.axes == ["x", "y", "z"]
