"""Which way a box lay in a capture without labels: six faces leave a sensor free to turn."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture import rests
from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import stray_turns
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session
from tests.worlds.unlabelled import FACES, unlabelled


@pytest.mark.parametrize("off_mg, deg", [(0.0, 2.0), (0.2, 2.0), (5.0, 10.0), (15.0, 10.0),
                                         (40.0, 10.0)])
def test_an_effect_turns_no_sensor_whose_poses_nobody_labelled(off_mg, deg):
    """Of 15 mg that follow the pose before a box was turned by 45 degrees: |f| = 1 was held to
    0.3 mg whatever the placements showed of it. Six faces leave the rest to what is known of any
    sensor."""
    nominal = attitude_fit.fit(unlabelled(off_mg))
    off = np.degrees(np.arccos(np.clip((nominal.up * FACES).sum(axis=1), -1.0, 1.0)))
    assert off.max() < deg


def test_a_sound_sensor_in_many_poses_keeps_its_lengths_to_a_fifth_of_a_thousandth():
    """Where the placements tell it |f| = 1 decides as before, labels or not."""
    true = np.eye(3) + 0.01 * np.array([[1.0, 0.6, -0.4], [0.0, -1.2, 0.8], [0.0, 0.0, 0.5]])
    up = np.random.default_rng(3).standard_normal((40, 3))
    up /= np.linalg.norm(up, axis=1)[:, None]
    read = 1000.0 * up @ np.linalg.inv(true).T
    session = SimpleNamespace(accel=read, placement=np.arange(40), labelled=False,
                              runs=tuple((0, 0, 0) for _ in up), placements=lambda: 40)
    matrix = attitude_fit.fit(session).matrix
    # A turn of all poses together is nobody's to tell: the lengths are.
    assert matrix.T @ matrix == pytest.approx(true.T @ true, abs=2e-4)


@pytest.mark.parametrize("up, turned", [
    ([[0, 0, 1], [0, 1, 0], [0, 0, -1], [0, -1, 0]], True),  # about one axis only
    ([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, -1, 0]], True), ([[0, 0, 1], [0, 0, -1]], False),
    ([[0.34, 0, 0.94], [0, 0.34, 0.94], [-0.34, 0, 0.94], [0, -0.34, 0.94]], False)])
def test_a_box_is_turned_over_and_a_robot_on_a_slope_of_20_degrees_is_not(up, turned):
    capture = Capture({"sensor": "other", "rate_hz": 100.0, "accel_lsb_per_g": 1000.0},
                      10_000 * np.arange(100 * len(up)),
                      np.repeat(1000 * np.array(up), 100, axis=0).astype(np.int16),
                      pose=np.repeat(np.arange(len(up)) + 13, 100).astype(np.int16))
    runs = [rests.Run(13 + k, 100 * k, 100 * k + 100) for k in range(len(up))]
    assert blocks.session_of("s", capture, runs).turned_over == turned


@pytest.mark.parametrize("order, sensor, value", [
    ([[0, 1, 0], [1, 0, 0], [0, 0, 1]], "accel", {"x": 2, "y": 1}),
    ([[-1, 0, 0], [0, 1, 0], [0, 0, 1]], "accel", {"x": -1}),
    ([[0, -1, 0], [1, 0, 0], [0, 0, 1]], "gyro", {"x": 2, "y": -1})])
def test_without_labels_the_fewest_axes_to_be_put_right_are_the_wrong_ones(order, sensor, value):
    """Two axes of the accelerometer that were swapped were three of the gyro's."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 5})
    capture = simulated_session.session(plan, 0)
    capture.pose = None
    capture.accel = capture.accel @ np.array(order, capture.accel.dtype).T
    session = blocks.session_of("swapped", capture)
    found = stray_turns.swapped([session], [attitude_fit.fit(session)])
    assert (found.sensor, found.value) == (sensor, value)
