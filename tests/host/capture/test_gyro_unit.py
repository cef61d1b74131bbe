"""A gyro whose unit nobody said: deg/s and rad/s are two hypotheses, weighed by what each would
make of the readings."""

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.capture.imports import gyro_unit
from sixflip_host.diagnosis.detect import wrong_scale
from sixflip_host.experiment import blocks
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


def carried(seed, seconds=30, accelerated=0.15):
    """(accel in g, gyro in deg/s) of a phone that is swung by a hand, which accelerates it as far
    as gravity turns in it."""
    rng = np.random.default_rng(seed)
    t = np.arange(seconds * RATE) / RATE
    tilts, rates = [], []
    for hz in (0.9, 1.7):
        phase, size = rng.uniform(0, 6.28), rng.uniform(0.1, 0.2)
        tilts.append(size * np.sin(2 * np.pi * hz * t + phase))
        rates.append(np.degrees(size * 2 * np.pi * hz * np.cos(2 * np.pi * hz * t + phase)))
    roll, pitch = tilts
    up = np.stack([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)], 1)
    swung = np.stack([np.sin(2 * np.pi * hz * t) for hz in rng.uniform(1.5, 2.5, 3)], axis=1)
    rate = np.stack([rates[0], rates[1] * np.cos(roll), -rates[1] * np.sin(roll)], axis=1)
    return (up + accelerated * swung + rng.normal(0, 0.003, up.shape),
            rate + rng.normal(0, 0.1, up.shape))


@pytest.mark.parametrize("accelerated, doubted", [(0.15, False), (0.8, True)])
def test_rad_s_beside_g_is_told_of_what_a_hand_swings(tmp_path, capsys, accelerated, doubted):
    accel, gyro = carried(6, 20, accelerated)
    _, said = said_of(tmp_path, capsys, accel, np.radians(gyro), "--units", "g,")
    assert "the gyro is in rad/s: " in said
    assert ("--units ,dps takes it so" in said) == doubted


@pytest.mark.parametrize("accelerated", [0.15, 0.8])
def test_deg_s_beside_g_stays_of_what_a_hand_swings(tmp_path, capsys, accelerated):
    _, said = said_of(tmp_path, capsys, *carried(7, 20, accelerated), "--units", "g,")
    assert "the gyro is in dps, as goes with g\n" in said


@pytest.mark.parametrize("accelerated, told", [(0.15, True), (0.8, False)])
def test_a_header_in_deg_s_of_a_gyro_in_rad_s_is_told(accelerated, told):
    accel, gyro = carried(8, 20, accelerated)
    meta = {"rate_hz": RATE, "accel_lsb_per_g": 8192.0, "gyro_lsb_per_dps": 6000.0}
    capture = Capture(meta, np.arange(len(accel)) * 1_000_000 // RATE,
                      np.rint(accel * 8192).astype(np.int16),
                      np.rint(np.radians(gyro) * 6000).astype(np.int16))
    session = blocks.session_of("one", capture)
    assert [d.value for d in wrong_scale.findings([session])] == [{"factor": 0.0175}] * told
    assert "the gyro is in rad/s and not in the deg/s" in gyro_unit.doubt([capture])[0]
