"""A gyro whose axes are turned over in a log that hardly rests: gravity goes the other way."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import stray_turns
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.experiment import blocks

RATE, G = 100.0, 9.80665


def carried(rate, arm_m, push):
    """(n, 3) m/s2 at a place arm_m off the point that it is turned about."""
    up, force = np.array([0.1, -0.2, 1.0]), np.empty_like(rate)
    up, slope = up / np.linalg.norm(up), np.gradient(rate, axis=0) * RATE
    for k, w in enumerate(rate):
        up = up - np.cross(w, up) / RATE
        up /= np.linalg.norm(up)
        force[k] = G * up + np.cross(slope[k], arm_m) + np.cross(w, np.cross(w, arm_m))
    return force + push


def log(force, rate, seed=1):
    rng = np.random.default_rng(seed)
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 65.5}
    accel = np.rint((force + rng.normal(0.0, 0.02, force.shape)) * 8192.0 / G)
    gyro = np.rint(65.5 * (np.degrees(rate) + rng.normal([1.0, -0.6, 0.4], 0.05, rate.shape)))
    return Capture(meta, np.rint(np.arange(len(force)) * 1e6 / RATE).astype(np.int64),
                   accel.astype(np.int16), gyro.astype(np.int16))


def of_a_hand(seed, seconds=40.0):
    rng, t = np.random.default_rng(seed), np.arange(0.0, seconds, 1.0 / RATE)[:, None]

    def waves(size, low, high):
        return sum(rng.normal(0.0, size, 3) * np.sin(2.0 * np.pi * f * t + rng.uniform(
            0.0, 6.3, 3)) for f in rng.uniform(low, high, 10))
    rate = waves(0.4, 0.1, 0.8)
    return carried(rate, [0.2, 0.1, -0.1], waves(0.15, 0.3, 3.0)), rate


def of_a_wheel(seconds=60.0):
    """Tilted, to and fro at two rates: what the arm makes is as large as gravity."""
    t = np.arange(0.0, seconds, 1.0 / RATE)
    turn = np.interp(t % 20.0, [0, 2, 8, 12, 18, 20], [0.0, 3.0, 3.0, -3.0, -3.0, 0.0])
    rate = np.stack([0.0 * t, 0.0 * t, turn], 1)
    return carried(rate, [0.35, 0.0, 0.0], 0.0), rate


def found(force, rate):
    return stray_turns.swapped_on_the_way([blocks.session_of("log", log(force, rate))])


@pytest.mark.parametrize("order, told", [
    (np.diag([1.0, 1.0, -1.0]), {"z": -3}), (np.diag([-1.0, 1.0, 1.0]), {"x": -1}),
    (np.eye(3)[[1, 0, 2]], {"x": 2, "y": 1})])
def test_the_order_of_a_gyro_is_told_by_what_turns_in_a_hand(order, told):
    force, rate = of_a_hand(1)
    one, = found(force, rate @ order.T)
    assert (one.sensor, one.value) == ("gyro", told) and one.share > 0.7


@pytest.mark.parametrize("logged", [of_a_hand(2), of_a_wheel()], ids=["hand", "wheel"])
def test_sound_axes_are_no_others(logged):
    assert found(*logged) == []


@pytest.mark.parametrize("seed", range(4))
def test_who_walks_has_no_other_order_of_axes(seed):
    """A gyro whose z was turned over explained 73 % of what the force did by a hip's sway."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 60.0, 1.0 / RATE)
    step = 2.0 * np.pi * np.cumsum(0.9 * (1.0 + 0.02 * rng.normal(0.0, 1.0, len(t)))) / RATE
    lean = np.radians([2.0, 3.0, 6.0]) * np.stack([
        np.sin(step), np.sin(2.0 * step + 0.5), np.sin(step + 0.4)], 1)
    rate = np.gradient(lean, axis=0) * RATE
    sway = np.stack([0.02 * np.sin(2.0 * step), 0.06 * np.sin(step), 0.03 * np.cos(2.0 * step)],
                    1)
    push = np.gradient(np.gradient(sway, axis=0), axis=0) * RATE ** 2
    assert found(carried(rate, [0.0, 0.0, 0.0], push), rate) == []


def test_what_shakes_without_turning_has_no_order_of_axes():
    force, rate = of_a_hand(3)
    assert found(force[::-1], rate) == []


@pytest.mark.long
def test_a_turned_sign_is_not_no_gap():
    """A log of three minutes in a hand, at rest at both ends, was "no gap"."""
    (force, rate), still = of_a_hand(4, 60.0), np.zeros((800, 3))
    ends = [still + [0.0, 0.0, G], still + force[-1]]
    answer = diagnose([("log", log(np.concatenate([ends[0], force, ends[1]]), np.concatenate(
        [still, rate * [1.0, 1.0, -1.0], still])))])
    assert answer.verdict in ("explained", "partly explained")
    assert [(f.effect, f.value) for f in answer.findings] == [("axis_swap", {"z": -3})]
