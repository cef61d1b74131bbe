"""A gyro's rest without an accelerometer: bias, noise, slope, line, integrity, each as put in."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.errors import BadFile
from sixflip_host.present import gap_words

RATE, SECONDS, LSB = 50.0, 300.0, 131.0
META = {"sensor": "other", "rate_hz": RATE, "gyro_lsb_per_dps": LSB, "temp_lsb_per_c": 100.0,
        "temp_offset_c": 0.0}
BIAS = np.array([0.8, -1.2, 0.3])


def capture_of(change=None, slope=0.0, wave=0.0):
    """A rest of white noise of 0.05 deg/s a sample; slope: deg/s per degC on y;
    wave: deg/s of a sine of 0.31 Hz on z."""
    t = np.arange(int(RATE * SECONDS)) / RATE
    warm = 25.0 + 10.0 * (1.0 - np.exp(-t / 100.0))
    rates = BIAS + 0.05 * np.random.default_rng(1).standard_normal((len(t), 3))
    rates[:, 1] += slope * (warm - warm.mean())
    rates[:, 2] += wave * np.sin(2.0 * np.pi * 0.31 * t)
    counts = np.rint(rates * LSB).astype(np.int16)
    return Capture(dict(META), np.rint(t * 1e6).astype(np.int64), None,
                   change(counts) if change else counts,
                   np.rint(100.0 * warm).astype(np.int16))


def told(*args, **kinds):
    """The answer on such a capture."""
    return answer.as_dict(diagnose([("gyro", capture_of(*args, **kinds))], jobs=1))


def test_a_sound_gyro_has_its_bias_and_noise_and_no_gap():
    found = told()
    assert found["verdict"] == "no gap" and found["causes"] == [] and found["damage"] == []
    noise = found["noise"]["gyro"]
    for axis, bias in zip("xyz", BIAS):
        low, high = noise["bias_interval_90"][axis]
        assert low - 1e-3 < bias < high + 1e-3 and high - low < 0.01
        assert noise["density"][axis] == pytest.approx(0.05 / np.sqrt(RATE), rel=0.05)
    tau, deviation = noise["allan"][4]["tau_s"], noise["allan"][4]["deviation"]
    assert deviation == pytest.approx([0.05 / np.sqrt(tau * RATE)] * 3, rel=0.15)
    assert "noise density" in "\n".join(gap_words.noise_lines("gyro", noise))
    assert not [u for u in found["unseen"] if u["sensor"] == "accel"]


def test_a_slope_over_the_temperature_and_a_slow_line():
    found = told(slope=0.03, wave=0.04)
    causes = {c["class"][0]: c for c in found["causes"]}
    assert set(causes) == {"thermal_bias", "vibration"}
    low, high = causes["thermal_bias"]["interval_90"]["y"]
    assert causes["thermal_bias"]["axes"] == ["y"] and low < 0.03 < high
    line = causes["vibration"]["lines"]["z"]
    low, high = line["interval_90_hz"]
    assert list(causes["vibration"]["lines"]) == ["z"] and line["steady"]
    assert low - 1e-4 < 0.31 < high + 1e-4 and high - low < 1.0 / SECONDS


def test_damage_of_a_gyro_alone():
    found = told(lambda counts: np.repeat(counts[::2], 2, axis=0))
    assert [(d["kind"], d["sensor"]) for d in found["damage"]] == [("repeats", "gyro")]
    assert found["verdict"] == "unexplained" and found["causes"] == []


def test_beside_a_simulator_it_needs_an_accelerometer():
    with pytest.raises(BadFile, match="^own: it holds a gyro alone, expected ax ay az"):
        diagnose([("own", capture_of())], simulator=[("sim", capture_of(slope=0.01))])
