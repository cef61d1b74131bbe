"""What captures made elsewhere showed: claims that were false, each with what it is told from."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal
from scipy.signal import lfilter

from sixflip_host.diagnosis import leaps, odds, samples_judged
from sixflip_host.diagnosis.detect import (
    dead_band,
    held_values,
    rest_spectra,
    sample_neighbours,
    spectral_lines,
    spikes,
    torn_reads,
)
from sixflip_host.diagnosis.detect.detection import Finding, present
from sixflip_host.experiment import blocks
from tests.worlds.still_session import at_rest, flicker


def swinging(number, noise, generator, counts=8000.0):
    """(number,) counts of what a hand turns to and fro, about 0 and about other levels."""
    t = np.arange(number) / 100.0
    return counts * np.sin(1.3 * t + 2.0 * np.sin(0.37 * t)) + noise * generator.standard_normal(
        number)


def test_tails_of_noise_are_no_spikes():
    generator = np.random.default_rng(3)
    assert not present(spikes.jump_nats(np.abs(generator.standard_t(6.0, 60000))))
    louder = generator.standard_normal(60000) * np.where(np.arange(60000) % 1000 < 200, 3.0, 1.0)
    assert not present(spikes.jump_nats(np.abs(louder)))
    sizes = np.abs(generator.standard_normal(60000))
    sizes[::500] += 8.0
    assert present(spikes.jump_nats(sizes))


@pytest.mark.parametrize("all_the_time", [True, False])
def test_jumps_of_a_page_in_noise_of_a_fifth_of_it_are_spikes(all_the_time):
    """256 counts in one of a hundred samples of an MPU6050, whose noise is 46: heavy tails of
    noise had as many as far off. What shakes for a second has, too."""
    still, generator = at_rest(flicker(5, 12000)), np.random.default_rng(6)
    hit = generator.random((12000, 2)) < 0.012
    if not all_the_time:
        hit[:] = False
        hit[3000:3100:3], hit[7000:7100:3] = True, True
    still.capture.accel[:, :2] += np.where(hit, 256 * generator.choice([-1, 1], hit.shape),
                                           0).astype(np.int16)
    said = [sensor for sensor, *_ in spikes.without_spikes([still])[1]]
    assert said == (["accel"] if all_the_time else [])


def test_samples_far_off_that_come_in_pairs_are_spikes():
    """Of a buffer's two oldest rows: each had one beside it that did not agree, and what they did
    to the means was the rectification of a vibration."""
    still = at_rest(flicker(5, 12000))
    for first in range(40, 12000, 128):
        still.capture.accel[first:first + 2, 2] = -200
    (right,), found = spikes.without_spikes([still])
    assert [sensor for sensor, *_ in found] == ["accel"]
    assert np.abs(right.accel[:, 2] - 1000.0).max() < 2.0  # mg


def test_touches_that_ring_are_no_spikes():
    """Each rings for a tenth of a second, ten deviations high: one sample of each was a spike."""
    still, t = at_rest(flicker(5, 12000)), np.arange(12) / 100.0
    for first in range(900, 12000, 950):
        still.capture.accel[first:first + 12, 2] += np.rint(
            460.0 * np.exp(-t / 0.03) * np.sin(2.0 * np.pi * 17.0 * t)).astype(np.int16)
    assert spikes.without_spikes([still])[1] == []


@pytest.mark.parametrize("band", [0, 40, 400])
def test_a_band_that_what_is_beyond_it_begins_at_0_of(band):
    """No code is missing, so it was no dead band but a cubic."""
    generator = np.random.default_rng(5)
    true = swinging(20000, 25.0, generator)
    read = np.rint(np.sign(true) * np.maximum(np.abs(true) - band, 0.0))
    found = dead_band.band_of_columns([read[:10000], read[10000:]])
    assert present(found.nats) == (band > 0)
    if band:
        assert found.counts == pytest.approx(band, rel=0.15)


def test_a_band_narrower_than_the_noise_shows_in_how_often_0_is_read():
    generator = np.random.default_rng(6)
    rests = np.repeat(np.concatenate([np.linspace(-40.0, 40.0, 20), [16000.0] * 10]), 500)
    true = rests + 60.0 * generator.standard_normal(len(rests))
    read = np.rint(np.sign(true) * np.maximum(np.abs(true) - 16.0, 0.0))
    assert not present(dead_band.of_zeros(np.rint(true))[1])
    band, nats = dead_band.of_zeros(read)
    assert present(nats) and band == pytest.approx(16, abs=3)


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


def test_what_leaps_between_levels_is_no_walk():
    generator = np.random.default_rng(10)
    noise = 4.0 * generator.standard_normal(90000)
    walk = noise + 0.02 * np.cumsum(generator.standard_normal(90000))
    telegraph = noise + 3.0 * (np.cumsum(generator.random(90000) < 1.0 / 6000.0) % 2)
    assert leaps.jumps([walk], 100.0) == 1.0
    assert leaps.jumps([telegraph], 100.0) < 1e-6


def test_a_gap_that_hardly_closes_is_not_explained():
    """A tenth of what the readings showed went with what was named, and all was explained."""
    named = [odds.Claim(0.99, True)]
    for interval, said in (((0.1, 0.25), "partly explained"), ((0.7, 1.0), "explained")):
        left = odds.not_closed(interval)
        assert odds.decide(named, [left], True) == said


def test_a_spike_cuts_no_rest_in_two():
    """Where the poses are found, what spikes stood outside of every rest, and nothing was said."""
    generator = np.random.default_rng(4)
    still = at_rest(flicker(5, 6000)).capture
    still.pose = None
    spiked = generator.choice(np.arange(200, 5800), 60, replace=False)
    still.gyro = still.gyro.copy()
    still.gyro[spiked, 1] += np.int16(256)
    found = blocks.session_of("s", still)
    assert len(found.runs) == 1 and found.runs[0].end - found.runs[0].first > 5500
    assert still.gyro[spiked[0], 1] > 200  # the capture itself is as it was
    nats, number = torn_reads.paged(sample_neighbours.tabled(still.gyro[:, 1].astype(int), False))
    assert present(nats) and number == pytest.approx(60, abs=5)


def test_a_band_about_a_bias_is_a_dead_band():
    """What is gated about the bias reads the bias: 1.5 deg/s of a slow rover's yaw."""
    generator = np.random.default_rng(8)
    rate = 400.0 * np.sin(2.0 * np.pi * np.arange(20000) / 900.0) * (
        np.arange(20000) % 5000 > 2500) + generator.normal(0.0, 4.0, 20000)
    gated = np.where(np.abs(rate) < 86.0, 55.0, 55.0 + rate)
    others = generator.normal(20.0, 4.0, (20000, 2))
    counts = np.rint(np.column_stack([others, gated])).astype(np.int16)
    still = [np.arange(20000) % 5000 <= 2500]
    found, = dead_band.findings("gyro", [counts], still)
    assert found.axes == ["z"] and found.value["z"] == pytest.approx(86, abs=2)
    plain = np.rint(np.column_stack([others, 55.0 + rate])).astype(np.int16)
    assert dead_band.findings("gyro", [plain], still) == []


