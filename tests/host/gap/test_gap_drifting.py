"""Drift: a random walk of every axis. What sways, jumps or moves them together is none."""
import copy

import numpy as np
import pytest

from sixflip_host.diagnosis import answer, diagnosis, localisation, rest_model
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session

SIZE_DPS = 0.15


@pytest.fixture(scope="module")
def captures():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 21})
    return [simulated_session.session(plan, k) for k in range(len(plan.worlds))]


def walk(generator, t, axes):
    """(n, axes) random walks with a standard deviation of SIZE_DPS over the session."""
    steps = generator.standard_normal((len(t), axes)).cumsum(axis=0)
    return SIZE_DPS * steps / np.sqrt(len(t))


def walks(generator, t):
    return walk(generator, t, 3)


def together(generator, t):
    return walk(generator, t, 1) @ np.array([[1.0, -0.8, 1.2]])


def one_axis(generator, t):
    return walk(generator, t, 1) @ np.array([[0.0, 1.0, 0.0]])


def sways(generator, t):
    phase = generator.uniform(0.0, 6.28, 3)
    return SIZE_DPS * np.sin(2.0 * np.pi * t[:, None] / 75.0 + phase)


def jumps(generator, t):
    return SIZE_DPS * (t > 0.4 * t[-1])[:, None] * np.array([[1.0, -0.7, 0.9]])


def moved(captures, course):
    """Sessions of the captures with course(generator, t) deg/s added to their gyros."""
    generator, sessions = np.random.default_rng(4), []
    for number, capture in enumerate(captures):
        one = copy.copy(capture)
        t = (capture.t_us - capture.t_us[0]) * 1e-6
        added = course(generator, t) * capture.meta["gyro_lsb_per_dps"]
        one.gyro = np.round(capture.gyro + added).astype(capture.gyro.dtype)
        sessions.append(blocks.of(str(number), one))
    return sessions


def diagnosed(captures, course):
    return diagnosis.of(moved(captures, course), diagnosis.Settings(jobs=1))


def test_a_random_walk_of_each_axis_drifts(captures):
    found = diagnosed(captures, walks)
    assert found.gaps["gyro"].drift and found.verdict == "explained"
    assert not found.gaps["accel"].drift
    assert not found.causes  # nothing slow that a walk follows by chance for a while


def test_a_slope_beside_a_walk_keeps_its_name(captures):
    warmest = max(c.temp.max() for c in captures)

    remaining = list(captures)

    def slope_too(generator, t):
        capture = remaining.pop(0)
        degrees = (capture.temp - warmest) / capture.meta["temp_lsb_per_c"]
        return 0.3 * walks(generator, t) + 0.4 * degrees[:, None] * np.array([[0.0, 1.0, 0.0]])

    found = diagnosed(captures, slope_too)
    (sensor, cause), = found.causes
    assert (sensor, cause.effect) == ("gyro", "thermal_bias") and "y" in cause.letters
    low, high = cause.interval["y"]
    assert low < 0.4 < high


@pytest.mark.parametrize("course", [together, one_axis, sways, jumps])
def test_what_is_no_random_walk_of_every_axis_is_not_called_drift(
        course, captures):
    """Asked of the gyro at rest alone: a third of the work."""
    sessions = moved(captures, course)
    gap = rest_model.RestModel("gyro", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        sessions, [attitude_fit.fit(session) for session in sessions])
    assert not gap.drift
    assert gap.unexplained
    assert any(place.domain == "time" for place in localisation.places(gap))


def test_a_drift_between_the_levels_tried_is_explained_and_has_its_size():
    """The levels of noise lie a factor of two apart there: what was left beside the nearest one
    was half as much again as noise, and the interval did not hold the size."""
    plan = scenario.from_dict({
        "sensor": "mpu6050", "scene": "recommended", "seed": 1,
        "world": {"placement_scatter_deg": 0.05}, "effects": [
            {"effect": "drift", "sensor": "accel", "x": 0.6, "y": 0.6, "z": 0.6, "seed": 1}]})
    sessions = []
    for number in range(2):
        capture = simulated_session.session(plan, number)
        capture.gyro = None
        sessions.append(blocks.of(str(number), capture))
    found = answer.of(diagnosis.of(sessions, diagnosis.Settings(jobs=1)))
    cause, = found["causes"]
    assert found["verdict"] == "explained" and cause["effect"] == "drift"
    for low, high in cause["interval_90"].values():
        assert low < 0.6 < high
