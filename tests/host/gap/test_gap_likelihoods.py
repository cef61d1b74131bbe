"""Registers and clock: every score is a likelihood ratio that grows with what there is to see, and
what jumps, is missing or runs otherwise than an effect does has no name."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from sixflip_host.capture import stamp_envelope
from sixflip_host.diagnosis import aliases, odds, samples_judged
from sixflip_host.diagnosis.detect import (
    axis_order,
    codes,
    rest_spectra,
    sample_neighbours,
    spectral_lines,
    torn_reads,
)
from sixflip_host.diagnosis.detect.detection import present
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


def found(effects=(), change=None, seed=5):
    """{(effect, sensor): Finding} of two recommended sessions of an MPU6050."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": seed,
                               "effects": list(effects)})
    sessions = []
    for number in range(2):
        capture = simulated_session.session(plan, number)
        if change:
            change(capture, np.random.default_rng(number))
        sessions.append(blocks.session_of(str(number), capture))
    return {(f.effect, f.sensor): f for f in samples_judged.judge(sessions).findings}


def torn(column, share, generator):
    """column with the page of the sample before in a share of its samples."""
    hit = generator.random(len(column)) < share
    hit[0] = False
    mixed = np.roll(column, 1) // 256 * 256 + column % 256
    return np.where(hit, mixed, column)


def nats(column):
    return torn_reads.competed(sample_neighbours.tabled(column, False))[0]


def test_torn_reads_are_the_likelier_the_more_there_are():
    generator = np.random.default_rng(2)
    sound = np.rint(16380.0 + 50.0 * generator.standard_normal(60000)).astype(np.int64)
    scores = [nats(torn(sound, share, generator)) for share in (0.0, 5e-3, 2e-2, 8e-2)]
    assert not present(scores[0])
    assert present(scores[1]) and scores == sorted(scores)
    assert scores[3] > 3.0 * scores[2]


def test_of_torn_reads_alone_hardly_a_sample_jumps_otherwise():
    """What a hand makes as loud in moves counted, and of pure tears a third was something else."""
    generator = np.random.default_rng(3)
    turns = 14000.0 * np.sin(np.linspace(0.0, 60.0, 60000)) ** 5
    trembling = 30.0 * np.clip(generator.standard_t(1.2, 60000), -200.0, 200.0) * (
        np.abs(np.gradient(turns)) > 1.0)
    sound = np.rint(turns + trembling + 12.0 * generator.standard_normal(60000)).astype(np.int64)
    nats, _, tears = torn_reads.competed(
        sample_neighbours.tabled(torn(sound, 2e-2, generator), False))
    assert present(nats) and tears.share()["share"] > 0.85
    other = np.where(generator.random(60000) < 2e-3, 2000, 0)  # what jumps as nothing torn does
    tears = torn_reads.competed(
        sample_neighbours.tabled(torn(sound + other, 2e-2, generator), False))[2]
    assert 0.2 < tears.share()["share"] < 0.8


def test_torn_reads_are_the_same_however_many_samples_are_looked_at_at_once(monkeypatch):
    generator = np.random.default_rng(2)
    sound = np.rint(16380.0 + 50.0 * generator.standard_normal(3000)).astype(np.int64)
    column = torn(sound, 2e-2, generator)
    whole = torn_reads.competed(sample_neighbours.tabled(column, False))[:2]
    monkeypatch.setattr(sample_neighbours, "AT_A_TIME", 77)
    assert torn_reads.competed(sample_neighbours.tabled(column, False))[:2] == pytest.approx(
        whole, rel=1e-9)


def test_a_line_is_the_likelier_the_stronger_it_is_however_strong():
    for x, number in ((0.5, 3), (30.0, 12), (400.0, 150)):
        assert rest_spectra.log_beyond(x, number) == pytest.approx(
            stats.gamma.logsf(x, number), rel=1e-9)
    scores = []
    for mg in (20.0, 60.0, 200.0):
        plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 5,
                                   "effects": [{"effect": "vibration", "sensor": "accel",
                                                "x": mg, "frequency_hz": 17.3}]})
        session = blocks.session_of("0", simulated_session.session(plan, 0))
        line, = spectral_lines.findings([session])
        assert "x" in line.axes and 0.9 < line.share <= 1.0
        scores.append(line.score)
    assert scores[0] < scores[1] < scores[2] and scores[2] > 1000.0


