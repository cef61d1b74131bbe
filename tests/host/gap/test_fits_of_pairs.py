"""What the best fit of two logs of one motion is: as smooth as each other, whatever their clocks
and however narrow the band is that they move in, and one with a name where that says as much."""
from copy import copy
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from sixflip_host.diagnosis import answer, diagnose
from sixflip_host.diagnosis.simulator import (
    comparison,
    evidence_of_logs,
    hypotheses,
    remaining_gap,
)
from sixflip_host.experiment import projection
from tests.worlds.tumbled import read, tumbled


def compared(real, simulated):
    return comparison.compare([("real", real)], "sim", simulated)


def test_clocks_apart_make_no_log_the_smoother():
    """Both were filtered for the same band, each by its own clock: "put a low-pass of 26 Hz behind
    it" beside a clock of 2 %."""
    t, force, rate = tumbled(4, 80.0)
    real = read(t, force, rate, 1)
    slow = copy(real)
    slow.t_us = np.rint(0.98 * real.t_us).astype(np.int64)
    found = compared(slow, read(t, force, rate, 2))
    (clock,) = found.differs
    assert clock.name == "clock" and clock.difference == pytest.approx(2.0, abs=0.05)


@pytest.mark.long
def test_a_pendulum_s_noise_is_no_scale():
    """Of a swing of one frequency a smoother log is one of less scale: what a fit took off a noisy
    gyro by the one it put back by the other, 0.1 % of three times its standard error."""
    t = np.arange(0.0, 300.0, 0.01)
    goes = np.clip(np.minimum(t % 60.0 - 12.0, 58.0 - t % 60.0) / 2.0, 0.0, 1.0)
    swing = np.radians(30.0) * np.sin(4.4 * t) * goes
    turned = np.gradient(swing, t)
    rate = np.outer(np.degrees(turned), [0.0, 1.0, 0.0])
    # Along the string: of what swings freely gravity does not show across it.
    force = np.outer(np.cos(swing) + turned ** 2 / 4.4 ** 2, [0.0, 0.0, 1.0])
    logs = []
    for seed in (3, 4):
        noise = 0.03 * np.sqrt(50.0) * np.random.default_rng(100 + seed).standard_normal(
            (len(t), 3))
        logs.append(read(t, force, rate + lfilter(*butter(1, 42.0, fs=100.0), noise, axis=0),
                         seed))
    found = compared(*logs)
    assert not found.differs and not found.conventions


def test_what_closes_the_gap_and_foretells_better_is_no_unknown():
    """Swapped axes of another full scale left 1 of 36 deg/s, and what has no name, which left as
    little of what it had seen and 27 of what it had not, was said instead."""
    t = np.arange(0.0, 20.0, 0.02)
    real = np.stack([np.sin(t), np.sin(1.7 * t), np.sin(0.6 * t)], 1)
    simulated = real @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).T / 1.13
    pair = SimpleNamespace(t=t, simulated=lambda kind: simulated, real=lambda kind: real)

    def fitted(seen, unseen):
        left = SimpleNamespace(left=unseen * np.cos(9.0 * real), unit=1.0)
        return SimpleNamespace(kind="gyro", live=np.ones(3, bool), pair=pair, fit=SimpleNamespace(
            left=seen * np.cos(9.0 * real), unit=1.0), refitted=lambda rows: left)
    nameless = fitted(0.02, 0.5)
    assert remaining_gap.explains(fitted(0.03, 0.1), nameless)
    assert not remaining_gap.explains(fitted(0.03, 0.6), nameless)
    assert not remaining_gap.explains(fitted(0.3, 0.35), nameless)


def test_a_gyro_with_a_wrong_range_accuses_no_simulator_of_a_time_step():
    """A time step of half the right one, with a probability of 1."""
    t, force, rate = tumbled(1, 60.0)
    found = compared(read(t, force, 2.0 * rate, 1), read(t, force, rate, 101))
    assert found.conventions == () and all(
        p.difference == pytest.approx(100.0, abs=1.0) for p in found.parameters
        if (p.name, p.sensor) == ("scale", "gyro"))


