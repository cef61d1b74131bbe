"""Logs of what never rests: a boat, a car that is calm where it drives straight on. Their motions
are made here, of sines and scipy's rotations; nothing of the simulator makes them."""
import dataclasses

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.detect import wrong_scale
from sixflip_host.diagnosis.simulator import (
    comparison,
    log_rests,
    rest_or_course,
    simulator_answer,
    traces,
)
from sixflip_host.experiment import blocks

G = 9.80665
ACCEL_G, GYRO_DPS = 0.002, 0.05  # noise of a sample


def read(t, force, rate, seed, bias=(0.0, 0.0, 0.0)):
    """The Capture of it by an MPU-6050, its gyro off by bias (3,) deg/s."""
    rng, rate_hz = np.random.default_rng(seed), 1.0 / (t[1] - t[0])
    accel = force / G + ACCEL_G * rng.standard_normal(force.shape)
    gyro = np.degrees(rate) + bias + GYRO_DPS * rng.standard_normal(rate.shape)
    meta = {"sensor": "mpu6050", "rate_hz": rate_hz, "accel_lsb_per_g": 8192, "accel_range_g": 4,
            "gyro_lsb_per_dps": 65.5, "gyro_range_dps": 500}
    return Capture(meta, np.rint(1e6 * t).astype(np.int64),
                   np.rint(accel * 8192).astype(np.int16), np.rint(gyro * 65.5).astype(np.int16))


def boat(rate_hz=50.0, seconds=70.0, seed=1, start=0.0):
    """(t, force, rate rad/s, derivatives of roll, pitch, yaw rad/s, turn (n, 3, 3)) on waves."""
    rng = np.random.default_rng(seed)
    t = start + np.arange(0.0, seconds, 1.0 / rate_hz)
    hz, phase = rng.uniform(0.09, 0.25, (3, 5)), rng.uniform(0.0, 2.0 * np.pi, (3, 5))
    size = np.array([12.0, 7.0, 9.0])[:, None] * rng.uniform(0.3, 1.0, (3, 5)) / np.sqrt(5.0)

    def angles(at):
        return np.radians([(a * np.sin(2.0 * np.pi * f * at[:, None] + p)).sum(axis=1)
                           for a, f, p in zip(size, hz, phase)]).T

    turn = Rotation.from_euler("ZYX", angles(t)[:, ::-1])
    short = 1e-3
    step = (Rotation.from_euler("ZYX", angles(t - short)[:, ::-1]).inv()
            * Rotation.from_euler("ZYX", angles(t + short)[:, ::-1])).as_rotvec()
    heave = np.stack([0.2 * np.sin(0.9 * t), 0.3 * np.sin(1.1 * t), 0.5 * np.sin(1.3 * t)], 1)
    return (t - start, turn.inv().apply(heave + [0.0, 0.0, G]), step / (2.0 * short),
            (angles(t + short) - angles(t - short)) / (2.0 * short), turn.as_matrix())


def test_a_boat_that_never_rests_has_no_rest_and_the_noise_of_its_chip():
    """Nearly the whole log was one, with a noise of 0.7 deg/s per root Hz."""
    t, force, rate, _, turn = boat()
    trace = traces.trace_from_capture("boat", read(t, force, rate, 1, (-0.7, 1.8, 0.8)))
    assert not trace.rests
    for kind, unit, sd in (("gyro", np.radians(1.0), GYRO_DPS), ("accel", G, ACCEL_G)):
        density = sd / np.sqrt(trace.rate_hz)
        assert trace.noise[kind].density / unit == pytest.approx(density, rel=0.1)
    motion = traces.motion(trace)
    inside = slice(500, -500)
    tilt = np.degrees(np.arccos(np.clip((motion.up * turn[:, 2])[inside].sum(axis=1), -1.0, 1.0)))
    assert np.sqrt((tilt ** 2).mean()) < 1.0


def test_derivatives_of_roll_pitch_and_yaw_are_named():
    """They were "explained" by biases, under a floor of noise that was the waves."""
    t, force, rate, _, _ = boat()
    later = 2.0
    at, sim_force, _, angle_rates, _ = boat(40.0, 65.0, start=later)
    found = comparison.compare(
        [("real", read(t, force, rate, 1, (-0.7, 1.8, 0.8)))], "sim",
        read(at, sim_force, angle_rates, 2))
    assert [(c.name, c.sensor) for c in found.conventions] == [("euler_angle_rates", "gyro")]
    before, after, floor = found.gap["gyro"]
    assert after < 0.1 * before and floor < 0.05
    assert found.alignment.offset_s == pytest.approx(later, abs=0.02)


