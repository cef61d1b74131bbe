"""Rows that a FIFO or a driver hands over in another order, and what only looks like that."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import damage_taken_out

RATE = 200.0
META = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 8192.0,
        "gyro_lsb_per_dps": 65.5}


def readings(seed=3, seconds=120.0):
    """(n, 6) counts of a box that swings for four seconds and rests for four, by turns."""
    generator = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE)
    moves = np.sin(np.pi * np.clip(t % 8.0 / 4.0, 0.0, 1.0)) ** 2
    swing = sum(generator.normal(size=6) * np.sin(
        2.0 * np.pi * hz * t[:, None] + generator.uniform(0.0, 6.0, 6)) for hz in (0.4, 0.9, 1.7))
    true = moves[:, None] * swing * 2500.0 + [0, 0, 8192, 5, -9, 20]
    return true + generator.normal(0.0, [30.0] * 3 + [4.0] * 3, true.shape)


def capture(x, rows=None):
    x = np.rint(x if rows is None else x[rows]).clip(-32768, 32767).astype(np.int16)
    return Capture(META, np.rint(np.arange(len(x)) * 1e6 / RATE).astype(np.int64), x[:, :3],
                   x[:, 3:])


def out_of_order(number, length, way, share, seed=5):
    """(number,) rows of which that share lie in blocks of a length that were exchanged with the
    next, or reversed."""
    generator = np.random.default_rng(seed)
    rows = np.arange(number).reshape(-1, 2 * length)
    for k in np.flatnonzero(generator.random(len(rows)) < share):
        row = rows[k].copy()
        rows[k] = np.roll(row, length) if way == "exchanged" else row[::-1]
    return rows.ravel()


def said(x, rows=None):
    captures, damages = damage_taken_out.taken_out([("log", capture(x, rows))])
    return captures[0][1], damages


@pytest.mark.parametrize("way, length, block", [
    ("exchanged", 8, 8), ("exchanged", 16, 16), ("exchanged", 1, 1), ("reversed", 4, 8)])
def test_rows_out_of_order_are_told_and_put_right(way, length, block):
    x = readings()
    rows = out_of_order(len(x), length, way, 0.1)
    ordered, damages = said(x, rows)
    damage, = [one for one in damages if one.kind == "row order"]
    assert damage.sensor == "device" and damage.value["block"] == block
    assert 0.07 < damage.value["share"] < 0.14
    assert ("exchanged" if way == "exchanged" else "reversed") in damage.words
    right = (ordered.gyro == capture(x).gyro).all(axis=1)
    out = rows != np.arange(len(x))
    assert right[~out].mean() > 0.99 and right[out].mean() > 0.2  # the others lie at rest


@pytest.mark.parametrize("what", ["as it was", "knocks", "a line", "spikes", "repeated rows"])
def test_what_is_in_order_stays_so(what):
    """Knocks of a walk leap there and back within any number of rows; shaking at a quarter of the
    rate goes up and down in blocks of two."""
    x, generator = readings(), np.random.default_rng(9)
    n, rows = np.arange(len(x)), None
    if what == "knocks":
        for start in range(200, len(x) - 200, 110):
            ring = np.arange(60)
            x[start:start + 60] += generator.normal(0.0, 4000.0, 6) * (np.exp(
                -ring / 8.0) * np.sin(ring * generator.uniform(0.3, 1.5)))[:, None]
    if what == "a line":
        swell = 1.0 + np.sin(2.0 * np.pi * n / 730.0)
        x += (swell * np.sin(2.0 * np.pi * 0.2503 * n))[:, None] * 300.0
    if what == "spikes":
        x[generator.random(len(x)) < 0.02] += 5000.0
    if what == "repeated rows":
        rows = np.sort(np.append(n, n[generator.random(len(x)) < 0.04]))
    assert [one.kind for one in said(x, rows)[1] if one.kind == "row order"] == []
