"""Noise that is not normal: what recordings have is; pulses, skews and heavy tails are told."""
import numpy as np
import pytest

from sixflip_host.diagnosis import samples_judged
from sixflip_host.diagnosis.detect import noise_shape
from sixflip_host.experiment import blocks
from tests.worlds.still_session import at_rest, flicker

N = 12000


def still(noise):
    """A rest of two minutes whose accelerometer has this noise on x (n,), counts."""
    session = at_rest(flicker(5, N))
    session.capture.accel[:, 0] = np.rint(noise)
    return session


def odd(noise):
    return [axis for axis, *_ in noise_shape.odd([still(noise)], "accel", {})]


def pulses(generator, counts):
    """Noise of 46 counts with a pulse of 90 ms each 1.7 s."""
    noise = 46.0 * generator.standard_normal(N)
    noise[np.arange(N) % 170 < 9] += counts
    return noise


@pytest.mark.parametrize("noise", [
    lambda g: 46.0 * g.standard_normal(N), lambda g: 0.2 * g.standard_normal(N),
    lambda g: 0.5 + 0.6 * g.standard_normal(N), lambda g: 30.0 * g.standard_t(7.0, N),
    lambda g: 16.0 * np.rint(9.0 * g.standard_normal(N) / 16.0),
    lambda g: 4.0 * flicker(7, N)[:, 0],
    lambda g: 20.0 * g.standard_normal(N) + 80.0 * np.sin(0.7 * np.arange(N)),
    lambda g: 46.0 * g.standard_normal(N) + 4000.0 * (np.arange(N) % 4000 < 30),
    lambda g: 0.4 + 0.1 * g.standard_normal(N), lambda g: 0.25 + 0.3 * g.standard_normal(N),
    lambda g: 16.0 * np.rint((4.0 + 3.0 * g.standard_normal(N)) / 16.0),
    lambda g: 46.0 * g.standard_normal(N) + 460.0 * np.exp(-(np.arange(N) % 1200) / 300.0)],
    ids=["white", "less than a count", "between two codes", "the tails that recordings have",
         "coarse steps", "flicker", "shaken", "three knocks", "mostly of one code",
         "a third of a count", "less than a coarse step", "what fades"])
def test_noise_as_sensors_have_it_is_normal(noise):
    for seed in range(3):
        assert odd(noise(np.random.default_rng(seed))) == []


def test_of_a_few_samples_no_shape_is_known():
    slow = at_rest(flicker(5, 400))
    slow.capture.meta["rate_hz"] = 1.0
    session = blocks.session_of("slow", slow.capture)
    assert session.rate == 1.0 and noise_shape.odd([session] * 9, "accel", {}) == []


@pytest.mark.parametrize("noise", [
    lambda g: 46.0 * g.laplace(size=N), lambda g: pulses(g, 250.0),
    lambda g: 30.0 * g.gamma(2.0, size=N)], ids=["Laplace's", "pulses", "skewed"])
def test_noise_of_another_shape_is_a_gap(noise):
    """Each was no gap: only bursts and single samples far off were looked for."""
    session = still(noise(np.random.default_rng(1)))
    judged = samples_judged.judge([session])
    assert ("accel", "noise") in [(place.sensor, place.domain) for place in judged.nameless]
    assert any("x axis of the accelerometer is not normal" in words for words in judged.remarks)
    assert judged.findings == ()


def test_a_pulse_that_comes_again_is_no_vibration_and_a_vibration_stays_one():
    """Its strongest multiple was a line that explained all of it."""
    generator = np.random.default_rng(2)
    found = samples_judged.judge([still(pulses(generator, 350.0))])
    assert found.findings == () and [p.domain for p in found.nameless] == ["noise"]
    t = np.arange(N) / 100.0
    swells = (1.0 + np.sin(0.4 * t)) * np.sin(2.0 * np.pi * 13.0 * t)
    found = samples_judged.judge([still(46.0 * generator.standard_normal(N) + 90.0 * swells)])
    assert [(f.effect, f.axes) for f in found.findings] == [("vibration", ["x"])]
    assert found.nameless == ()
