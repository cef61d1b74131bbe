"""A simulated robot that never leans far, of another motion than the real one's: what its gyro's
axes are shows in where gravity goes as it turns on a slope."""
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.diagnosis.simulator import comparison
from tests.worlds.tumbled import RATE_HZ, read


def on_slope(seed, degrees=8.0):
    """(t, specific force g, rate deg/s) of a robot that turns on the spot on a slope, stops,
    drives over a bump and stops."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 150.0, 1.0 / RATE_HZ)
    speed, bump = np.zeros(len(t)), np.zeros(len(t))
    for start in np.arange(5.0, 145.0, 10.0):
        on_its_way = (t > start) & (t < start + 3.0)
        shape = on_its_way * np.sin((t - start) * np.pi / 3.0) ** 2
        speed += rng.choice([-1.0, 1.0]) * rng.uniform(30.0, 60.0) * shape
        bump += 4.0 * shape * np.sin(2.0 * np.pi * (t - start) / 1.5)
    heading = np.cumsum(speed) / RATE_HZ
    turn = Rotation.from_euler("x", degrees, degrees=True) * Rotation.from_euler(
        "ZY", np.column_stack([heading, bump]), degrees=True)
    rate = np.degrees((turn[:-1].inv() * turn[1:]).as_rotvec()) * RATE_HZ
    return t, turn.as_matrix()[:, 2, :], np.vstack([rate, rate[-1:]])


def compared(change):
    t, force, rate = on_slope(2)
    return comparison.compare([("real", read(*on_slope(1), 1))], "sim", read(
        t, force, change(rate), 101))


def test_a_turned_sign_of_the_gyro_is_the_gyros():
    """It was the accelerometer's axes, or gravity that stays where it is: the gyro was not asked
    where nothing leans by twenty degrees."""
    found = compared(lambda rate: rate * (1.0, 1.0, -1.0))
    assert not found.alignment.same and found.conventions
    for convention in found.conventions:
        assert "gyro_axes" in {convention.name, *convention.one_of}


def test_a_healthy_one_has_nothing():
    found = compared(np.copy)
    assert not found.alignment.same and found.conventions == ()


def test_what_follows_nothing_has_no_name():
    """The gyro of another robot."""
    other = on_slope(7)[2]
    found = compared(lambda rate: 3.0 * np.roll(other, 777, axis=0)[:, [1, 2, 0]])
    assert all(convention.name == "unknown" and not convention.one_of
               for convention in found.conventions)


@pytest.mark.parametrize("rows", [1, 2, 40, 200])
def test_a_log_of_a_moment_is_told_of_and_breaks_nothing(rows):
    """An attitude filter had not settled before a log of two seconds ended."""
    t, force, rate = (values[200:200 + rows] for values in on_slope(1))
    t = t - t[0]
    found = comparison.compare([("real", read(t, force, rate, 1))], "sim",
                               read(t, force, rate, 101))
    assert found.task is None and any("task was not tried" in remark for remark in found.remarks)
