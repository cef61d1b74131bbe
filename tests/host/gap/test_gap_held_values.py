"""Values that are held: sensors read faster than they measure, axes that are stuck."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import held_values, stuck_axes
from sixflip_host.diagnosis.detect.detection import present


def test_coarse_noise_repeats_rows_by_chance():
    """Of a sensor that moves and rests in one stretch all three axes repeat together."""
    generator = np.random.default_rng(9)
    slow = np.cumsum(generator.standard_normal((30000, 3)), axis=0) * 0.02
    moves = np.repeat(generator.random(300) < 0.4, 100)[:, None] * np.cumsum(
        generator.standard_normal((30000, 3)), axis=0)
    counts = np.rint(slow + moves + 0.8 * generator.standard_normal((30000, 3)))
    assert not present(held_values.read_again(counts)[0])


def test_a_quiet_sensor_that_rests_and_moves_repeats_rows_by_chance():
    """Noise of a third of a count repeats in most rows at rest and in none on the way: a stretch
    of both has a chance of its own for each, and what all axes share is no holding."""
    generator = np.random.default_rng(12)
    moving = np.repeat(np.arange(80) % 2 == 1, 150)
    turned = np.where(moving, 300.0, 0.0)[:, None] * generator.standard_normal((12000, 3))
    counts = np.rint(turned + [0.1, -0.2, 0.15] + 0.35 * generator.standard_normal((12000, 3)))
    assert not present(held_values.repeats(counts)[0])
    held = np.arange(1, len(counts), 5)
    counts[held] = counts[held - 1]
    nats, rows, every = held_values.repeats(counts)
    assert present(nats) and rows / every == pytest.approx(0.2, rel=0.2)


def test_rests_of_a_few_rows_hold_nothing():
    """Ten rows a second of an ADXL345, noise of a third of a count: rests of six seconds and moves
    of three are neighbours, and in the rests all axes repeat."""
    generator = np.random.default_rng(15)
    said = []
    for _ in range(6):
        levels = np.repeat(generator.uniform(-250.0, 250.0, (25, 3)), 90, axis=0)
        ramp = np.minimum(np.arange(2250) % 90 / 30.0, 1.0)[:, None]
        x = np.roll(levels, 90, axis=0) * (1.0 - ramp) + levels * ramp
        counts = np.rint(x + 0.32 * generator.standard_normal((2250, 3))).astype(np.int16)
        said.append(held_values.repeats(counts)[0])
        held = counts[np.maximum.accumulate(np.where(generator.random(2250) < 0.2, 0,
                                                     np.arange(2250)))]
        assert present(held_values.repeats(held)[0])
    assert not any(map(present, said))


def test_a_coarse_sensor_that_moves_in_bursts_holds_nothing():
    """Eight bits, noise of an eighth of a count: two rows in five repeat, all axes together."""
    generator = np.random.default_rng(1)
    moves = np.repeat(generator.random(160) < 0.5, 100).astype(float)
    moves = np.convolve(moves, np.hanning(100) / np.hanning(100).sum(), "same")[:, None]
    course = np.cumsum(0.3 * moves * generator.standard_normal((16000, 3)), axis=0)
    x = course + [0.2, -0.3, 64.1] + (0.12 + 1.5 * moves) * generator.standard_normal((16000, 3))
    counts = np.rint(x).astype(np.int16)
    assert (counts[1:] == counts[:-1]).all(axis=1).mean() > 0.2
    def said(accel):
        capture = SimpleNamespace(accel=accel, gyro=None)
        return [d.value for d in held_values.findings([SimpleNamespace(capture=capture)])]
    assert said(counts) == []
    twice, = said(np.repeat(counts[::2], 2, axis=0))
    assert twice["times"] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize("times", [3, 10, 25])
def test_readings_that_are_given_many_times_are_held(times):
    """A firmware that averages so many and sends the mean for each of them: ten times was longer
    than any log is read faster than its sensor, and taken for rest."""
    generator = np.random.default_rng(5)
    turned = 900.0 * np.sin(np.arange(9000) / 300.0) * (np.arange(9000) % 3000 > 2000)
    counts = np.rint(turned[:, None] + generator.normal(0.0, 5.0, (9000, 3))).astype(np.int16)
    held = np.repeat(counts[::times], times, axis=0)[:9000]
    capture = SimpleNamespace(accel=held, gyro=counts)
    found, = held_values.findings([SimpleNamespace(capture=capture)])
    assert (found.kind, found.sensor) == ("repeats", "accel")
    assert found.value["times"] == pytest.approx(times, rel=0.02)


@pytest.mark.parametrize("stands", [(10, 40), (20, 60), (200, 201), (150, 151)])
def test_what_stands_still_between_its_steps_is_read_as_fast_as_it_measures(stands):
    """Eight bits without noise, in a robot that goes from place to place within a row."""
    generator = np.random.default_rng(7)
    places = np.rint(generator.uniform(-60.0, 60.0, (40, 3)))
    counts = np.repeat(places, generator.integers(*stands, 40), axis=0).astype(np.int16)
    capture = SimpleNamespace(accel=counts, gyro=None)
    assert held_values.findings([SimpleNamespace(capture=capture)]) == []


def frozen(times, noise=4.0):
    """Capture of a sensor that turns now and then, whose six registers keep their values for half
    a second so many times; and the rows in which they do."""
    generator = np.random.default_rng(21)
    turned = 300.0 * np.sin(np.arange(8000) / 90.0) * (np.arange(8000) % 2000 > 900)
    counts = np.rint(turned[:, None] + generator.normal(0.0, noise, (8000, 6))).astype(np.int16)
    first = 50 * np.sort(generator.choice(150, times, replace=False))
    rows = (first[:, None] + np.arange(1, 50)).ravel()
    for row in rows:
        counts[row] = counts[row - 1]
    return Capture({"sensor": "other", "rate_hz": 100.0}, 10_000 * np.arange(8000),
                   counts[:, :3], counts[:, 3:]), rows


def test_registers_that_keep_their_values_for_a_while_were_not_read():
    """From eight rows on they were taken for a rest without noise, and beside the holes in the
    turns a gyro's asymmetry was named."""
    capture, rows = frozen(12)
    ((_, read),), (damage,) = held_values.as_read([("one", capture)])
    assert len(read) == len(capture) - len(rows) and len(capture) == 8000
    assert np.array_equal(read.t_us, np.delete(capture.t_us, rows))
    assert damage.kind == held_values.NOT_READ and damage.value == {"rows": len(rows)}


