"""A real gyro that does not answer slow turns, beside a simulator of the same motion: a dead band
of its size, and no scale."""
import numpy as np
import pytest

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison, dead_zone, traces
from tests.worlds.tumbled import META, attitudes, read, tumbled

TRUE = 3.0  # deg/s


def soft(rate):
    return rate - np.clip(rate, -TRUE, TRUE)


def hard(rate):
    return rate * (np.abs(rate) >= TRUE)


def rounded(rate):
    return rate - TRUE * np.tanh(rate / TRUE)


def logs(change, seed=1, loud=1.0, bias=0.0):
    """(real, simulated) captures; loud: times its noise, bias: deg/s, that the simulator's gyro
    has."""
    t, force, rate = tumbled(seed, 60.0)
    noise = 0.05 * np.sqrt(loud ** 2 - 1.0) * np.random.default_rng(7).standard_normal(rate.shape)
    return read(t, force, change(rate), seed), read(t, force, rate + bias + noise, 100 + seed)


def compared(*args, **kinds):
    real, simulated = logs(*args, **kinds)
    return comparison.compare([("real", real)], "sim", simulated)


def scale(found):
    """Percent by which the scale of a gyro's axis differs at most."""
    return max(abs(p.difference) for p in found.parameters
               if (p.name, p.sensor) == ("scale", "gyro"))


@pytest.mark.long
@pytest.mark.parametrize("change", [soft, hard, rounded])
def test_its_width_and_form_are_found_and_no_scale_is_wrong(change, monkeypatch):
    """The scales were some percent less, and most of the gap was left."""
    found = compared(change)
    assert [band.axis for band in found.bands] == [0, 1, 2] and found.of_gyro > dead_zone.GYRO
    for band in found.bands:
        assert band.form == change.__name__
        assert np.degrees(band.rate) == pytest.approx(TRUE, rel=0.05)
        low, high = np.degrees(band.interval)
        assert low - 0.05 < TRUE < high + 0.05 and high - low < 0.5
    monkeypatch.setattr(dead_zone, "found", lambda *logs: ())
    without = compared(change)
    assert scale(found) < max(0.02, 0.5 * scale(without))
    assert found.gap["gyro"][1] < 0.3 * without.gap["gyro"][1]
    assert found.gap["gyro"][0] == without.gap["gyro"][0]


@pytest.mark.long
def test_it_is_a_cause_in_counts_that_explains_the_gap():
    real, simulated = logs(soft)
    found = answer.as_dict(diagnose([("real", real)], [("sim", simulated)], jobs=1))
    cause, = found["causes"]
    assert (cause["effect"], cause["class"], cause["sensor"]) == (
        "dead_band", ["dead_band"], "gyro")
    assert all(size == pytest.approx(65.5 * TRUE, rel=0.05) for size in cause["value"].values())
    assert set(cause["value"]) == set("xyz") and cause["share"] > 0.9
    assert found["verdict"] == "explained"


def test_about_the_zero_of_a_reading_that_has_a_bias():
    found = compared(lambda rate: hard(rate + 1.0), bias=2.0)
    assert [band.axis for band in found.bands] == [0, 1, 2]
    assert all(np.degrees(band.rate) == pytest.approx(TRUE, rel=0.1) for band in found.bands)


def curved(rate):
    return rate + 2e-6 * rate ** 3


def bent_widely(rate):
    """Less by up to 3 deg/s over 40: a bent line says it better than a band of one does."""
    return rate - 3.0 * np.tanh(rate / 40.0)


def one_sided(rate):
    return rate * (1.0 + 0.03 * (rate > 0.0))


def coarse(rate):
    return TRUE * np.rint(rate / TRUE)


def shaken(rate):
    return rate + 5.0 * np.random.default_rng(5).standard_normal(rate.shape)


def limited(rate):
    return np.clip(rate, -60.0, 60.0)


def averaged(rate):
    return np.stack([np.convolve(x, np.ones(30) / 30.0, "same") for x in rate.T], 1)