def test_an_axis_beside_one_that_leaps_has_no_dead_band():
    """Its sensor's noise was half that of what leaps by 256 counts now and then."""
    generator = np.random.default_rng(5)
    turned = 400.0 * np.sin(np.arange(8000) / 60.0) * (np.arange(8000) % 1000 > 800)
    counts = np.rint(turned[:, None] + generator.normal(0.0, 2.7, (8000, 3)) + [245.0, -4.0, 6.5])
    counts[generator.random(8000) < 0.07, 0] -= 256.0
    nats, _ = dead_band.nats_of_rests([counts], [np.arange(8000) % 1000 <= 800])
    assert not present(nats.max())


def test_slow_noise_in_a_few_rests_is_no_line():
    """Of a random walk held back within a second four rests made "vibration" of 1.3 Hz."""
    generator = np.random.default_rng(6)
    t = np.arange(520) / 100.0

    def lines(wave=0.0, seeds=12):
        found = 0
        for _ in range(seeds):
            slow = signal.lfilter([1.0], [1.0, -0.99], generator.standard_normal((4, 720)))
            x = 0.012 * slow[:, 200:] + 0.015 * generator.standard_normal((4, 520))
            x += wave * np.sin(2.0 * np.pi * 2.2 * t)
            counts = np.rint(x * 65.5).astype(np.int16)
            capture = SimpleNamespace(gyro=np.repeat(counts.reshape(-1, 1), 3, axis=1),
                                      meta={"gyro_lsb_per_dps": 65.5})
            rests = SimpleNamespace(capture=capture, rate=100.0, runs=[
                (0, first, first + 520) for first in range(0, 2080, 520)])
            found += spectral_lines.strongest([rests], "gyro", 0) is not None
        return found
    assert lines() == 0
    assert lines(0.5) == 12


