"""Rows that a FIFO or a driver hands over in another order, and what only looks like that."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import samples_judged
from sixflip_host.diagnosis.detect import held_values, row_order

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
    captures, damages = samples_judged.without_damage([("log", capture(x, rows))])
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


def disordered(x):
    """Where rows are said to be out of order."""
    return [one for one in said(x)[1] if one.kind == "row order"]


@pytest.mark.parametrize("turns, rests", [(25, 25), (10, 40), (30, 30)])
def test_a_machine_that_does_the_same_again_is_in_order(turns, rests):
    """A run that is reversed from a leap to the next of its kind ends as it began."""
    n = np.arange(6000)
    x = np.random.default_rng(0).normal(0.0, [30.0] * 3 + [5.0] * 3, (len(n), 6))
    x[:, 5] += 2000.0 * (n % (turns + rests) < turns)
    x[:, 0] += 8.0 * np.gradient(x[:, 5]) / 65.5
    assert disordered(x) == []


def test_a_buffer_that_was_handed_over_twice_is_not_reversed():
    """Reversed, its last row stands beside itself; it is told as what it is."""
    x = readings()
    for start in range(100, len(x) - 100, 173):
        x[start + 8:start + 16] = x[start:start + 8]
    ordered, damages = said(x)
    assert damages == [] and (ordered.gyro == capture(x).gyro).all()
    nats, later, _ = held_values.again_later([ordered.gyro])
    assert nats > 100.0 and later == 8


def test_rows_that_are_read_twice_and_reversed_are_put_right():
    """A log that is read twice as fast as it measures has a row beside itself everywhere."""
    x = np.repeat(readings(), 2, axis=0)[1:-7]
    damage, = disordered(x[out_of_order(len(x), 4, "reversed", 0.1)])
    assert damage.value["block"] == 8 and "reversed" in damage.words


def test_all_captures_are_told_of():
    whole = [capture(readings(seed, 240.0)) for seed in (3, 4)]
    swapped = [capture(readings(seed), out_of_order(24000, 8, "exchanged", share))
               for seed, share in ((3, 0.1), (4, 0.2))]
    each = [row_order.as_read([("", one)])[1][0] for one in swapped]
    both, = row_order.as_read(list(enumerate([whole[0], *swapped, whole[1]])))[1]
    assert both.score == pytest.approx(sum(one.score for one in each))
    assert both.value["rows"] == sum(one.value["rows"] for one in each)
    assert both.value["share"] == pytest.approx(sum(
        one.value["share"] for one in each) / 6.0, rel=0.01)


def test_all_of_a_long_log_is_put_right_and_what_is_read_with_it(monkeypatch):
    """A habit of the first rows is that of the others, also where a block begins in one piece and
    ends in the next; the temperature comes out of the same buffer."""
    rows = out_of_order(24000, 8, "exchanged", 0.2)
    rows[9992:10008] = np.append(np.arange(10000, 10008), np.arange(9992, 10000))
    x, log = readings(), capture(readings(), rows)
    log.temp = log.mag = rows.astype(np.int16)
    monkeypatch.setattr(row_order, "ROWS", 10_000)
    (_, ordered), = row_order.as_read([("", log)])[0]
    right = (np.hstack([ordered.accel, ordered.gyro]) == np.hstack(
        [capture(x).accel, capture(x).gyro])).all(axis=1)
    out = rows != np.arange(len(x))
    assert right[~out].mean() > 0.99 and right[9992:10008].all()
    for piece in (slice(0, 10000), slice(10000, 20000), slice(20000, 24000)):
        assert right[piece][out[piece]].mean() > 0.2  # the others lie at rest
    assert (ordered.temp[right] == np.flatnonzero(right)).all()
    assert (ordered.mag == ordered.temp).all() and (ordered.t_us == log.t_us).all()
