"""The zoo's small form: one engine run of each kind, every documented defect once."""
import functools
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the zoo needs MuJoCo: pip install 'sixflip[test]'")

from sixflip_host.capture import capture_file  # noqa: E402
from sixflip_host.diagnosis.diagnose import diagnose  # noqa: E402
from sixflip_host.diagnosis.simulator import comparison, simulator_answer  # noqa: E402
from tests.studies.zoo import (
    defects,  # noqa: E402
    engine,  # noqa: E402
)


@functools.cache
def motion(kind, seed):
    if kind == "rover":
        return engine.rover(seed, "arm", 40.0)
    return engine.box(seed, "arm", quick=True)


def compared(name, kind="box", same=True, effect="", own=True):
    texts = defects.pair(name, motion(kind, 1), motion(kind, 1 if same else 2), 21, effect, own)
    real, sim = (capture_file.parse("log", text.encode()) for text in texts)
    return comparison.compare([("real.csv", real)], "sim.csv", sim)


def names(found):
    return {c.name for c in found.conventions} | {
        n for c in found.conventions for n in c.one_of} | {p.name for p in found.differs}


@pytest.mark.parametrize("kind,same", [("box", True), ("rover", True), ("box", False)])
def test_a_healthy_simulator_has_no_finding(kind, same):
    found = compared("healthy", kind, same, own=False)
    assert found.alignment.same == same
    assert not found.conventions and not found.differs
    assert simulator_answer.verdict("cannot tell" if kind == "rover" else "no gap",
                                    [found]) == "no gap"


@pytest.mark.parametrize("same", [True, False])
def test_a_robot_that_settles_in_its_rests_is_no_gap(same):
    """Its short rests wander, and bumps shake it, in the simulator's log as in the real one."""
    texts = defects.pair("healthy", motion("rover", 1), motion("rover", 1 if same else 2), 21,
                         "", False)
    logs = [capture_file.parse("log", text.encode()) for text in texts]
    found = diagnose([("real.csv", logs[0])], [("sim.csv", logs[1])])
    assert found.verdict == "no gap"
    assert any("settles" in said for said in found.remarks)


@pytest.mark.parametrize("name,wanted", [("constant", "constant_channel"),
                                         ("no_noise", "noise_density"), ("no_range", "range")])
def test_a_rover_on_another_way_shows_what_needs_no_motion(name, wanted):
    found = compared(name, "rover", same=False, own=False)
    assert {(n.name, n.sensor) for n in (*found.conventions, *found.differs)} <= {
        (wanted, "accel"), (wanted, "gyro")}
    assert (wanted, "accel") in {(n.name, n.sensor) for n in (*found.conventions, *found.differs)}


NUMBERED = [n for n, d in defects.DEFECTS.items() if d[2]]


@pytest.mark.long
@pytest.mark.parametrize("name", NUMBERED)
def test_a_defect_is_named_in_its_layer(name):
    _, _, right, layer, _ = defects.DEFECTS[name]
    wanted = tuple("smoothness" if n == "bandwidth" else "noise_density" if n == "noise" else n
                   for n in right)
    effect = defects.EFFECTS[len(name) % 5] if layer == "conventions" else ""
    found = compared(name, effect=effect, own=layer == "conventions")
    if layer == "conventions":
        assert {c.name for c in found.conventions} <= set(wanted)
        assert found.conventions
    else:
        assert not found.conventions
        assert {p.name for p in found.differs} == {wanted[0]}


@pytest.mark.long
def test_a_step_of_time_and_a_lever_arm_have_their_sizes():
    factor = compared("motion_times_4").conventions[0].value["factor"]
    assert factor == pytest.approx(4.0, rel=0.05)
    arm = compared("no_lever_arm").conventions[0].value
    assert [arm[a] for a in "xyz"] == pytest.approx([4.0, -1.5, 2.0], abs=0.2)


@pytest.mark.parametrize("name", ["no_gravity", "world_rates", "gyro_mirrored"])
def test_another_motion_shows_it_as_well(name):
    found = compared(name, same=False)
    assert not found.alignment.same
    assert {c.name for c in found.conventions} == {defects.DEFECTS[name][2][0]}


def test_parameters_are_given_back_with_their_intervals():
    texts = defects.pair("healthy", motion("box", 1), motion("box", 1), 5)
    real, sim = (capture_file.parse("log", t.encode()) for t in texts)
    part = defects.real_part(np.random.default_rng(5))
    found = comparison.compare([("real.csv", real)], "sim.csv", sim)
    for p in found.parameters:
        if p.name in ("scale", "misalignment"):
            i, j = "xyz".index(p.axis[0]), "xyz".index(p.axis[-1])
            true = (part.accel if p.sensor == "accel" else part.gyro)[i, j] - (i == j)
            true *= 100.0 if i == j else 180.0 / np.pi
            low, high = p.difference_interval
            wide = 4.0 * (high - low) / 2.0 + 0.02
            assert abs(p.difference - true) < wide, p


def test_the_zoo_knows_nobody():
    """Its sensors and motions are made without a line of the project."""
    code = "import sys; from tests.studies.zoo import defects, engine; " \
        "assert engine and not [m for m in sys.modules if m.startswith('sixflip')]"
    subprocess.run([sys.executable, "-c", code], check=True,
                   cwd=Path(__file__).resolve().parents[3])


def test_a_rover_with_a_biased_accelerometer_has_no_scale_of_its_gyro():
    """Its rests lie alike: the bias turns gravity with the robot, as a scale would."""
    from sixflip_host.diagnosis.simulator import own_calibration, traces
    texts = defects.pair("healthy", motion("rover", 2), motion("rover", 2), 108)
    own = own_calibration.fitted(traces.trace_from_capture(
        "real", capture_file.parse("log", texts[0].encode())))
    part = defects.real_part(np.random.default_rng(108))
    off = np.abs(np.linalg.inv(own.gyro) - part.gyro)
    assert (off < 4.0 * own.gyro_sigma).all()


def late(sim):
    sim.gyro = np.roll(sim.gyro, 4, axis=0)


def coarse(sim):
    sim.accel = (np.rint(sim.accel / 64.0) * 64).astype(np.int16)


def offset(sim):
    sim.accel = sim.accel - np.array([245, 0, 0], np.int16)


@pytest.mark.parametrize("change,conventions,differs", [
    (lambda sim: None, set(), set()), (offset, set(), {("bias", "accel", "x")}),
    (late, {"gyro_delay"}, {("delay", "gyro", "")}),
    (coarse, set(), {("step", "accel", axis) for axis in "xyz"})])
def test_a_log_made_of_the_real_ones_own_samples_has_its_noise_as_well(
        change, conventions, differs):
    """Such a log has no other scale for having the same noise, and no other time step."""
    text = defects.pair("healthy", motion("box", 1), motion("box", 1), 21, own=False)[0]
    real, sim = (capture_file.parse("log", text.encode()) for _ in range(2))
    change(sim)
    found = comparison.compare([("real.csv", real)], "sim.csv", sim)
    assert {c.name for c in found.conventions} == conventions
    assert {(p.name, p.sensor, p.axis) for p in found.differs} == differs