def test_an_axis_that_is_quieter_at_rest_than_its_sensor_lets_it_has_a_dead_band():
    """Within the band all rests read 0, and no code beyond it is missing."""
    generator = np.random.default_rng(8)
    still = np.arange(20000) % 1000 < 800
    rate = 400.0 * np.sin(2.0 * np.pi * np.arange(20000) / 200.0) * ~still + 3.0
    rates = rate[:, None] + generator.normal(0.0, 3.0, (20000, 3))
    rates[:, 2] = rates[:, 2] * (1.0 - np.exp(-(rates[:, 2] / 30.0) ** 4))
    found, = dead_band.findings("gyro", [np.rint(rates).astype(np.int16)], [still])
    assert found.axes == ["z"]
    low, high = found.interval["z"]
    assert 2.0 <= low < 30.0 < high
    # A part whose Z is half as noisy, about 0, is none.
    rates[:, 2] = np.where(still, generator.normal(0.0, 1.6, 20000), rate)
    assert dead_band.findings("gyro", [np.rint(rates).astype(np.int16)], [still]) == []


@pytest.mark.parametrize("known, said", [(0.7, ["x", "y", "z"]), (0.1, [])])
def test_a_gyro_that_is_gated_on_all_axes_has_a_dead_band(known, said):
    """All three read 0 in every rest, so that none had noise to judge the others by. Where no such
    part has that little it is gated, where a part's noise is a tenth of a count it is coarse."""
    generator = np.random.default_rng(8)
    still = np.arange(20000) % 1000 < 800
    turn = 400.0 * np.sin(2.0 * np.pi * np.arange(20000) / 200.0) * ~still
    rates = turn[:, None] * [1.0, -0.7, 0.8] + generator.normal(0.0, 3.0, (20000, 3))
    gated = np.rint(rates - np.where(np.abs(rates) > 30.0, 900.0 / rates, rates)).astype(np.int16)
    assert not gated[still].any()
    found = dead_band.findings("gyro", [gated], [still], known)
    assert [axis for f in found for axis in f.axes] == said


def test_what_rests_near_0_and_swings_through_it_has_no_band():
    """All that was quiet lay near 0 and was not looked at: 3 counts were "missing" at 0."""
    generator, t = np.random.default_rng(10), np.arange(12000)
    size = 1500.0 * np.exp(0.7 * np.sin(2.0 * np.pi * t / 1700.0))
    swings = size * np.sin(2.0 * np.pi * t / 60.0) * (t % 4000 > 800)
    column = np.rint(swings + generator.normal(0.0, 1.0, len(t))).astype(np.int64)
    assert not present(dead_band.band_of_columns([column]).nats)


@pytest.mark.parametrize("band", [0, 40])
def test_what_settles_through_0_step_by_step_has_no_band(band):
    """As behind a low-pass, each step a part of the one before: 7 counts were "missing" at 0, of
    80 nats, and 45 of a band of 40."""
    generator = np.random.default_rng(1)
    towards = np.repeat(generator.choice([-1.0, 1.0], 250) * generator.uniform(300, 500, 250), 20)
    true = lfilter([0.35], [1.0, -0.65], towards)
    read = np.sign(true) * np.maximum(np.abs(true) - band, 0.0) + generator.normal(0.0, 2.0, 5000)
    found = dead_band.band_of_columns([np.rint(read)])
    assert present(found.nats) == (band > 0)
    assert not band or found.counts == pytest.approx(band, rel=0.1)


