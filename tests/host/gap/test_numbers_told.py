"""What is left of the gap of two logs of one motion is what the numbers told leave, and no other
numbers that a fit may have besides."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.diagnosis.simulator import (
    comparison,
    noise_and_registers,
    numbers_told,
    traces,
)
from tests.worlds.tumbled import RATE_HZ, read, tumbled


def compared(t, force, rate, real_force, real_rate):
    return comparison.compare([("real", read(t, real_force, real_rate, 1))], "sim",
                              read(t, force, rate, 101))


def on_a_table(seconds=80.0, leans=0.2):
    """(t, specific force g, rate deg/s) of a table that turns about an upright axis which leans in
    the sensor: x has so much of what z reads, of its turning and of gravity."""
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 20.0 - 3.0, 19.5 - t % 20.0) / 1.5, 0.0, 1.0)
    spin = 60.0 * np.sin(0.7 * t) * way
    axis = np.array([leans, 0.0, 1.0])
    return t, np.tile(axis / np.linalg.norm(axis), (len(t), 1)), np.outer(spin, axis)


def test_a_course_that_nothing_told_has_stays_in_the_gap():
    """Half a deg/s in the course of the log, as of warming up: it was taken off as what a sensor
    may do of itself, and the gap was closed by a bias."""
    t, force, rate = tumbled(1, 80.0)
    warming = 1.0 + 0.5 * t[:, None] / t[-1] * [0.0, 0.0, 1.0]
    found = compared(t, force, rate, force, rate + warming)
    before, after, _ = found.gap["gyro"]
    assert before == pytest.approx(np.sqrt((warming ** 2).mean()), rel=0.02)
    # A straight line of that height has a twelfth of its square about its mean; one axis of three.
    assert after == pytest.approx(0.5 / 6.0, rel=0.25)


def test_a_bias_that_flickers_is_no_gap():
    t, force, rate = tumbled(2, 80.0)
    found = compared(t, force, rate, force, rate + 0.004 * np.cos(t[:, None] / 30.0))
    assert not found.left and not found.shaken
    assert not [p for p in found.differs if p.sensor == "gyro"]


@pytest.mark.long
def test_the_scale_of_the_one_axis_that_is_turned_is_told():
    """It did not differ by itself, and yet the gap was said to be closed: by a bias that did. What
    little another axis has of the turn would do it as well, with five times as much."""
    t, force, rate = on_a_table()
    found = compared(t, force, rate, force, rate * [1.0, 1.0, 1.015] + [0.3, -0.2, 0.4])
    shapes = {(p.name, p.axis): p for p in found.differs if p.sensor == "gyro"
              and p.name != "bias"}
    assert list(shapes) == [("scale", "z")]
    assert shapes["scale", "z"].difference == pytest.approx(1.5, rel=0.05)
    assert found.gap["gyro"][1] < 1.2 * found.gap["gyro"][2]


def test_a_gyro_s_bias_is_told_by_the_motion_as_well():
    """Two rests told it to 0.13 deg/s, whatever lies between them."""
    t, force, rate = tumbled(3, 43.0)
    t, force, rate = t[500:-800], force[500:-800], rate[500:-800]
    found = compared(t, force, rate, force, rate + [0.3, 0.0, 0.0])
    bias, = [p for p in found.parameters if (p.name, p.sensor, p.axis) == ("bias", "gyro", "x")]
    assert bias.differs and bias.difference == pytest.approx(0.3, abs=0.01)
    low, high = bias.difference_interval
    assert low < 0.3 < high and high - low < 0.1


@pytest.mark.long
@pytest.mark.parametrize("off_mg", [0.0, 40.0])
def test_a_bias_that_no_attitude_tells_from_a_scale_is_no_no_gap(off_mg):
    """A table that stays level: 23 mg of gap, all of it put right, and no number differed."""
    t, force, rate = on_a_table(60.0)
    found = compared(t, force, rate, force + [1e-3 * off_mg, 0.0, 0.0], rate)
    differs = [p for p in found.differs if p.sensor == "accel"]
    assert [(p.name, p.axis) for p in differs] == [("bias", "x")] * bool(off_mg)
    for bias in differs:
        low, high = bias.difference_interval
        assert low < off_mg < high and high - low < 2.0


@pytest.mark.long
def test_what_shakes_each_log_keeps_no_number_from_being_told():
    """Bumps left three times the noise, and what closed all the rest of 26 mg was not said."""
    t, force, rate = on_a_table(60.0)
    rng = np.random.default_rng(4)

    def bumps():
        slow = np.convolve(rng.standard_normal(len(t)), np.hanning(40), "same")
        return np.outer(slow / slow.std() * (np.abs(rate[:, 2]) > 1.0), [0.006] * 3)
    found = compared(t, force + bumps(), rate, force + bumps() + [0.04, 0.0, -0.02], rate)
    before, after, noise = found.gap["accel"]
    assert after > 2.0 * noise and after < 0.4 * before
    told = {p.axis[0] for p in found.differs if p.sensor == "accel"}
    assert told == {"x", "z"}


@pytest.mark.long
def test_a_drift_of_what_stays_level_is_no_bias_of_many_times_its_size():
    """30 mg that come and go, and nothing that tells a scale: it followed the drift, and gravity,
    moved by it, made a bias of 220 mg of a gap of 14."""
    t, force, rate = on_a_table(60.0, leans=0.0)
    drift = np.outer(np.sin(t / 8.0), [0.03, 0.0, 0.02])
    found = compared(t, force, rate, force + drift, rate)
    assert found.left == ["accel"]
    apart = {p.axis: p for p in found.parameters if (p.name, p.sensor) == ("bias", "accel")}
    for axis, own in zip("xyz", 1e3 * drift.mean(axis=0)):
        assert not apart[axis].differs
        assert apart[axis].difference == pytest.approx(own, abs=1.0)


def test_where_what_is_left_goes_on_for_seconds_no_numbers_are_told_together():
    """A gain that comes and goes by 8 %: no scale is its own, and what closes more of the gap by
    chance is none."""
    t, force, rate = tumbled(3, 80.0)
    gain = np.interp(t, [0.0, 20.0, 40.0, 60.0, 80.0], [1.0, 0.9, 1.02, 0.93, 1.0])
    found = compared(t, force, rate, force * gain[:, None], rate)
    assert found.left == ["accel"]
    assert not [p for p in found.differs if (p.sensor, p.axis) == ("accel", "y")]


def test_what_next_to_nothing_reads_has_no_number_of_many_times_its_size():
    """A pendulum hardly turns about x, and z was told to have 194 degrees of it."""
    t = np.arange(0.0, 25.0, 0.02)
    left = 0.15 * np.sin(4.0 * t) + 0.1 * np.random.default_rng(5).standard_normal(len(t))
    off = np.stack([0.0 * t, 0.0 * t, left], 1)
    key = "misalignment", "zx"
    columns = {key: (2, 0.03 * np.sin(4.0 * t + 0.5), 57.3, 0.04)}
    _, sizes = numbers_told._regressed(off, columns, [], [key])
    size, sigma = sizes[key]
    assert abs(size) < 4.0 * 57.3 * 0.04 and sigma < 57.3 * 0.04


def hovering(seed, seconds=80.0):
    """(t, gravity's direction, what moves it in g, rate deg/s) of what leans by some degrees."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t - 4.0, seconds - 4.0 - t) / 2.0, 0.0, 1.0)

    def wave(size, *hz):
        return way * sum(size * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.28)) for f in hz)
    angles = np.stack([wave(1.0, 0.03, 0.11), wave(0.06, 0.05, 0.23), wave(0.06, 0.07, 0.19)], 1)
    turn = Rotation.from_euler("ZYX", angles).as_matrix()
    step = np.einsum("nji,njk->nik", turn[:-1], turn[1:])
    rate = np.degrees(Rotation.from_matrix(step).as_rotvec()) * RATE_HZ
    moved = np.stack([wave(0.05, 0.31, 0.13), wave(0.05, 0.37, 0.17), wave(0.03, 0.29, 0.21)], 1)
    return t, turn[:, 2, :], moved, np.vstack([rate, rate[-1:]])


