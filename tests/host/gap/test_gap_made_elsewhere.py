"""What captures made elsewhere showed: claims that were false, each with what it is told from."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture import registers
from sixflip_host.diagnosis import verdict, wandering
from sixflip_host.diagnosis.detect import dead_band, held_values, noise_bursts, torn_reads
from sixflip_host.diagnosis.detect.detection import present
from sixflip_host.diagnosis.holdout_gain import Shrinkage


def swinging(number, noise, generator, counts=8000.0):
    """(number,) counts of what a hand turns to and fro, about 0 and about other levels."""
    t = np.arange(number) / 100.0
    return counts * np.sin(1.3 * t + 2.0 * np.sin(0.37 * t)) + noise * generator.standard_normal(
        number)


def test_tails_of_noise_are_no_spikes():
    generator = np.random.default_rng(3)
    assert not present(noise_bursts.jump_nats(np.abs(generator.standard_t(6.0, 60000))))
    sizes = np.abs(generator.standard_normal(60000))
    sizes[::500] += 8.0
    assert present(noise_bursts.jump_nats(sizes))


@pytest.mark.parametrize("band", [0, 40, 400])
def test_a_band_that_what_is_beyond_it_begins_at_0_of(band):
    """No code is missing, so it was no dead band but a cubic."""
    generator = np.random.default_rng(5)
    true = swinging(20000, 25.0, generator)
    read = np.rint(np.sign(true) * np.maximum(np.abs(true) - band, 0.0))
    found = dead_band.of_columns([read[:10000], read[10000:]])
    assert present(found.nats) == (band > 0)
    if band:
        assert found.counts == pytest.approx(band, rel=0.15)


def test_a_band_narrower_than_the_noise_shows_in_how_often_0_is_read():
    generator = np.random.default_rng(6)
    rests = np.repeat(np.concatenate([np.linspace(-40.0, 40.0, 20), [16000.0] * 10]), 500)
    true = rests + 60.0 * generator.standard_normal(len(rests))
    read = np.rint(np.sign(true) * np.maximum(np.abs(true) - 16.0, 0.0))
    assert registers.dead_band(np.rint(true)[:, None])[0] == 0
    assert registers.dead_band(read[:, None])[0] == pytest.approx(16, abs=3)


def test_a_gait_that_knocks_has_no_torn_reads():
    """Jumps of about 256 counts that legs and wheels make were bytes of two readings."""
    generator = np.random.default_rng(7)
    counts = np.stack([swinging(15000, 4.0, generator, 3000.0) for _ in range(3)], 1)
    smooth, knocks = counts, generator.random(counts.shape) < 0.01
    counts = counts + knocks * 250.0 * generator.standard_t(3.0, counts.shape)

    def found(values):
        session = SimpleNamespace(
            at_rest=np.zeros(len(values), bool),
            capture=SimpleNamespace(gyro=np.rint(values).astype(np.int16), meta={}))
        return torn_reads.finding([session], "gyro")
    assert found(counts) == []
    whole = np.rint(counts - knocks * (counts - smooth)).astype(np.int64)
    torn = whole.copy()
    hit = np.flatnonzero((whole[1:] // 256 != whole[:-1] // 256).any(axis=1)) + 1
    hit = hit[generator.random(len(hit)) < 0.05]
    torn[hit] = whole[hit - 1] // 256 * 256 + whole[hit] % 256
    assert [f.effect for f in found(torn)] == ["torn_reads"]


def test_rows_read_again_while_the_box_turns_are_counted():
    generator = np.random.default_rng(8)
    counts = np.rint(np.stack([swinging(12000, 4.0, generator) for _ in range(3)], 1))
    assert held_values.read_again(counts)[1] == 0.0
    again = np.arange(50, len(counts), 400)
    counts[again] = counts[again - 1]
    nats, rows = held_values.read_again(counts)
    assert present(nats) and rows == pytest.approx(len(again), rel=0.3)


def test_coarse_noise_repeats_rows_by_chance():
    """Of a sensor that moves and rests in one stretch all three axes repeat together."""
    generator = np.random.default_rng(9)
    slow = np.cumsum(generator.standard_normal((30000, 3)), axis=0) * 0.02
    moves = np.repeat(generator.random(300) < 0.4, 100)[:, None] * np.cumsum(
        generator.standard_normal((30000, 3)), axis=0)
    counts = np.rint(slow + moves + 0.8 * generator.standard_normal((30000, 3)))
    assert not present(held_values.read_again(counts)[0])


def test_what_leaps_between_levels_is_no_walk():
    generator = np.random.default_rng(10)
    noise = 4.0 * generator.standard_normal(90000)
    walk = noise + 0.02 * np.cumsum(generator.standard_normal(90000))
    telegraph = noise + 3.0 * (np.cumsum(generator.random(90000) < 1.0 / 6000.0) % 2)
    assert wandering.jumps([walk], 100.0) == 1.0
    assert wandering.jumps([telegraph], 100.0) < 1e-6


def test_a_gap_that_hardly_closes_is_not_explained():
    """A tenth of what the readings showed went with what was named, and all was explained."""
    named = [verdict.Claim(0.99, True)]
    for interval, said in (((0.1, 0.25), "partly explained"), ((0.7, 1.0), "explained")):
        left = verdict.not_closed(Shrinkage(4.0, 3.7, 1.0, 0.2, interval))
        assert verdict.of(named, [left], True) == said