@pytest.mark.long
@pytest.mark.parametrize("change", [
    np.copy, curved, bent_widely, one_sided, coarse, shaken, limited, averaged],
    ids=lambda change: change.__name__)
def test_what_answers_to_slow_turns_has_none(change):
    assert compared(change).bands == ()


def test_a_simulator_that_is_louder_at_rest_has_no_band_in_the_real_one():
    assert compared(np.copy, loud=20.0).bands == ()


def test_a_log_in_other_axes_is_not_asked():
    real, simulated = logs(soft)
    simulated.gyro = simulated.gyro[:, [1, 0, 2]]
    assert comparison.compare([("real", real)], "sim", simulated).bands == ()


@pytest.mark.long
@pytest.mark.parametrize("change", [soft, hard, rounded])
def test_what_turns_it_may_not_answer_and_the_forces_say_so(change):
    """A motor that does not start below some rate: the gyro is sound, and was blamed."""
    t, force, rate = tumbled(1, 60.0)
    moved = read(t, attitudes(change(rate))[:, 2], change(rate), 1)
    simulated = read(t, force, rate, 101)
    diagnosed = diagnose([("real", moved)], [("sim", simulated)], jobs=1)
    found, = diagnosed.comparisons
    assert found.bands and found.of_gyro <= 0.0 and "gyro" in found.shaken
    assert any("lacks turns slower than" in remark for remark in found.remarks)
    assert not diagnosed.causes and not diagnosed.findings and diagnosed.verdict != "explained"


def simulated_without_noise(t, force, rate, bias=0.0):
    """60 rows a second of what has no noise, in the codes of 1000 deg/s."""
    at = np.arange(0.0, t[-1], 1.0 / 60.0)
    force, rate = (np.stack([np.interp(at, t, x) for x in own.T], 1) for own in (force, rate))
    return Capture(dict(META, rate_hz=60.0, gyro_lsb_per_dps=32.8),
                   np.rint(1e6 * at).astype(np.int64), np.rint(force * 8192).astype(np.int16),
                   np.rint((rate + bias) * 32.8).astype(np.int16))


def beside_no_noise(change, seconds=20.0):
    """The Comparison of a quiet gyro that makes this of the rates."""
    t, force, rate = tumbled(1, seconds)
    real = read(t, force, np.zeros_like(rate), 1)
    noise = 0.01 * np.random.default_rng(4).standard_normal(rate.shape)
    real.gyro = np.rint((change(rate) + noise) * 65.5).astype(np.int16)
    return comparison.compare([("real", real)], "sim", simulated_without_noise(t, force, rate))


def test_what_is_drawn_for_a_simulators_rounding_earns_no_band():
    """One of 2 counts had 200 nats by the lack of it on every axis, whatever the band was."""
    assert beside_no_noise(np.copy).bands == ()


@pytest.mark.long
def test_beside_a_simulator_without_noise_a_band_is_found():
    found = beside_no_noise(lambda rate: rate - np.clip(rate, -0.3, 0.3), 40.0)
    assert [band.axis for band in found.bands] == [0, 1, 2]
    assert all(np.degrees(band.rate) == pytest.approx(0.3, rel=0.1) for band in found.bands)


def test_rounding_is_noise_of_what_has_none():
    t, force, rate = tumbled(1, 20.0)
    loud, silent = (traces.trace_from_capture("one", capture) for capture in (
        read(t, force, rate, 1), simulated_without_noise(t, force, rate, 0.01)))
    noise = dead_zone.in_band(silent, silent, "gyro", 4.0)
    assert np.degrees(noise) == pytest.approx(np.sqrt(2.0 / 12.0) / 32.8, rel=0.01)
    noise = dead_zone.in_band(loud, loud, "gyro", 4.0)
    assert np.degrees(noise) == pytest.approx(0.05 * np.sqrt(2.0 * 2.0 * 4.0 / 100.0), rel=0.6)
