"""Values on the grid of a chip's steps that is shifted by an offset of its own on each axis."""

import numpy as np
import pytest

from sixflip_host.capture import open_recording
from sixflip_host.diagnosis import samples_judged
from sixflip_host.experiment import blocks
from tests.worlds.imported_text import imported, table

OFFSETS = np.array([0.004404936, -0.0027524184, 0.0025446901])      # rad/s, of no step at all


def _at_rest(steps_per_dps, number=6000):
    """(forces in m/s2, rates in rad/s) of a sensor that lies still, with a handful of codes."""
    rng = np.random.default_rng(9)
    codes = np.rint(rng.normal([-3.0, 1.0, 2.0], [1.6, 1.0, 1.1], (number, 3)))
    return rng.normal([0.0, 0.0, 9.80665], 0.02, (number, 3)), \
        np.radians(codes / steps_per_dps) + OFFSETS


def _read(tmp_path, capsys, accel, gyro):
    return imported(tmp_path, capsys, table(
        ["%.3f" % (k / 200) for k in range(len(accel))], accel=accel, gyro=gyro, form="%.8g"),
        "--units", "m/s2,rad/s")


def test_a_few_codes_with_an_offset_on_each_axis_are_whole_steps(tmp_path, capsys):
    """They were kept as floats, as if the sensor had no steps."""
    accel, gyro = _at_rest(32768 / 1000)
    capture, said = _read(tmp_path, capsys, accel, gyro)
    assert "all gyro values of an axis are whole steps of 1/32.768" in said
    assert "gyro values are no whole steps" not in said
    assert [len(np.unique(column)) for column in capture.gyro.T] == \
        [len(np.unique(column)) for column in np.round(gyro, 7).T]
    read = np.radians(capture.gyro / capture.meta["gyro_lsb_per_dps"])
    assert read == pytest.approx(gyro, abs=1e-6)
    session = blocks.session_of("out.csv", open_recording.read_samples(tmp_path / "out.csv"))
    assert "quantisation" not in {f.effect for f in samples_judged.FOUND_BY[1]([session])}


def test_steps_that_are_no_chips_and_values_without_steps_stay_as_they_are(tmp_path, capsys):
    accel, gyro = _at_rest(29.3)
    assert "gyro values are no whole steps" in _read(tmp_path, capsys, accel, gyro)[1]
    smooth = gyro + np.random.default_rng(3).normal(0.0, 2e-4, gyro.shape)
    (tmp_path / "out.csv").unlink()
    assert "gyro values are no whole steps" in _read(tmp_path, capsys, accel, smooth)[1]


def test_steps_that_reach_far_keep_the_means_of_their_axes(tmp_path, capsys):
    """In 16 bits there is no room for a part of a step: the values are what they were."""
    accel, gyro = _at_rest(32768 / 1000)
    gyro[::2] += 20_000 * np.radians(1000 / 32768)
    capture, said = _read(tmp_path, capsys, accel, gyro)
    assert "gyro values are no whole steps" in said
    read = np.radians(capture.gyro / capture.meta["gyro_lsb_per_dps"])
    assert read.mean(axis=0) == pytest.approx(gyro.mean(axis=0), abs=1e-5)