def stamped(t_s):
    """Session of a rest with its samples stamped at t_s (n,) s."""
    still = at_rest(flicker(5, len(t_s))).capture
    still.t_us = np.rint(1e6 * t_s).astype(np.int64)
    return blocks.session_of("s", still)


def test_samples_that_come_at_uneven_times_are_told_from_stamps_that_scatter():
    """Turns of a board that samples when it can were read as if it sampled evenly."""
    generator, even = np.random.default_rng(12), 0.01 * np.arange(6000)
    assert stamped(np.cumsum(0.01 + 0.0018 * generator.standard_normal(6000))).uneven
    scattered = np.maximum.accumulate(even + 0.0018 * generator.standard_normal(6000))
    packets = 0.04 * np.ceil(np.arange(6000) / 4.0) + 0.002 * (np.arange(6000) % 4)
    for t in (even, scattered, packets, 1.0001 * even):
        assert not stamped(t).uneven


def rustling(seed, n=24000):
    """(n,) counts of an axis that lies near the edge of a page, as noisy as many chips are."""
    return np.rint(np.random.default_rng(seed).normal(16390.0, 52.0, n)).astype(np.int64)


def test_pages_are_told_where_noise_is_a_fifth_of_one():
    """256 counts in 1 % of the samples of a chip with noise of 50 were "no gap"."""
    x = rustling(20)
    assert not present(torn_reads.paged(sample_neighbours.tabled(x, False))[0])
    spiked = np.random.default_rng(21).random(len(x)) < 0.009
    nats, number = torn_reads.paged(sample_neighbours.tabled(
        np.where(spiked, x + 256, x), False))
    assert present(nats) and number == pytest.approx(spiked.sum(), rel=0.25)


@pytest.mark.parametrize("step", [1, 16])  # counts
@pytest.mark.parametrize("other", [1, -1])  # whose low byte it is: of the sample before, after
def test_a_low_byte_of_another_sample_is_a_torn_read(other, step):
    """A high byte read before the registers changed and a low one after it, which the next sample
    has as well: 86 of them among 93,000 samples were "no gap"."""
    x = rustling(22) // step * step
    assert not present(torn_reads.competed(sample_neighbours.tabled(x, False))[0])
    mixed = np.random.default_rng(23).random(len(x)) < 0.02
    torn = np.where(mixed, (x & ~255) | np.roll(x, other) & 255, x)
    moved = (np.abs(torn - x) > 128).sum()
    nats, number, _ = torn_reads.competed(sample_neighbours.tabled(torn, False))
    assert nats > (100.0 if step == 1 else 80.0) and number == pytest.approx(moved, rel=0.3)


def test_a_low_byte_of_sixteen_values_is_often_that_of_the_sample_before():
    """Where the low bits are cut off one knock in 16 leads to it, and torn reads were named beside
    the steps."""
    for seed in range(3):
        generator = np.random.default_rng(seed)
        knocks = 200.0 * generator.standard_normal(24000) * (generator.random(24000) < 0.03)
        x = np.rint(generator.normal(16390.0, 10.0, 24000) + knocks).astype(np.int64) // 16 * 16
        x[7] += 1  # one that is off the grid does not make them finer
        assert not present(torn_reads.competed(sample_neighbours.tabled(x, False))[0])


def test_pages_of_a_quiet_chip_are_no_low_bytes_of_the_sample_before():
    """Of three codes that noise reads one is the one before: those were named, beside knocks."""
    generator = np.random.default_rng(24)
    x = np.rint(generator.normal(70.3, 1.0, 24000)).astype(np.int64)
    knocked = generator.random(len(x)) < 0.03
    x = np.where(knocked, x + np.rint(40.0 * generator.standard_normal(len(x))), x)
    spiked = np.where(generator.random(len(x)) < 0.009, x + 256, x).astype(np.int64)
    assert not present(torn_reads.competed(sample_neighbours.tabled(spiked, False))[0])