def test_few_torn_reads_are_found_with_how_many():
    said = found([{"effect": "torn_reads", "sensor": "accel", "chance": 0.1}])
    assert list(said) == [("torn_reads", "accel")]
    low, high = said["torn_reads", "accel"].interval["chance"]
    assert low < 0.1 < high and said["torn_reads", "accel"].named > 0.95
    assert said["torn_reads", "accel"].share > 0.9


def test_torn_reads_of_a_few_turns_are_found():
    """The samples on either side of a tear are foreseen by it, two thirds of a page off: these
    looked like jumps of any size, beside which a dozen tears had no name."""
    generator = np.random.default_rng(9)
    t = np.arange(20000) / 100.0
    turns = np.where(t % 10.0 > 7.0, 2600.0 * np.sin(2.0 * np.pi * t / 3.0) ** 3, 0.0)
    column = np.rint(47.0 + turns + 3.0 * generator.standard_normal(20000)).astype(np.int64)
    read, crossed = column.copy(), np.flatnonzero(np.diff(column // 256))[::48]
    read[crossed] = column[crossed + 1] // 256 * 256 + column[crossed] % 256
    assert 8 < len(crossed) < 30

    def found(counts):
        capture = SimpleNamespace(gyro=np.column_stack([counts] * 3), meta={})
        return torn_reads.finding([SimpleNamespace(capture=capture, at_rest=t % 10.0 < 7.0)],
                                  "gyro")
    assert found(column) == []
    assert found(read)[0].number == pytest.approx(3 * len(crossed), rel=0.3)


@pytest.mark.parametrize("size", [256, 600])
def test_spikes_are_no_torn_reads_even_where_they_are_a_page_high(size):
    def spiked(capture, generator):
        hit = generator.random(len(capture)) < 0.01
        counts = capture.accel.astype(int)
        counts[hit, 1] += size * generator.choice([-1, 1], hit.sum())
        capture.accel = counts.astype(np.int16)
    assert found(change=spiked) == {}


@pytest.mark.long
def test_a_clock_is_the_likelier_off_the_more_it_is_and_sessions_must_agree():
    scores = [found([{"effect": "sample_rate", "rate": rate}])["sample_rate", "device"].score
              for rate in (0.2, 0.3, 0.7)]
    assert scores == sorted(scores) and scores[2] > 10.0 * scores[0] > 10.0 * odds.PRESENT
    assert found([{"effect": "sample_rate", "rate": 0.1}]) == {}  # 0.18 degrees of half a turn

    def apart(capture, generator):
        capture.t_us = np.rint(capture.t_us * (1.02 if apart.first else 0.99)).astype(np.int64)
        apart.first = False
    apart.first = True
    assert found(change=apart) == {}


def test_gaps_that_are_no_whole_number_of_samples_are_less_likely_lost_samples():
    whole, half = (stamp_envelope.loss_nats(np.full(6, late), 0.03) for late in (3.0, 3.4))
    assert present(whole) and not present(half)
    mixed = np.array([1.0] * 30 + [1.4, 2.5, 0.7])  # and three times it stood still
    assert present(stamp_envelope.loss_nats(mixed, 0.0))


def restamped(capture, generator, phase):
    """Rows read in a loop that does something else after 0.3 % of them, for a whole number of
    periods or for any time, and goes on from there."""
    scatter = 0.04 * generator.gamma(3.0, 1.0, len(capture)) / 3.0
    stands = (generator.random(len(capture)) < 0.003) * generator.exponential(1.5, len(capture))
    periods = 0.96 + scatter + (np.ceil(stands) if phase == "whole" else stands)
    capture.t_us = (1e4 * np.cumsum(periods)).astype(np.int64)


@pytest.mark.parametrize("phase, lost", [("any", False), ("whole", True)])
def test_a_loop_that_sleeps_and_stands_still_now_and_then_loses_nothing(phase, lost):
    """A healthy part read by such a loop was said to lose 0.2 % of its samples."""
    said = found(change=lambda capture, generator: restamped(capture, generator, phase))
    assert (("dropped_samples", "device") in said) == lost


def test_samples_lost_in_runs_are_counted():
    def lossy(capture, generator):
        keep = np.ones(len(capture), bool)
        for start in generator.integers(100, len(capture) - 100, 12):
            keep[start:start + 20] = False
        for name in ("t_us", "accel", "gyro", "temp", "pose"):
            setattr(capture, name, getattr(capture, name)[keep])
        lossy.share.append(100.0 * (1.0 - keep.mean()))
    lossy.share = []
    said = found(change=lossy)["dropped_samples", "device"]
    assert said.value["chance"] == pytest.approx(np.mean(lossy.share), rel=0.05)


def test_codes_on_a_grid_count_code_by_code():
    column = np.arange(-30, 30, dtype=np.int64) * 4
    few, many = (codes.step_nats(np.stack([x] * 3, 1), [4] * 3)[0] for x in (column[:13], column))
    assert many - few == pytest.approx((len(column) - 13) * np.log(4.0))


def test_an_order_of_axes_is_held_against_the_plain_one_and_against_any_matrix():
    generator = np.random.default_rng(4)
    poses = np.concatenate([np.eye(3), -np.eye(3)] * 2)
    order = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    noise = 0.02 * generator.standard_normal((12, 3))
    assert present(axis_order.order_nats(poses @ order.T + noise, poses, order))
    sheared = poses @ (order + 0.45).T + noise
    assert not present(axis_order.order_nats(sheared, poses, order))


@pytest.mark.parametrize("named, nameless, told, seen, said", [
    (0.02, 0.1, False, True, "no gap"), (0.02, 0.1, False, False, "cannot tell"),
    (0.99, 0.1, True, True, "explained"), (0.99, 0.1, False, True, "cannot tell"),
    (0.99, 0.9, True, True, "partly explained"), (0.3, 0.9, False, True, "unexplained")])
def test_the_verdict_is_a_table(named, nameless, told, seen, said):
    assert odds.decide([odds.Claim(named, told)], [nameless], seen) == said


def test_what_stands_in_a_names_place_without_one_makes_it_doubtful():
    assert odds.decide([odds.Claim(0.4, True, 0.6)], [], True) == "unexplained"
    assert odds.decide([], [], False) == "cannot tell"


def test_probabilities_of_a_place_add_up_and_chance_bounds_them():
    shares = odds.shares({"": 2.0, "creep": 9.0, "hysteresis": 8.0, "history": 1.0})
    assert sum(shares.values()) == pytest.approx(1.0)
    assert shares["creep"] / shares["hysteresis"] == pytest.approx(np.e)
    assert odds.probability(odds.COST) == 0.5 and odds.chance(-3.0) == 1.0


def test_names_that_cannot_be_told_in_principle_share_their_probability():
    cause = aliases.Cause(
        "warm_up", (), 30.0,
        {"warm_up": 0.9, "thermal_bias": 0.02, "creep": 0.04, "": 0.03, "time": 0.01},
        {"thermal_bias": "alias index 0.98", "creep": "probability 0.04"},
        frozenset(["thermal_bias"]))
    assert cause.probabilities == pytest.approx(
        {"warm_up": 0.46, "thermal_bias": 0.46, "creep": 0.04})
    assert list(cause.probabilities)[0] == "warm_up" and cause.nameless == pytest.approx(0.01)


def test_spikes_of_a_page_in_a_quiet_gyro_are_no_torn_reads():
    generator = np.random.default_rng(7)
    column = np.rint(-1.0 + 3.0 * generator.standard_normal(50000)).astype(np.int64)
    hit = generator.random(len(column)) < 0.003
    column[hit] += 256 * generator.choice([-1, 1], hit.sum())
    assert nats(column) < 0.0
