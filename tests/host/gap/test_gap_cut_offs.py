"""Where readings end: at a range, at a level, or nowhere, whatever else repeats in them."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture import registers as counts
from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.detect import saturation
from sixflip_host.diagnosis.detect.detection import present
from sixflip_host.present import gap_sentence, gap_words


def imported(size, level, sensor="gyro", **meta):
    """Session of a log that was imported with 100 counts a unit: a turn or a shake of so many
    units that ends at a level."""
    x = 100.0 * size * np.sin(np.arange(3000) / 40.0)[:, None] * [1.0, 0.3, 0.2]
    x += np.random.default_rng(1).normal(0.0, 3.0, x.shape)
    read = np.clip(np.rint(x), -100.0 * level, 100.0 * level).astype(np.int16)
    header = {"sensor": "other", "rate_hz": 100.0, "imported_from": "log.csv",
              "accel_lsb_per_g": 100.0, "gyro_lsb_per_dps": 100.0, **meta}
    return SimpleNamespace(capture=Capture(header, 10_000 * np.arange(3000), read, read),
                           at_rest=np.zeros(3000, bool))


def test_counts_are_whole_numbers_in_the_answer():
    """A stop at 32764 was "32760 [32760, 32760]", and 3.28e+04 in the table."""
    session = imported(1.4 * 327.64, 327.64)
    cause = answer.of_finding(saturation.saturation([session], "gyro", [session.capture.gyro])[0])
    assert cause["value"] == {"x": 32764} and cause["interval_90"] == {"x": [32764, 32764]}
    assert "x 32764 counts" in gap_words.row(cause)[-1]


@pytest.mark.parametrize("sensor, level, meta, limit", [
    ("gyro", 249.98, {}, "range"), ("gyro", 250.13, {}, "range"), ("gyro", 245.0, {}, "range"),
    ("accel", 2.0, {"accel_lsb_per_g": 1000.0}, "range"), ("gyro", 180.0, {}, "level"),
    ("gyro", 180.0, {"gyro_range_dps": 250}, "below_range"), ("accel", 1.2, {}, "level")])
def test_where_an_imported_log_ends_is_its_range_where_that_is_a_usual_one(sensor, level, meta,
                                                                           limit):
    """Its counts are the import's, and the codes where they end are no converter's: 250 deg/s was
    'below its range'."""
    session = imported(1.3 * level, level, sensor, **meta)
    scale = session.capture.meta[counts.SCALES[sensor]]
    session = imported(1.3 * level * scale / 100.0, level * scale / 100.0, sensor, **meta)
    found, = saturation.saturation([session], sensor, [getattr(session.capture, sensor)])
    assert found.limits == {"x": limit}
    assert found.levels == ({} if meta.get(counts.RANGES[sensor]) else {"x": pytest.approx(level)})


def test_an_imported_log_levels_off_at_a_value_with_its_unit():
    session = imported(234.0, 180.0)
    found, = saturation.saturation([session], "gyro", [session.capture.gyro])
    cause = answer.of_finding(found)
    assert cause["cut_off_at"] == {"x": "level"}
    assert (cause["cut_off_level"], cause["cut_off_unit"]) == ({"x": 180.0}, "°/s")
    said = {"verdict": "explained", "causes": [cause], "damage": [], "gap": {}}
    assert gap_sentence.sentence(said) == "The X gyro levels off at 180 °/s."
    assert gap_words.row(cause)[0] == "saturation (levels off)"


@pytest.mark.parametrize("wide", [1, 5566])
def test_noise_of_a_few_codes_is_not_cut_off(wide):
    """At rest the last of them is read many times, also where decimals are rounded to either
    side."""
    rng = np.random.default_rng(3)
    x = wide * np.clip(np.rint(0.5 + 0.8 * rng.standard_normal(400)), -1, 2).astype(int)
    x += rng.integers(0, 2, 400) if wide > 1 else 0
    assert not present(saturation.cut_off_nats(x))


def faces(rng, noise, size=256.0):
    """Six rests of 600 samples of one axis, in counts."""
    level = rng.uniform(0.98, 1.13, 6) * size * np.array([1.0, -1.0, 0.0, 0.0, 0.0, 0.0])
    return np.rint(np.repeat(level, 600) + noise * rng.normal(size=3600)).astype(int)


def stepped(x):
    return 3 * np.rint(x / 3.0).astype(int)


def stuck(x):
    return x & ~8


def slow(x):
    return np.repeat(x, 3)[:len(x)]


@pytest.mark.parametrize("spoilt", [stepped, stuck, slow])
def test_values_that_repeat_everywhere_are_no_peaks_cut_off(spoilt):
    for seed in range(40):
        rng = np.random.default_rng(seed)
        x = spoilt(faces(rng, rng.uniform(1.5, 5.0)))
        for side in (x, -x):
            assert not present(saturation.cut_off_nats(side)), seed


@pytest.mark.parametrize("spoilt", [np.array, stepped, slow])
def test_peaks_cut_off_are_found_whatever_else_repeats(spoilt):
    for seed in range(10):
        rng = np.random.default_rng(seed)
        turns = 900.0 * np.sin(np.linspace(0.0, 60.0, 3600)) * rng.uniform(0.6, 1.0, 3600)
        x = spoilt(np.clip(faces(rng, 3.0) + np.rint(turns).astype(int), -520, 520))
        assert all(present(saturation.cut_off_nats(side)) for side in (x, -x)), seed


def test_a_pose_that_a_robot_comes_back_to_is_no_peak_cut_off():
    """Each visit's largest reading is that of the same noise about the same mean."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        pose, way = np.full(600, 8310.0), 8310.0 * np.cos(np.linspace(0.0, 2.0 * np.pi, 200))
        x = np.rint(np.tile(np.concatenate([pose, way]), 8) + rng.normal(0.0, 0.8, 6400))
        assert not present(saturation.cut_off_nats(x.astype(int))), seed


def test_a_rate_that_a_motor_goes_to_again_is_no_peak_cut_off():
    """A turntable's simulator had a saturation that the sensor had not."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        rates = np.repeat(rng.choice([0.0, 938.0, 1797.4, -1663.0, 2945.7], 60), 200)
        rates = np.convolve(rates, np.hanning(60) / np.hanning(60).sum(), "same")
        x = np.rint(rates + rng.normal(0.0, 2.5, len(rates))).astype(int)
        assert not present(saturation.cut_off_nats(x)), seed
        assert present(saturation.cut_off_nats(np.minimum(x, 2941))), seed


def test_gravity_in_a_log_of_attitudes_ends_at_no_level():
    """A robot that leans now and then and is level in between: no axis reads more than the whole
    of gravity, most samples read it, and no reading is any shorter there. Cut off at nine tenths
    it is."""
    t = np.arange(6000) / 100.0
    lean = 0.3 * np.clip(np.sin(0.6 * t), 0.0, None) * np.sin(2.3 * t)
    force = 16384.0 * np.stack([np.sin(lean), 0.0 * t, np.cos(lean)], 1)

    def cut(read):
        read = np.rint(read).astype(np.int16)
        capture = Capture({"sensor": "other", "rate_hz": 100.0, "imported_from": "log.csv",
                           "accel_lsb_per_g": 16384.0, "gyro_lsb_per_dps": 100.0},
                          10_000 * np.arange(6000), read, read)
        found = saturation.saturation([SimpleNamespace(capture=capture)], "accel", [read])
        return [axis for finding in found for axis in finding.axes]

    assert cut(force) == []
    assert cut(np.minimum(force, 0.98 * 16384.0)) == ["z"]