def test_a_band_about_a_bias_is_put_back_about_that():
    """About 0 it was put on every reading of the axis, those at the bias as well."""
    still = at_rest(flicker(5, 4000)).capture
    rate = 400.0 * np.sin(2.0 * np.pi * np.arange(4000) / 900.0) * (np.arange(4000) >= 2000)
    still.gyro = still.gyro.copy()
    still.gyro[:, 2] = np.rint(55.0 + np.sign(rate) * np.maximum(np.abs(rate) - 30.0, 0.0))
    found = Finding("dead_band", "gyro", ["z"], {"z": 30}, "counts", 50.0, "amplitude", "")
    back = samples_judged._without_bands(blocks.session_of("s", still), [found]).capture.gyro[:, 2]
    assert (back[:2000] == 55).all() and still.gyro[2100, 2] + 30 == back[2100]
    away = np.abs(rate) > 31.0
    assert np.abs(back - 55.0 - rate)[away].max() <= 1.0


def test_spikes_that_are_pages_are_one_place():
    still = at_rest(flicker(5, 8000)).capture
    still.gyro = still.gyro.copy()
    spiked = np.random.default_rng(25).choice(np.arange(100, 7900), 90, replace=False)
    still.gyro[spiked, 1] += np.int16(256)
    judged = samples_judged.judge([blocks.session_of("s", still)])
    said = [words for words in judged.remarks if "spikes" in words or "256 counts" in words]
    assert len(said) == 2
    assert [(p.sensor, p.domain) for p in judged.nameless] == [("gyro", "noise")]


def test_noise_nearly_as_wide_as_a_page_has_no_jumps_by_pages():
    """A jump up or down by a page had the density of both: 20 nats in noise of 63 counts."""
    generator = np.random.default_rng(1)
    columns = [np.rint(63.0 * generator.standard_normal(25000)).astype(np.int64)
               for _ in range(6)]
    nats, _ = torn_reads.paged(sample_neighbours.together(
        [sample_neighbours.tabled(column, False) for column in columns]))
    assert nats <= 0.0


@pytest.mark.filterwarnings("error")
def test_of_a_log_of_less_than_a_sample_a_second_no_line_is_told():
    slow = at_rest(flicker(5, 3000)).capture
    slow.meta["rate_hz"], slow.t_us = 0.8, 1_250_000 * np.arange(3000)
    assert spectral_lines.findings([blocks.session_of("slow", slow)]) == []


def test_of_a_log_of_a_few_samples_a_second_no_tone_is_told():
    """A recording at 2 Hz had numpy's warning about the mean of an empty slice on stderr."""
    few = np.random.default_rng(3).standard_normal((30, 4))
    chance, _, lobe = rest_spectra.largest_bins(few, 2.0)
    assert (chance == 1.0).all() and not lobe.any()


def test_noise_a_resonance_and_a_steady_line_are_no_tones_that_wander():
    """By chance one of so few stretches has one less often than rest_spectra.DOUBTED says."""
    generator, n = np.random.default_rng(2), 250
    t = np.arange(30 * n) * 0.01
    white = generator.standard_normal((30 * n, 200))
    sway = signal.lfilter([1.0], [1.0, -1.9 * np.cos(0.9), 0.9025], white[:, :20], axis=0)
    line = white[:, :20] + 2.0 * np.sin(2.0 * np.pi * 17.3 * t)[:, None]
    for columns in (white, sway, line):
        assert all(rest_spectra._wandering(x.reshape(30, n), 100.0)[0] == 0.0 for x in columns.T)
    found = np.concatenate([rest_spectra.largest_bins(x.reshape(30, n), 100.0)[0]
                            for x in white.T])
    assert (found < rest_spectra.RARE).mean() < rest_spectra.DOUBTED
    chirp = white[:, 0] + 2.0 * np.sin(2.0 * np.pi * np.cumsum(0.01 * (5.0 + t % 40.0)))
    assert rest_spectra._wandering(chirp.reshape(30, n), 100.0)[0] > 30.0
