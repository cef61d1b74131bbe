"""Rows that nobody read are damage of the recording; what rests at 0 was read."""
import copy

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.detect import held_values, unread_rows
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.present import gap_sentence
from tests.worlds.tumbled import read, tumbled


@pytest.fixture(scope="module")
def sound():
    return read(*tumbled(3), 3)


def spoilt(capture, sensor, rows, code):
    """The capture with one code on all axes of a sensor in some rows."""
    out = copy.copy(capture)
    counts = np.array(getattr(capture, sensor))
    counts[rows] = code
    setattr(out, sensor, counts)
    return out


def test_rows_of_a_sound_log_were_read(sound):
    (_, read_again), = unread_rows.as_read([("one", sound)])[0]
    assert read_again is sound and unread_rows.as_read([("one", sound)])[1] == []


@pytest.mark.parametrize("sensor, rows, code", [
    ("gyro", np.arange(32), -32768), ("accel", np.arange(11800, 12000), 0),
    ("accel", np.array([0, 2500, 4444, 9000, 11000]), -1)])
def test_rows_that_nobody_read_are_taken_out_and_said(sound, sensor, rows, code):
    capture = spoilt(sound, sensor, rows, code)
    ((_, shorter),), (damage,) = unread_rows.as_read([("one", capture)])
    assert (damage.kind, damage.sensor) == (held_values.NOT_READ, sensor)
    assert damage.value == {"rows": len(rows)}
    assert "hold the code %d instead" % code in damage.words
    assert np.array_equal(shorter.t_us, np.delete(sound.t_us, rows))
    assert np.array_equal(shorter.gyro, np.delete(sound.gyro, rows, axis=0))
    assert len(capture) == len(sound)


def test_a_row_on_the_way_to_them_was_not_read_either(sound):
    """Who fills in zeros and then draws the log onto another clock leaves one row between."""
    capture = spoilt(sound, "accel", np.arange(11500, 12000), 0)
    capture.accel[11499] = 0.001 * sound.accel[11498]
    damage, = unread_rows.as_read([("one", capture)])[1]
    assert damage.value == {"rows": 501}


def test_rows_that_were_read_in_part_are_taken_out_as_well(sound):
    """A bus that stops answering in the middle of a row reads -1 from there on."""
    capture = spoilt(sound, "accel", np.array([800, 4444, 9000]), -1)
    capture.accel[[1500, 7000], 1:] = -1
    (_, shorter), = unread_rows.as_read([("one", capture)])[0]
    assert np.array_equal(shorter.t_us, np.delete(sound.t_us, [800, 1500, 4444, 7000, 9000]))


def resting_gyro(rows=6000):
    """(n, 3) counts of a gyro that lies still with a bias of its own on each axis."""
    return np.rint(np.random.default_rng(1).normal([-260.0, 20.0, -40.0], 12.0, (rows, 3)))


def test_zeros_that_a_log_is_filled_up_with_are_no_effect():
    """They were a gyro that is cut off at 0 counts, and a dead band."""
    counts = resting_gyro().astype(np.int16)
    counts[-239:] = 0
    meta = {"sensor": "other", "rate_hz": 100.0, "gyro_lsb_per_dps": 1000.0}
    said = answer.as_dict(diagnose([("one", Capture(
        meta, 10_000 * np.arange(len(counts)), None, counts))]))
    assert said["causes"] == []
    damage, = said["damage"]
    assert damage["kind"] == "not read" and damage["value"] == {"rows": 239}
    assert said["verdict"] == "no gap"
    assert "239 rows" in gap_sentence.sentence(said)


def coarse(rate):
    """A gyro without bias, whose codes are as wide as its noise."""
    return np.rint((rate + 0.05 * np.random.default_rng(2).standard_normal(rate.shape)) * 4.0)


def banded(rate):
    """A dead band of 40 counts on all axes: what is within reads 0, what is not reads itself."""
    counts = np.rint((rate + 0.05 * np.random.default_rng(2).standard_normal(rate.shape)) * 65.5)
    return np.where(np.abs(counts) < 40, 0, counts)


def threshold(rate):
    """The same, beyond which readings begin at 0."""
    counts = np.rint((rate + 0.05 * np.random.default_rng(2).standard_normal(rate.shape)) * 65.5)
    return np.sign(counts) * np.maximum(np.abs(counts) - 40, 0)


def exact(rate):
    """A simulator's gyro without noise."""
    return np.rint(rate * 65.5)