def test_a_boat_whose_simulator_turns_as_it_does_is_healthy():
    t, force, rate, _, _ = boat()
    at, sim_force, sim_rate, _, _ = boat(40.0, 65.0, start=2.0)
    found = comparison.compare([("real", read(t, force, rate, 1))], "sim",
                               read(at, sim_force, sim_rate, 2))
    assert not found.conventions and not found.differs and not found.left
    assert simulator_answer.verdict("cannot tell", [found]) == "no gap"


def test_turns_that_no_number_explains_are_not_closed_by_waves():
    """What is left was below a floor that the waves themselves had raised."""
    t, force, rate, _, _ = boat()
    at, sim_force, sim_rate, _, _ = boat(40.0, 65.0, start=2.0)
    bent = sim_rate * (1.0 + 0.08 * np.sin(2.0 * at)[:, None])
    found = comparison.compare([("real", read(t, force, rate, 1, (-0.7, 1.8, 0.8)))], "sim",
                               read(at, sim_force, bent, 2))
    assert found.unexplained or found.shaken
    assert simulator_answer.verdict("cannot tell", [found]) != "explained"


def means(course, seed, white=0.01):
    """(k, 3) deg/s of a gyro's means over a quarter of a second."""
    rng = np.random.default_rng(seed)
    return np.array([0.5, -0.8, -2.4]) + course + white * rng.standard_normal((len(course), 3))


T = 0.25 * np.arange(32)[:, None]
RESTS = {"white noise": 0.0 * T, "a bias that drifts": 0.01 * T * [1.0, -1.0, 2.0],
         "the quicker half of a flicker": 0.01 * np.sin(2.0 * T)}
COURSES = {"a car on a straight road": 0.5 * np.sin(1.1 * T + 0.4) * [0.0, 1.0, 0.0],
           "a wave": 8.0 * np.sin(1.0 * T + [0.0, 1.0, 2.0]),
           "a rover that begins to turn": np.maximum(T - 4.0, 0.0) * [0.0, 0.2, 0.0]}


@pytest.mark.parametrize("name", [*RESTS, *COURSES])
@pytest.mark.parametrize("white", [0.003, 0.03, 0.15])
def test_a_rest_is_no_course(name, white):
    """Whatever the size of the white noise, as long as it does not drown the course."""
    course = (RESTS | COURSES)[name]
    for seed in range(5):
        nats = rest_or_course.course_nats(means(course, seed, white), 0.25, 0.002, 0.015)
        if name in RESTS:
            assert nats < 0.0
        elif white < 0.1 or name == "a wave":
            assert nats > 5.0


def test_a_rest_whose_ends_move_is_cut_and_a_rest_between_moves_is_kept():
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 30.0, 0.01)
    rate = 0.05 * rng.standard_normal((len(t), 3)) + [0.3, -2.0, 0.6]
    rate[:, 2] += 0.4 * np.maximum(0.9 - t, 0.0)
    rate[:, 0] += np.where(t > 24.0, 2.0 * np.sin(1.2 * (t - 24.0)), 0.0)
    calm = [(0, 500), (800, 870), (1200, 1900), (2400, 3000)]
    assert rest_or_course.resting(rate, calm, 100.0, 0.002, 0.015) == [
        (100, 500), (800, 870), (1200, 1900)]


def test_noise_that_has_a_colour_or_is_drowned_is_not_told():
    rng = np.random.default_rng(5)
    white = rng.standard_normal((6000, 3))
    sd, relative = log_rests.white(white + 50.0 * np.sin(0.1 * np.arange(6000))[:, None])
    assert sd == pytest.approx(np.ones(3), rel=0.05) and relative < 0.2
    smooth = np.stack([np.convolve(x, np.ones(4) / 4.0, "same") for x in white.T], 1)
    assert log_rests.white(smooth) is None
    assert log_rests.white(white + 5.0 * np.sin(1.2 * np.arange(6000))[:, None]) is None


def test_what_two_restless_logs_differ_by_is_told_and_an_unknown_floor_closes_no_gap():
    """A bias that neither log can tell by itself has a difference, and a value to add. Where the
    noise is not told, more than a tenth of the gap may be anything."""
    t, force, rate, _, _ = boat()
    found = comparison.compare([("real", read(t, force, rate, 1, (-0.7, 1.8, 0.8)))], "sim",
                               read(t, force, rate, 2))
    biases = {p.axis: p for p in found.parameters if (p.name, p.sensor) == ("bias", "gyro")}
    for axis, truth in zip("xyz", (-0.7, 1.8, 0.8)):
        assert biases[axis].difference == pytest.approx(truth, abs=0.05) and biases[axis].differs
        assert biases[axis].real is None and biases[axis].set_to == pytest.approx(truth, abs=0.05)
    for left, said in ((0.5, "partly explained"), (0.05, "explained")):
        unknown = dataclasses.replace(found, wanders=frozenset(), gap={"gyro": (1.0, left, 0.0)})
        assert simulator_answer.verdict("cannot tell", [unknown]) == said