@pytest.mark.parametrize("share", [0.84, 0.7, 1.3])
def test_a_gyro_that_reads_a_part_is_told_by_the_rests_of_the_simulator(share):
    """A time step that no engine has: it closed the gap, and lay nearer to twice than a scale of
    30 % lies to none."""
    t, force, rate = tumbled(3, 80.0)
    found = compared(read(t, force, share * rate, 1), read(t, force, rate, 101))
    assert found.conventions == () and all(
        p.difference == pytest.approx(100.0 * (share - 1.0), abs=1.0) for p in found.parameters
        if (p.name, p.sensor) == ("scale", "gyro"))


@pytest.mark.parametrize("share", [0.5, 0.444, 0.7, 2.0])
def test_a_scale_that_both_gyros_share_accuses_no_simulator_of_a_time_step(share):
    """Of two logs of the same rates one was told to divide by another time step, with a
    probability of 1: what both turn too little or too far is no difference between them."""
    t, force, rate = tumbled(3, 80.0)
    found = compared(read(t, force, share * rate, 1), read(t, force, share * rate, 101))
    assert found.conventions == () and not found.differs


def test_a_scale_that_both_gyros_share_is_no_gap():
    t, force, rate = tumbled(3, 80.0)
    logs = [read(t, force, 2.0 * rate, seed) for seed in (1, 101)]
    said = diagnose.diagnose([("real", logs[0])], [("sim", logs[1])], jobs=1)
    assert [d.value["factor"] for d in said.damages] == [pytest.approx(2.0, abs=0.05)]
    assert said.verdict == "no gap"


def test_nor_does_one_that_gyros_of_different_motions_share():
    (t, force, rate), (at, pulled, turned) = tumbled(3, 80.0), tumbled(5, 80.0)
    found = compared(read(t, force, 0.5 * rate, 1), read(at, pulled, 0.5 * turned, 101))
    assert not found.alignment.same and found.conventions == () and not found.differs


def test_a_time_step_is_told_where_the_rests_of_the_simulator_show_it():
    t, force, rate = tumbled(3, 80.0)
    found = compared(read(t, force, rate, 1), read(t, force, 0.5 * rate, 101))
    step, = found.conventions
    assert (step.name, step.sensor) == ("time_step", "gyro")


def test_an_accelerometer_with_a_wrong_range_accuses_no_simulator():
    """Gravity with its sign turned, or of a thing that is driven another unit."""
    t, force, rate = tumbled(1, 60.0)
    found = compared(read(t, 0.5 * force, rate, 1), read(t, force, rate, 101))
    assert found.conventions == () and all(
        p.difference == pytest.approx(-50.0, abs=1.0) for p in found.parameters
        if (p.name, p.sensor) == ("scale", "accel"))


def test_a_gyro_with_a_resonance_makes_no_unit_and_no_delay():
    """Another unit, with a probability of 1, and scales that differ by 5600 %; then a gyro that
    is 16 ms early, where it is 3 ms late."""
    t, force, rate = tumbled(1, 60.0)
    shaking = np.random.default_rng(5).standard_normal(rate.shape)
    shaking = lfilter(*butter(2, [6.0, 9.0], "band", fs=100.0), shaking, axis=0)
    rate = rate + 40.0 * shaking * (np.abs(rate).max(axis=1) > 1.0)[:, None]
    fine = np.repeat(rate, 10, axis=0)  # at 1 kHz
    low, high = 2.0 * np.pi * 11.0, 2000.0
    mass = high ** 2 + high * low / 5.0 + low ** 2
    rung = lfilter(np.array([1.0, 2.0, 1.0]) * low ** 2 / mass,
                   [1.0, 2.0 * (low ** 2 - high ** 2) / mass,
                    (high ** 2 - high * low / 5.0 + low ** 2) / mass], fine, axis=0)[9::10]
    found = compared(read(t, force, rung, 1), read(t, force, rate, 101))
    assert not any(c.name.endswith("_unit") for c in found.conventions)
    assert all(abs(p.difference) < 10.0 for p in found.parameters if p.name == "scale")
    assert not any(p.differs and p.difference < -6.0 for p in found.parameters
                   if p.name == "delay")


