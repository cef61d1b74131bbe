"""Logs of phones and simulators from which gravity has been taken out, and others in which it does
not show because nothing rests."""

import numpy as np
import pytest

from sixflip_host.capture import open_recording
from tests.worlds.imported_text import ROWS, SECONDS, G, imported, refused, table


def test_acceleration_without_gravity_asks_for_its_unit(tmp_path, capsys):
    values = np.random.default_rng(12).normal(0, 0.05, (ROWS, 3))
    text = table(["%.2f" % t for t in SECONDS], accel=values, form="%.9f")
    assert "gravity has been taken out" in refused(tmp_path, capsys, text)
    found = open_recording.read(tmp_path / "in.csv", gravity=False)
    assert "m/s2: gravity does not tell" in " ".join(found.assumed)


def test_acceleration_without_gravity_whose_unit_its_name_says(tmp_path, capsys):
    """A phone's linear acceleration was taken for an accelerometer that lies on its faces."""
    rng = np.random.default_rng(12)
    values = rng.normal(0, 0.05, (ROWS, 3)) + [0.02, 0.0, 0.3]
    names = ",".join("Linear Acceleration %s (m/s^2)" % axis for axis in "xyz")
    text = table(["%.2f" % t for t in SECONDS], accel=values, form="%.9f").replace(
        "ax,ay,az", names)
    told = refused(tmp_path, capsys, text)
    assert "gravity has been taken out" in told and "--units m/s2" in told
    (tmp_path / "in.csv").write_text(text)
    capture, said = imported(tmp_path, capsys, text, "--units", "m/s2")
    assert "gravity has been taken out" in said
    assert capture.pose is None or not capture.pose.any()


def _of_a_hand(one_g):
    """(2000, 3) m/s2 at 100 Hz of a hand that waves to and fro, harder at times, with one_g m/s2
    of gravity in what turns with it by half a radian."""
    t = np.arange(2000) / 100
    hard = 0.3 + 4.0 * (np.sin(0.9 * t) > 0.6)
    wave = np.stack([np.sin(2 * np.pi * hz * t + hz) for hz in (1.3, 1.7, 2.3)], axis=1)
    lean = 0.5 * np.sin(2 * np.pi * 0.2 * t)
    up = np.stack([np.sin(lean), np.zeros(len(t)), np.cos(lean)], axis=1)
    return hard[:, None] * wave + one_g * up + np.random.default_rng(4).normal(0, 0.02, wave.shape)


def _text(values, names="ax,ay,az"):
    return table(["%.2f" % (k / 100) for k in range(len(values))], accel=values,
                 form="%.9f").replace("ax,ay,az", names)


def test_a_wave_of_the_hand_is_no_gravity_though_its_median_is_one(tmp_path, capsys):
    values = _of_a_hand(0.0)
    means = np.linalg.norm(values.reshape(-1, 20, 3).mean(axis=1), axis=1)
    text = _text(values / np.median(means))
    said = refused(tmp_path, capsys, text)
    assert "no part of it stays for seconds" in said and "expected the acceleration" in said
    found = open_recording.read(tmp_path / "in.csv", gravity=False)
    assert "the accelerometer is in g" in " ".join(found.assumed)
    said = imported(tmp_path, capsys, text, "--units", "m/s2")[1]
    assert "gravity has been taken out of it" in said


def test_a_wave_of_the_hand_with_gravity_is_taken(tmp_path, capsys):
    assert "is in m/s2: |a| is" in imported(tmp_path, capsys, _text(_of_a_hand(G)))[1]


@pytest.mark.parametrize("names", ["ax [g],ay [g],az [g]", "ax,ay,az"])
def test_what_is_shaken_hard_and_what_tumbles_has_gravity(tmp_path, capsys, names):
    rng = np.random.default_rng(5)
    size = 2.6 if "[g]" in names else 0.3
    shaken = rng.normal([0.0, 0.0, 1.0], size, (2000, 3))
    assert "gravity" not in imported(tmp_path, capsys, _text(shaken, names))[1]
    angle = 2 * np.pi * 1.3 * np.arange(2000) / 100
    tumbles = np.stack([np.sin(angle), np.cos(angle), 0 * angle], axis=1)
    tumbles = tumbles + rng.normal(0.0, 0.1, tumbles.shape)
    (tmp_path / "out.csv").unlink()
    assert "gravity" not in imported(tmp_path, capsys, _text(tumbles, names))[1]