@pytest.mark.parametrize("seconds, said", [(10.0, False), (120.0, True)])
def test_a_rocket_s_thrust_is_no_wrong_scale_at_rest(seconds, said):
    """1.54 g without a rest were "at rest"; for two minutes nothing has such thrust."""
    rng, t = np.random.default_rng(4), np.arange(0.0, seconds, 0.01)
    turns = 40.0 * np.sin(np.outer(t, [1.3, 0.9, 0.4]))
    force = np.stack([0.3 * np.sin(1.1 * t), 0.2 * np.cos(0.8 * t), 1.5 + 0.1 * np.sin(t)], 1)
    session = blocks.session_of("flight", read(
        t, G * (force + 0.02 * rng.standard_normal(force.shape)), np.radians(turns), 4))
    damage = wrong_scale.accelerometer([session])
    assert not session.runs and (damage is not None) == said
    assert not said or "at rest" not in damage.words


def in_a_hand(seconds=21.0, rate_hz=100.0, seed=4):
    """(t, force, rate rad/s) of a thing that is turned about and then held for three seconds, in
    which it trembles at 2 to 6 Hz and turns on by some deg/s, so that it ends at other angles."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate_hz)
    held = 1.0 / (1.0 + np.exp(-4.0 * (np.abs(t - 11.0) - 1.7)))[:, None]

    def waves(hz, size):
        each = rng.uniform(*hz, (6, 3)), rng.uniform(0.0, 2.0 * np.pi, (6, 3))
        return size * np.sin(2.0 * np.pi * each[0] * t[:, None, None] + each[1]).sum(axis=1)

    rate = held * waves((0.2, 1.5), 25.0) + (1.0 - held) * (
        waves((2.0, 6.0), 0.8) + [-1.7, -0.7, 1.3])
    turns = Rotation.from_rotvec(np.radians(rate) / rate_hz)
    turn, turned = Rotation.identity(), []
    for step in turns:
        turned.append(turn)
        turn = turn * step
    moved = held * waves((0.5, 3.0), 0.4) + (1.0 - held) * waves((2.0, 6.0), 0.05)
    return t, Rotation.concatenate(turned).inv().apply(moved + [0.0, 0.0, G]), np.radians(rate)


def test_a_hand_that_holds_still_is_no_rest_and_how_it_turns_on_no_bias():
    """What it turned by in two calm seconds was set as the simulator's bias, on top of what the
    two differ by."""
    t, force, rate = in_a_hand()
    off = np.array([-0.4, -0.25, 0.3])
    real = read(t, force, rate, 1, off)
    assert not traces.trace_from_capture("hand", real).rests
    found = comparison.compare([("real", real)], "sim", read(t, force, rate, 2))
    assert found.alignment.same
    told = {p.axis: p for p in found.parameters if (p.name, p.sensor) == ("bias", "gyro")}
    for axis, of_it in zip("xyz", off):
        assert told[axis].differs and told[axis].set_to == pytest.approx(of_it, abs=0.03)
    assert {(p.name, p.sensor) for p in found.differs} == {("bias", "gyro")} and not found.left


@pytest.mark.parametrize("swings, kept", [
    ("white, of any size that a simulator has", True), ("behind a slow filter", True),
    ("a gait", False), ("a tremor", False)])
@pytest.mark.parametrize("seconds", [0.7, 2.0, 8.0])
def test_what_swings_faster_than_its_means_show_is_no_rest(swings, kept, seconds):
    rng, t = np.random.default_rng(7), np.arange(0.0, seconds, 0.01)
    white = rng.standard_normal((len(t) + 200, 3))
    if swings == "a gait":
        rate = 6.0 * np.sin(2.0 * np.pi * (1.9 * t[:, None] + [0.1, 0.4, 0.7])) + 0.4 * white[200:]
    elif swings == "a tremor":
        rate = sum(1.5 * np.sin(2.0 * np.pi * hz * t[:, None] + [hz, 2.0 * hz, 3.0 * hz])
                   for hz in (2.3, 3.1, 4.4, 5.7)) + 0.05 * white[200:]
    elif swings == "behind a slow filter":  # of 5 Hz, a density of 0.03 deg/s
        rate = 0.3 * lfilter([0.27], [1.0, -0.73], white, axis=0)[200:]
    else:  # 0.2 deg/s per root Hz
        rate = 2.0 * white[200:]
    found = rest_or_course.resting(rate + [0.4, -1.1, 0.2], [(0, len(t))], 100.0, 0.002, 0.015)
    assert found == ([(0, len(t))] if kept else [])