def test_what_has_no_noise_at_rest_was_read_there():
    """Ten rests in which nothing changes, and moves with noise on them."""
    capture, _ = frozen(0)
    resting = np.arange(8000) % 800 < 600
    first = np.maximum.accumulate(np.where(resting & (np.arange(8000) % 800 == 0),
                                           np.arange(8000), 0))
    for counts in (capture.accel, capture.gyro):
        counts[resting] = counts[first[resting]]
    read, damages = held_values.as_read([("one", capture)])
    assert len(read[0][1]) == 8000 and not damages


def test_what_stands_still_twice_was_read():
    capture, _ = frozen(2)
    read, damages = held_values.as_read([("one", capture)])
    assert len(read[0][1]) == 8000 and not damages


def test_an_axis_that_keeps_its_value_while_the_others_change_is_stuck():
    """Runs of 5 to 40 rows, one row in fifty, were no gap."""
    generator = np.random.default_rng(3)
    turned = 300.0 * np.sin(np.arange(8000) / 90.0) * (np.arange(8000) % 2000 > 900)
    counts = np.rint(turned[:, None] + generator.normal(0.0, 3.0, (8000, 3))).astype(np.int16)

    def said(gyro):
        capture = SimpleNamespace(accel=None, gyro=gyro)
        return [(d.axes, d.value["rows"]) for d in stuck_axes.stuck_for_a_while(
            [SimpleNamespace(capture=capture)])]
    assert said(counts) == []
    for first in range(500, 8000, 1000):
        counts[first:first + 20, 1] = counts[first, 1]
    (axes, rows), = said(counts)
    assert axes == ("y",) and rows == pytest.approx(20, abs=2)


def test_an_axis_that_is_stuck_for_minutes_says_nothing_of_its_rests():
    """Its own quiet hid it: the noise of the quietest tenth was that of what is stuck."""
    generator = np.random.default_rng(4)
    counts = np.rint(generator.normal(40.0, 3.0, (8000, 3))).astype(np.int16)
    counts[4000:5500, 2] = counts[4000, 2]
    session = SimpleNamespace(capture=SimpleNamespace(accel=None, gyro=counts))
    damage, = stuck_axes.stuck_for_a_while([session])
    assert damage.axes == ("z",)
    rows = stuck_axes.stuck_rows(session, [damage])
    assert rows[4000:5500].mean() > 0.95 and rows[:4000].mean() < 0.02  # three alike by chance
    for first in (1000, 2000, 6000):  # a gate about the bias comes back to the same code
        counts[first:first + 500, 1] = 41
    damage, = stuck_axes.stuck_for_a_while([session])
    assert damage.axes == ("z",)


def test_blocks_that_come_again_later_are_said():
    """A quarter of the samples were old ones, and no gap."""
    generator = np.random.default_rng(5)
    counts = np.rint(np.cumsum(generator.normal(0.0, 2.0, (8000, 3)), axis=0)
                     + generator.normal(0.0, 6.0, (8000, 3))).astype(np.int16)

    def said(accel):
        capture = SimpleNamespace(accel=accel, gyro=None)
        return [d.value for d in held_values.findings([SimpleNamespace(capture=capture)])]
    assert said(counts) == []
    stale = counts.reshape(-1, 40, 3).copy()
    stale[:, 30:] = stale[:, :10]
    assert said(stale.reshape(-1, 3)) == [{"rows": 1999, "later": 30}]