@pytest.mark.long
def test_what_moves_two_axes_more_than_gravity_does_is_no_scale_of_the_third():
    """Of a craft that hovers: 7 % of what moves it along x and y were a factor on all that moves
    it and -8 % on z, and a bias of 50 mg there was one of 130."""
    t, up, moved, rate = hovering(1)
    found = compared(t, up + moved, rate, up + moved * [0.93, 0.93, 1.0] - [0.0, 0.0, 0.05], rate)
    assert not found.conventions
    told, = [p for p in found.differs if p.sensor == "accel"]
    assert (told.name, told.axis) == ("bias", "z")
    assert told.difference == pytest.approx(-50.0, abs=5.0)


@pytest.mark.parametrize("scales, bias, doubted", [
    ([0.02, -0.03, 0.01], [0.3, -0.2, 0.5], False), ([-0.5, -0.51, -0.5], [0.0, 0.0, 0.0], False),
    ([0.0, 0.0, -0.2], [0.0, 0.0, -7.8], True), ([-0.78, -0.78, -0.17], [0.0, 0.0, 0.0], True),
    ([0.0, 0.0, -2.0], [0.0, 0.0, 0.0], True)])
def test_numbers_that_no_two_parts_differ_by_are_something_else(scales, bias, doubted):
    """Gravity that is left out on a floor was a bias of most of it, a unit three scales that no
    full scale has: half of all is one."""
    fit = SimpleNamespace(shape=np.diag(scales), bias=np.array(bias), unit=1.0,
                          hypothesis=SimpleNamespace(bias_sd=None))
    found = numbers_told.doubted(SimpleNamespace(
        conventions=(), fit=fit, live=np.ones(3, bool), kind="accel"), 0.0)
    assert bool(found) is doubted and (not found or found[0] > 0.99)


