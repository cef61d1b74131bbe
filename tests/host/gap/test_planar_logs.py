"""What turns about one axis only, as all that drives on a floor does, beside its simulator: most
channels read gravity or noise and nothing else, and are no reason to accuse it."""
import numpy as np
import pytest

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.simulator import (
    comparison,
    convention_findings,
    log_rests,
    noise_and_registers,
    single_log,
)
from tests.worlds.tumbled import META, RATE_HZ, read

SWAPPED = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # y reads z, z reads -y


def driven(seed=1, seconds=100.0):
    """(t, specific force g, rate deg/s) of what drives on a level floor, with stops."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 20.0 - 4.0, 19.5 - t % 20.0) / 1.5, 0.0, 1.0)
    way = way ** 2 * (3.0 - 2.0 * way)
    yaw = way * sum(size * np.sin(2.0 * np.pi * hz * t + rng.uniform(0.0, 6.0))
                    for size, hz in ((40.0, 0.11), (30.0, 0.23)))
    speed = (0.6 + 0.3 * np.sin(2.0 * np.pi * 0.17 * t)) * way
    along, across = np.gradient(speed, t) / 9.81, speed * np.radians(yaw) / 9.81
    return (t, np.stack([along, across, np.ones_like(t)], 1),
            np.outer(yaw, [0.0, 0.0, 1.0]))


def without_noise(t, force, rate):
    return Capture(dict(META), np.rint(1e6 * t).astype(np.int64),
                   np.rint(force * 8192).astype(np.int16), np.rint(rate * 65.5).astype(np.int16))


def compared(simulated):
    return comparison.compare([("real", read(*driven(), 1))], "sim", simulated)


def named(found):
    return {(c.name, c.sensor) for c in found.conventions}


def closed(found):
    return all(after < 1.2 * noise for _, after, noise in found.gap.values())


def test_a_simulator_without_noise_that_stays_level_has_no_constant_channel():
    """Gravity of 1 g throughout was the end of its range, and its channels said nothing."""
    found = compared(without_noise(*driven()))
    assert not found.conventions and not found.unseen
    assert {p.name for p in found.differs} == {"noise_density"}
    assert set(found.gap) == {"accel", "gyro"} and closed(found)


@pytest.mark.parametrize("simulated", [without_noise, lambda *log: read(*log, 9)])
def test_swapped_axes_of_what_turns_about_one_axis(simulated):
    """The channel that reads no turn any more was constant."""
    t, force, rate = driven()
    found = compared(simulated(t, force @ SWAPPED.T, rate @ SWAPPED.T))
    assert named(found) == {("both_axes", "device")}
    (axes,) = found.conventions
    assert axes.value == {"x": "x", "y": "z", "z": "-y"}
    assert closed(found)


def test_an_accelerometer_s_axes_swapped_alone():
    t, force, rate = driven()
    found = compared(read(t, force @ SWAPPED.T, rate, 9))
    assert named(found) == {("accel_axes", "accel")} and closed(found)


def test_a_channel_that_nothing_answers_in_place_of_is_constant():
    t, force, rate = driven()
    found = compared(without_noise(t, force * [1.0, 0.0, 1.0], rate))
    assert named(found) == {("constant_channel", "accel")}
    assert found.conventions[0].value == {"y": 0.0}


def test_what_never_changes_does_not_stop_at_the_end_of_a_range():
    assert single_log.limit(np.full(100, 8192.0)) is None
    assert single_log.limit(np.clip(9000.0 * np.sin(np.arange(300) / 9.0), -8192, 8192)) == 8192.0


def test_what_drives_on_is_no_rest_of_a_log_whose_gyro_says_nothing():
    """Slow accelerations were noise: the real one was said to have a sixth of it."""
    t, force, rate = driven()
    found = compared(read(t, force, 0.0 * rate, 9))
    assert not [p for p in found.differs if p.name == "noise_density"]


def test_what_drives_on_is_no_rest_of_a_log_without_a_gyro():
    """92 of its 100 s were."""
    t, force, rate = driven()
    capture = read(t, force, rate, 9)
    capture.gyro = None
    rests, _, _ = log_rests.of_capture(capture, RATE_HZ)
    assert rests and sum(end - first for first, end in rests) < 0.4 * len(t)
    still = np.abs(rate[:, 2]) < 0.1
    assert all(still[first:end].mean() > 0.8 for first, end in rests)


@pytest.mark.parametrize("asked, told", [(1, True), (2, False)])
def test_a_noise_by_the_root_of_the_rate_is_asked_of_the_sensors_that_there_are(asked, told):
    """Of a log without a gyro, too, every second one was taken to have it in one sensor alone."""
    found = convention_findings.finding("noise_per_sample", "accel", 0.97, 4.0,
                                        value={"factor": 10.0}, unit="1")
    assert bool(noise_and_registers.merged_noise([found], asked)) is told


@pytest.mark.parametrize("accel, gyro, name", [
    ([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], ("force_sign", "accel")),
    ([1.0, 1.0, 1.0], [1.0, 1.0, -1.0], ("gyro_axes", "gyro")),
    ([1.0, -1.0, -1.0], [1.0, -1.0, -1.0], ("both_axes", "device"))])
def test_a_sign_is_no_scale_of_less_than_nothing_and_no_bias_of_twice_gravity(accel, gyro, name):
    """A yaw turned over was a scale that is off by -200 %, an upright axis turned over a bias of
    2 g: x forward, y left and z up read as forward, right and down is the commonest of them."""
    t, force, rate = driven()
    found = compared(read(t, force * accel, rate * gyro, 9))
    assert named(found) == {name} and closed(found)
    assert not [p for p in found.differs if p.name in ("scale", "bias")]


@pytest.mark.parametrize("name, times", [("no_gravity", 0.0), ("gravity_sign", -1.0)])
def test_a_robot_on_springs_whose_simulator_gets_gravity_wrong(name, times):
    """Its gyro's cross axes make a degree of tilt of each turn, beside the third of a degree by
    which it rolls on its way: that was a lever arm of 34 cm below an axis turned over."""
    t, force, rate = driven()
    way = np.abs(rate[:, 2]) / np.abs(rate[:, 2]).max()
    roll = np.radians(0.3) * np.sin(2.0 * np.pi * 1.1 * t) * np.sqrt(way)
    up = np.stack([0.0 * t, np.sin(roll), np.cos(roll)], 1)
    moved = force - [0.0, 0.0, 1.0]
    turns = rate + np.outer(np.degrees(np.gradient(roll, t)), [1.0, 0.0, 0.0])
    crooked = np.array([[1.0, 0.0, 0.012], [0.0, 1.0, -0.01], [0.0, 0.0, 1.0]])
    real = read(t, moved + up, turns @ crooked.T, 1)
    found = comparison.compare([("real", real)], "sim", read(t, moved + times * up, turns, 9))
    assert named(found) == {(name, "accel")}


def test_a_floor_that_slopes_is_no_fault_of_a_simulator_whose_floor_is_level():
    """Two degrees of a yard: its gravity was added after the rotation, with certainty."""
    t, force, rate = driven()
    heading = np.radians(np.cumsum(rate[:, 2]) / RATE_HZ)
    along = np.stack([np.cos(heading), -np.sin(heading), 0.0 * t], 1)
    sloping = force + np.sin(np.radians(2.0)) * along
    found = comparison.compare([("real", read(t, sloping, rate, 1))], "sim",
                               read(t, force, rate, 9))
    assert not found.conventions and closed(found)
    slope, = found.differs
    assert slope.name == "slope" and slope.difference == pytest.approx(2.0, abs=0.05)
    assert "2.0" in slope.how


@pytest.mark.parametrize("kind", ["gyro", "accel"])
def test_another_unit_of_what_stays_level_is_no_scale_and_no_time_step(kind):
    """What a unit takes off the noise was held against it, as if a fit had: rates in rad/s were a
    time step of .0487, and forces in g a gravity that a bias made."""
    simulated = read(*driven(), 9)
    per, factor = {"gyro": ("gyro_lsb_per_dps", 180.0 / np.pi),
                   "accel": ("accel_lsb_per_g", 9.80665)}[kind]
    simulated.meta[per] *= factor
    found = compared(simulated)
    assert named(found) == {(kind + "_unit", kind)}
    before, after, _ = found.gap[kind]
    assert after < 0.05 * before