@pytest.mark.parametrize("noise", [0.0, 0.2, 0.4, 0.8, 1.5])
@pytest.mark.parametrize("wave, period", [(0.0, 1.0), (3.0, 25.0), (500.0, 20.0), (2000.0, 20.0)])
def test_coarse_or_periodic_readings_come_again_at_every_distance(noise, wave, period):
    generator = np.random.default_rng(6)
    x = wave * np.sin(2.0 * np.pi * np.arange(20000) / period)[:, None] + [0.1, 0.4, 64.2]
    counts = np.rint(x + noise * generator.standard_normal((20000, 3))).astype(np.int16)
    assert not present(held_values.again_later([counts])[0])


@pytest.mark.parametrize("lag", [3, 4, 150, 300])
def test_blocks_of_any_length_that_a_fifo_has_are_seen(lag):
    counts = np.random.default_rng(7).normal(0.0, 20.0, (12000, 3)).astype(np.int16)
    blocks = counts[:12000 // (3 * lag) * 3 * lag].reshape(-1, 3 * lag, 3)
    blocks[:, lag:2 * lag] = blocks[:, :lag]
    nats, later, _ = held_values.again_later([blocks.reshape(-1, 3)])
    assert present(nats) and later == lag


@pytest.mark.parametrize("every", [25.6, 60.3])
def test_a_chip_read_a_little_faster_than_it_measures_repeats_rows_at_regular_times(every):
    """320 Hz read at 333: of 1963 such rows 20 were counted by the accelerometer and 425 by the
    gyro, and the log was called unexplained."""
    generator = np.random.default_rng(8)
    new = np.floor(np.arange(20000) * (1.0 - 1.0 / every)).astype(int)
    swing = 3000.0 * np.sin(np.arange(20000) / 90.0)[:, None] * np.array([1.0, 0.4, -0.7])
    accel, gyro = (np.rint(swing + generator.normal(0.0, noise, (20000, 3))).astype(np.int16)[new]
                   for noise in (30.0, 4.0))
    meta = {"sensor": "mpu6050", "rate_hz": 333.0, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 65.5}
    capture = Capture(meta, np.arange(20000) * 3003, accel, gyro)
    repeated = int((np.diff(new) == 0).sum())
    (_, read), = held_values.as_read([("log", capture)])[0]
    damage, = held_values.as_read([("log", capture)])[1]
    assert damage.sensor == "device" and damage.value["rows"] == repeated
    assert "one in %.1f" % (20000 / repeated) in damage.words
    assert len(read) == 20000 - repeated
    assert held_values.findings([SimpleNamespace(capture=read)]) == []


def test_a_sensor_is_read_so_many_times_as_fast_as_the_file_has_rows():
    """Read at 600 Hz, of which a gyro measures every second and an accelerometer every fourth:
    the rows that neither was read in are told, and the accelerometer's were 2 times of what is
    left of them then."""
    generator = np.random.default_rng(9)
    accel, gyro = (np.repeat(np.rint(generator.normal(0.0, 40.0, (16000 // times, 3))), times,
                             axis=0).astype(np.int16) for times in (4, 2))
    meta = {"sensor": "other", "rate_hz": 600.0, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 65.5}
    capture = Capture(meta, 1667 * np.arange(16000), accel, gyro)
    capture = held_values.without_rows(capture, np.arange(1, 16000, 2))
    damage, = held_values.findings([SimpleNamespace(capture=capture)])
    assert damage.sensor == "accel" and "each value four times" in damage.words


def test_one_axis_that_is_measured_less_often_gives_each_value_twice():
    """Its chip's other axes go on: no row repeats, and no value stays for long. What creeps by a
    count in every other row is not held, nor does an axis that is read at random times give its
    values equally often."""
    generator = np.random.default_rng(31)
    level = np.cumsum(generator.standard_normal((8000, 3)), axis=0)
    counts = np.rint(level + 10.0 * generator.standard_normal((8000, 3))).astype(np.int16)

    def slower(values):
        return [(d.sensor, d.axes, d.value["times"]) for d in stuck_axes.read_slower(
            [SimpleNamespace(capture=SimpleNamespace(accel=values, gyro=counts))])]

    assert slower(counts) == []
    for times in (2, 4):
        held = counts.copy()
        held[:, 2] = counts[np.arange(8000) // times * times, 2]
        assert slower(held) == [("accel", ("z",), times)]
    at_random = counts.copy()
    now = np.maximum.accumulate(np.where(generator.random(8000) < 0.5, np.arange(8000), 0))
    at_random[:, 2] = counts[now, 2]
    creeps = counts.copy()
    creeps[:, 2] = np.arange(8000) // 2
    assert slower(at_random) == slower(creeps) == []