@pytest.mark.parametrize("rows", [1, 10, 100])
@pytest.mark.parametrize("law", [coarse, banded, threshold, exact])
def test_what_rests_at_zero_was_read(law, rows):
    """At 100 rows a second as at one, where a turn begins from one row to the next."""
    t, force, rate = tumbled(4, seconds=1200.0)
    capture = read(t, force, rate, 4)
    capture.gyro = law(rate).astype(np.int16)
    assert (capture.gyro == 0).all(axis=1).mean() > 0.02
    for name in ("t_us", "accel", "gyro"):
        setattr(capture, name, getattr(capture, name)[::rows])
    assert unread_rows.as_read([("one", capture)])[1] == []


def test_an_axis_that_is_always_at_that_code_is_no_unread_row(sound):
    """A channel that says nothing beside three rows of a sensor that were not read: the whole log
    was taken out."""
    capture = spoilt(sound, "accel", np.array([1000, 2400, 4500]), 0)
    capture.accel[:, 1] = 0
    ((_, shorter),), damages = unread_rows.as_read([("one", capture)])
    assert len(shorter) >= len(capture) - 3 and len(damages) <= 1
    capture = spoilt(sound, "gyro", np.array([1000, 2400, 4500]), 0)
    capture.gyro[5613:, 0] = 0
    ((_, shorter),), (damage,) = unread_rows.as_read([("one", capture)])
    assert damage.value == {"rows": 3} and len(shorter) == len(capture) - 3


@pytest.mark.parametrize("code", [32767, -32768])
def test_a_knock_that_drives_all_axes_to_one_end_was_read(sound, code):
    capture = spoilt(sound, "accel", np.array([1500, 1501]), code)
    capture.accel[[1499, 1502]] = code // np.array([3, 4, 5])
    assert unread_rows.as_read([("one", capture)])[1] == []


def without(capture, rows):
    """A log that lacks some rows, whose clock went on."""
    out = copy.copy(capture)
    for name in ("t_us", "accel", "gyro"):
        setattr(out, name, np.delete(getattr(capture, name), rows, axis=0))
    return out


def test_rows_that_nobody_read_hide_none_that_are_lost(sound):
    """Any row that was not read kept lost ones from being told; and none of those that were not
    read is lost itself."""
    unread = np.random.default_rng(6).choice(11000, 300, replace=False)
    capture = spoilt(sound, "accel", unread, -1)
    said = answer.as_dict(diagnose([("one", capture)]))
    assert said["causes"] == [] and said["clock"][0]["losses"]["samples"] == 0
    lost = np.setdiff1d(np.random.default_rng(5).choice(11000, 250, replace=False), unread)
    said = answer.as_dict(diagnose([("one", without(capture, lost))]))
    cause, = said["causes"]
    assert cause["effect"] == "dropped_samples"
    assert cause["value"]["chance"] == pytest.approx(100.0 * len(lost) / len(sound), rel=0.02)
    damage, = said["damage"]
    assert damage["value"] == {"rows": len(unread)}
    sentence = gap_sentence.sentence(said)
    assert "300 rows" in sentence and "loses samples" in sentence


@pytest.mark.parametrize("sensor, rows, code", [
    ("gyro", np.arange(32), -32768), ("accel", np.arange(11800, 12000), 0)])
def test_what_is_taken_out_leaves_no_gap_behind(sound, sensor, rows, code):
    """Rows that nobody read alone were a gap that nothing in the library explains."""
    as_it_is = answer.as_dict(diagnose([("one", sound)]))
    said = answer.as_dict(diagnose([("one", spoilt(sound, sensor, rows, code))]))
    assert said["verdict"] == as_it_is["verdict"] and said["where"] == []
    assert "%d rows" % len(rows) in gap_sentence.sentence(said)
    assert "nothing in the library" not in gap_sentence.sentence(said)


@pytest.mark.parametrize("noise, unread", [(1.0, 0), (2.0, 0), (3.0, 1), (4.0, 1)])
def test_a_code_that_is_usual_on_each_axis_was_read(noise, unread):
    """A knock to one side and the other about a row of zeros: as coarse codes as a sensor has at
    rest give one on all axes by chance, as often as it is knocked; finer ones hardly ever."""
    counts = np.rint(np.random.default_rng(1).normal(0.0, noise, (2000, 3)))
    counts[999:1002] = [[30, 2, 1], [0, 0, 0], [-30, 1, 2]]
    capture = Capture({"sensor": "other", "rate_hz": 100.0, "gyro_lsb_per_dps": 16.0},
                      10_000 * np.arange(2000), None, counts.astype(np.int16))
    ((_, shorter),), _ = unread_rows.as_read([("one", capture)])
    assert len(capture) - len(shorter) == unread
