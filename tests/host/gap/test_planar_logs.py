"""What turns about one axis only, as all that drives on a floor does, beside its simulator: most
channels read gravity or noise and nothing else, and are no reason to accuse it."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.settings import Settings
from sixflip_host.diagnosis.simulator import (
    against_simulator,
    comparison,
    convention_findings,
    conventions,
    log_rests,
    motion_match,
    noise_and_registers,
    sensor_axes,
    single_log,
    traces,
)
from sixflip_host.experiment import blocks
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
    """Its gyro's cross axes make a degree of tilt of each turn, beside the half degree by
    which it rolls on its way: that was a lever arm of 34 cm below an axis turned over."""
    t, force, rate = driven()
    way = np.abs(rate[:, 2]) / np.abs(rate[:, 2]).max()
    roll = np.radians(0.6) * np.sin(2.0 * np.pi * 1.1 * t) * np.sqrt(way)
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


def always_turning(seed=None):
    """The Capture of what turns about z all the time, by 4.5 to 18 deg/s on a level floor, and
    hardly drives; without noise, or of a sensor that has some and reads otherwise. Where it turns
    slowest somebody took it for a rest."""
    t = np.arange(0.0, 40.0, 0.08)
    yaw = 4.5 + 13.5 * np.sin(0.15 * t) ** 4
    force, rate = np.outer(np.ones_like(t), [0.0, 0.002, 1.0]), np.outer(yaw, [0.0, 0.0, 1.0])
    force[:, 0] = 0.001 * np.sin(0.3 * t)
    if seed is not None:
        rng = np.random.default_rng(seed)
        force = force + [0.005, -0.003, 0.012] + rng.normal(0.0, 0.001, force.shape)
        rate = rate * 1.03 + [0.55, -0.86, 0.45] + rng.normal(0.0, 0.17, rate.shape)
    meta = {**META, "rate_hz": 12.5, "accel_lsb_per_g": 16384, "gyro_lsb_per_dps": 1000, "poses":
            "found"}
    pose = np.where(np.abs(np.sin(0.15 * t)) < 0.4, 5, 0).astype(np.int16)
    return Capture(meta, np.rint(1e6 * t).astype(np.int64), np.rint(force * 16384).astype(
        np.int16), np.rint(rate * 1000.0).astype(np.int16), pose=pose)


def test_what_turns_about_one_axis_all_the_time_is_compared_by_how_it_turns():
    """By its forces, noise of 1 mg, it was another motion, its slow turns were rests of a bias of
    5 deg/s, and z of the accelerometer, which reads gravity alone, was constant."""
    found = comparison.compare([("real", always_turning(3))], "sim", always_turning())
    assert found.alignment.same and found.alignment.by == "turn rates"
    assert not found.conventions and not log_rests.of_capture(always_turning(3), 12.5)[0]
    numbers = {(p.name, p.axis): p.difference for p in found.differs if p.sensor == "gyro"}
    assert numbers["scale", "z"] == pytest.approx(3.0, abs=0.4)
    assert numbers["bias", "z"] == pytest.approx(0.45, abs=0.1)


def test_an_axis_along_which_nothing_moves_is_not_stuck_in_a_simulator_without_noise():
    simulated = against_simulator.read([blocks.session_of("sim", always_turning())], Settings())
    assert simulated.remarks and not [said for said in simulated.remarks if "stuck" in said]


def plate(up, bias, seed, bursts=()):
    """A Trace of what lies still for two minutes, and is knocked now and then."""
    rng, n = np.random.default_rng(seed), 12000
    force = rng.normal(0.0, 0.004, (n, 3)) + up
    for first in bursts:
        force[first:first + 50] += rng.normal(0.0, 0.02, (50, 3))
    t = np.arange(n) / RATE_HZ
    return traces.trace_from_capture(str(seed), read(t, force, np.tile(bias, (n, 1)), seed))


def test_what_lies_still_otherwise_is_of_no_motion_and_has_no_convention_for_it():
    """Two on one plate were "of different motions (correlation 0.14)", and one of them lay by some
    convention that is wrong at 1.0."""
    real, sim = plate([0.0, 0.6, 0.8], [1.0, 0.0, 0.0], 1), plate(
        [0.8, 0.0, -0.6], [0.0, 0.5, 0.0], 2, bursts=(3000, 7000))
    found = comparison.compare_traces(real, sim, motion_match.aligned(real, sim))
    assert not found.alignment.same and not found.alignment.moving and not found.conventions
    assert any("no motion to be compared" in said for said in found.remarks)
    assert {p.axis for p in found.differs if (p.name, p.sensor) == ("bias", "gyro")} == {"x", "y"}


@pytest.mark.parametrize("said, named", [((), set()), (("time_step",), {"time_step"})])
def test_a_time_step_is_that_of_both_sensors(said, named):
    """Seven nats were too few for a car's gyro beside an accelerometer whose time step was wrong:
    it had scales of -50 %, and biases of the turn that was missed."""
    fits = [SimpleNamespace(name=name, log=log, axes=np.eye(3), unit=1.0, extra=np.array([-0.5]),
                            extra_sigma=np.array([0.01]), shape=np.zeros((3, 3)))
            for name, log in (("healthy", 5329.4), ("time_step", 5336.4))]
    found, best = conventions.posterior(
        "gyro", fits, np.ones(3, bool), lambda fit: fit, None, said)
    assert {c.name for c in found} == named
    assert best.name == ("time_step" if named else "healthy")


def of_a_joint(seed=2, seconds=90.0):
    """(t, specific force g, rate deg/s) of an arm that a joint turns about y, with stops."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 18.0 - 4.0, 17.5 - t % 18.0) / 1.5, 0.0, 1.0)
    rate = way * sum(size * np.sin(2.0 * np.pi * hz * t + rng.uniform(0.0, 6.0))
                     for size, hz in ((35.0, 0.13), (25.0, 0.31), (12.0, 0.9)))
    pitch = np.radians(np.cumsum(rate) / RATE_HZ)
    return (t, np.stack([-np.sin(pitch), np.zeros_like(t), np.cos(pitch)], 1),
            np.outer(rate, [0.0, 1.0, 0.0]))


def test_a_joint_s_gyro_that_feels_gravity_across_it_accuses_no_simulator():
    """The simulator's x and z, about which nothing turns, "never change"; or it did something that
    no convention explains, since the real one's noise there was taken back by a scale of 0.5."""
    t, force, rate = of_a_joint()
    found = comparison.compare([("real", read(t, force, rate + 0.15 * force, 1))], "sim",
                               read(t, force, rate, 9))
    assert not found.conventions
    assert all(p.axis == "y" for p in found.parameters if p.name == "scale" and p.differs)


def test_an_axis_that_reads_what_others_and_forces_make_of_it_has_no_scale():
    t, force, rate = of_a_joint()
    askew = rate + 0.15 * force + np.outer(rate[:, 1], [0.01, 0.0, -0.02])
    noise = 0.05 * np.random.default_rng(3).standard_normal(rate.shape)
    widths = sensor_axes.turning(askew + noise, force, np.full(3, 0.05))
    assert (widths[:, 1] == sensor_axes.SHAPE).all()
    assert (widths[:, [0, 2]] < 1e-3 * sensor_axes.SHAPE).all()
    turned = askew + noise + np.outer(np.sin(0.9 * t), [1.0, 0.0, 0.0])
    assert (sensor_axes.turning(turned, force, np.full(3, 0.05))[:, 0] == sensor_axes.SHAPE).all()