def test_a_fit_in_proportion_to_what_moves_may_have_an_effect_beside_it():
    """A factor of each axis and one effect more: three numbers were added to four, and all
    stopped."""
    rng = np.random.default_rng(2)
    force, effect = rng.standard_normal((400, 3)), rng.standard_normal((400, 3, 1))
    factors = np.concatenate([force[:, :, None] * np.eye(3), effect], 2)
    beside = hypotheses.Hypothesis("healthy", force, factors, np.zeros(4),
                                   np.array([0.04, 0.04, 0.04, 1.0]), scaled=3)
    fit = evidence_of_logs.fit_one(
        beside, force + 0.3 * effect[:, :, 0], np.eye(3), 1.0, 50.0, "accel", 1.0, None,
        np.ones(3, bool), None)
    assert fit.extra[3] == pytest.approx(0.3, abs=0.01)


@pytest.mark.long
def test_a_gyro_that_levels_off_early_in_a_hand_is_answered():
    t, force, rate = tumbled(1, 80.0)
    real = read(t, force, 60.0 * np.tanh(rate / 60.0), 1)
    told = answer.as_dict(diagnose.diagnose(
        [("real", real)], [("sim", read(t, force, rate, 101))], jobs=1))
    assert told["verdict"] not in ("no gap", "cannot tell", "explained")


def wandering(seed, size, n):
    """(n, 3) of a sensor that wanders slowly, by so much, root mean square, in hours."""
    x = np.random.default_rng(seed).standard_normal((20000, 3))
    x = lfilter([1.0], [1.0, -0.99], x, axis=0)  # of a second each
    x = size * x[10000:] / x.std(axis=0)
    return np.stack([np.interp(np.arange(n) / 100.0, np.arange(len(x)), own) for own in x.T], 1)


@pytest.mark.parametrize("seed", [2, 6, 7])
def test_numbers_within_the_flicker_of_two_logs_are_no_difference(seed):
    """Of two logs that wander by 5 mdeg/s and 0.2 mg, each by itself, biases of 0.015 deg/s and
    0.7 mg were one."""
    t, force, rate = tumbled(seed, 160.0)
    logs = [read(t, force + wandering(k, 2e-4, len(t)), rate + wandering(k + 1, 5e-3, len(t)), k)
            for k in (10 * seed, 1000 * seed)]
    assert not [(p.name, p.sensor, p.axis) for p in compared(*logs).differs
                if p.name in ("bias", "scale", "misalignment")]


def test_a_bias_beyond_the_flicker_of_two_logs_is_told():
    t, force, rate = tumbled(2, 80.0)
    found = compared(read(t, force, rate + [0.0, 0.1, 0.0], 1), read(t, force, rate, 101))
    assert [(p.name, p.sensor, p.axis) for p in found.differs] == [("bias", "gyro", "y")]


def of_one_axis(x, y):
    """(coefficient, its standard error) of y (n,) = coefficient x (n,), a scale before."""
    result = projection.regression(
        np.repeat(y[:, None], 3, 1), x[:, None], np.full(3, 0.04)[:, None],
        np.zeros((len(x), 3, 0)), np.zeros(0), np.zeros(0), 4.0, np.ones(3, bool))
    return result.own[0, 0], result.own_sigma[0, 0]


def test_a_plate_that_bends_is_the_scale_of_neither_sensor_on_it():
    """Nine hertz that shook one of them half as much, beside a turn that both read alike: a gyro's
    scale was 9.07 % off [8.37, 9.77]."""
    rng = np.random.default_rng(7)
    t = np.arange(0.0, 90.0, 0.02)
    turn = 2.0 * np.sin(2.0 * np.pi * 0.3 * t) + np.sin(2.0 * np.pi * 0.9 * t)
    shake = np.sin(2.0 * np.pi * 9.0 * t) * (1.0 + 0.3 * np.sin(0.5 * t))
    noise = 0.02 * rng.standard_normal(len(t))
    scale, sigma = of_one_axis(turn + shake, -0.5 * shake + noise)
    assert abs(scale) > 0.05 and sigma > 0.5 * abs(scale)
    # The same scale in all of it is as sure as before, and so is that of what swings at one place.
    for x in (turn + shake, shake, turn):
        scale, sigma = of_one_axis(x, 0.05 * x + noise)
        assert scale == pytest.approx(0.05, abs=0.005) and sigma < 0.002