def test_a_noise_that_is_hardly_known_ends_above_nothing():
    """Of four pairs of means it was "4.9 [-0.27, 10.1]"."""
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 1.0, 0.01)

    def still(sd):
        return traces.Trace("log", t, 9.8 + sd * rng.standard_normal((100, 3)), None, None, 100.0,
                            9.80665, ((0, 100),), (None,), (1e-4, None), {"accel": 0.05},
                            np.zeros(100, bool), np.zeros(100, bool))
    found, _ = noise_and_registers.noises(*(
        replace(log, rate=np.radians(log.force - 9.8), quantum=(1e-4, 1e-6), flicker={
            "accel": 0.05, "gyro": 0.002}) for log in (still(0.5), still(0.01))))
    assert len(found) == 6 and all(p.differs for p in found)
    for p in found:
        assert 0.0 < p.real_interval[0] < p.real < p.real_interval[1]
        assert 0.0 < p.difference_interval[0] < p.difference < p.difference_interval[1]
        assert p.real_interval[1] / p.real == pytest.approx(p.real / p.real_interval[0])


@pytest.mark.parametrize("scales, said", [
    ((9.6 / 9.80665,) * 3, True), ((0.98, 1.02, 0.98), False), ((1.0, 0.98, 1.0), False)])
def test_three_scales_alike_may_be_the_simulators_gravity(scales, said):
    """A simulator of 9.6 m/s2 had "a scale of 2.15 %" three times, and nobody set its gravity."""
    t, force, rate = tumbled(3, 80.0)
    found = compared(t, force * scales, rate, force, rate)
    told = [line for line in found.remarks if "gravity of" in line]
    assert len(told) == said
    if said:
        assert "instead of 9.807" in told[0]
        assert float(told[0].split("gravity of ")[1].split()[0]) == pytest.approx(9.6, abs=0.005)
