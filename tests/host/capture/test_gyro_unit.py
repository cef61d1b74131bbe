"""A gyro whose unit nobody said: deg/s and rad/s are two hypotheses, weighed by what each would
make of the readings."""

import numpy as np
import pytest

from tests.worlds.imported_text import G, imported, table

RATE = 100


def resting(seed, seconds=30):
    """(accel in m/s2, gyro in deg/s) of a board that lies still: a bias and noise of a part."""
    noise = np.random.default_rng(seed).normal(size=(seconds * RATE, 6))
    return (np.array([0.3, -0.2, G]) + 0.01 * noise[:, :3],
            np.array([3.0, -1.1, 0.9]) + 0.05 * noise[:, 3:])


def flying(seed, seconds=30):
    """(accel in m/s2, gyro in deg/s) of a robot that flies: the accelerometer reads its thrust and
    shakes, and turns by nothing that the gyro reads."""
    rng = np.random.default_rng(seed)
    smooth = np.exp(-0.5 * np.linspace(-3, 3, 41) ** 2)
    rate = np.stack([np.convolve(x, smooth, "same") for x in rng.normal(
        0, 25, (3, seconds * RATE))], axis=1)
    return np.array([0.0, 0.0, G]) + rng.normal(0, 2.0, (seconds * RATE, 3)), rate


def said_of(tmp_path, capsys, accel, gyro, *words):
    times = ["%.2f" % (k / RATE) for k in range(len(accel))]
    (tmp_path / "out.csv").unlink(missing_ok=True)
    return imported(tmp_path, capsys, table(times, accel=accel, gyro=gyro, form="%.9f"), *words)


@pytest.mark.parametrize("motion, why", [
    (resting, "in rad/s it would rest at 18"),
    (flying, "in rad/s it would turn at")])
def test_deg_s_beside_m_s2_is_told_without_a_turn_of_gravity(tmp_path, capsys, motion, why):
    accel, gyro = motion(2)
    capture, said = said_of(tmp_path, capsys, accel, gyro)
    assert "the gyro is in dps: " + why in said
    counts = capture.gyro / capture.meta["gyro_lsb_per_dps"]
    assert np.abs(counts.mean(axis=0) - gyro.mean(axis=0)).max() < 0.01


@pytest.mark.parametrize("motion", [resting, flying])
@pytest.mark.parametrize("seed", [3, 4])
def test_rad_s_beside_m_s2_stays(tmp_path, capsys, motion, seed):
    accel, gyro = motion(seed)
    _, said = said_of(tmp_path, capsys, accel, np.radians(gyro))
    assert "the gyro is in rad/s, as goes with m/s2" in said


def test_what_was_said_stays_said(tmp_path, capsys):
    capture, said = said_of(tmp_path, capsys, *flying(5), "--units", "si")
    assert "the gyro is in" not in said
