"""Rotation over a move: order of the integration, its derivatives, the angle about an axis."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.calibrate import gyro_moves
from sixflip_host.capture import attitude

PERFECT = np.hstack([np.eye(3), np.zeros((3, 4))])


def rates(t):
    """A smooth move of 3 s that starts and ends at rest, rad/s."""
    swing = np.stack([3 * np.sin(2 * t), 2 * np.cos(3 * t), np.ones_like(t)], axis=-1)
    return 2 * swing * (np.sin(np.pi * t / 3) ** 2)[..., None]


def truth():
    fine = np.arange(0, 3, 1e-4)
    out = np.eye(3)
    for step in Rotation.from_rotvec(rates(fine + 5e-5) * 1e-4).as_matrix():
        out = out @ step
    return out


def sampled(interval):
    t = np.arange(0, 3 + interval / 2, interval)
    return gyro_moves.of_samples(rates(t), np.zeros((len(t), 3)), t, [(0, len(t) - 1)])


def test_fourth_order_on_a_smooth_move():
    exact = truth()
    coarse, fine = [
        np.abs(attitude.matrix(sampled(h).rotate(PERFECT)[0][0]) - exact).max()
        for h in (0.04, 0.02)
    ]
    assert fine < 1e-6
    assert coarse / fine > 12  # 16 for a fourth-order rule, 4 for the trapezoid


@pytest.mark.parametrize("column", range(21))
def test_derivatives_are_those_of_the_rotation(column):
    rng = np.random.default_rng(2)
    t = np.arange(0, 3.005, 0.01)
    force = rng.normal(0, 1, (len(t), 3))
    moves = gyro_moves.of_samples(rates(t), force, t, [(0, 300), (0, 120), (40, 299)])
    before, change = moves.rotate(PERFECT)
    shift = np.zeros(21)
    shift[column] = 1e-6
    after, _ = moves.rotate(PERFECT + shift.reshape(3, 7))
    turned = np.swapaxes(attitude.matrix(before), 1, 2) @ attitude.matrix(after)
    got = Rotation.from_matrix(turned).as_rotvec() / 1e-6
    assert np.abs(got - change.reshape(3, 3, 21)[:, :, column]).max() < 2e-3


def test_moves_of_different_length_do_not_disturb_each_other():
    t = np.arange(0, 3.005, 0.01)
    zero = np.zeros((len(t), 3))
    both, _ = gyro_moves.of_samples(rates(t), zero, t, [(0, 300), (10, 50)]).rotate(PERFECT)
    alone, _ = gyro_moves.of_samples(rates(t), zero, t, [(10, 50)]).rotate(PERFECT)
    assert np.abs(both[1] - alone[0]).max() < 1e-14


@pytest.mark.parametrize("degrees", [-175.0, -90.0, 3.0, 170.0, 185.0])
def test_turn_about_an_axis(degrees):
    axis = np.array([0.0, 0.0, -1.0])
    q = attitude.exponential(np.radians(degrees) * axis)
    turn = np.degrees(gyro_moves.turn_about(q, axis))
    assert abs((turn - degrees + 180) % 360 - 180) < 1e-9
