"""Two sensors on one thing that lie otherwise than along each other's axes: one turn, and neither
misalignments of many times what parts have, nor biases beside other axes."""
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.diagnosis.simulator import comparison, convention_findings, sensor_axes
from tests.worlds.tumbled import read, tumbled

SWAP = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
BIAS_G = [0.05, -0.04, 0.06]


def compared(of_accel, of_gyro, bias=(0.0, 0.0, 0.0)):
    """Comparison of a simulator whose sensors read along such axes, (3, 3) each."""
    t, force, rate = tumbled(4, 45.0)
    return comparison.compare([("real", read(t, force + bias, rate, 1))], "sim", read(
        t, force @ of_accel.T, rate @ of_gyro.T, 2))


def turn(degrees, axis=(0.5, -0.6, 0.62)):
    return Rotation.from_rotvec(np.radians(degrees) * np.array(axis)
                                / np.linalg.norm(axis)).as_matrix()


@pytest.mark.parametrize("degrees, swap", [
    (12.0, np.eye(3)), pytest.param(27.0, SWAP, marks=pytest.mark.long)])
def test_a_sensor_that_lies_crooked_is_mounted_so(degrees, swap):
    """It had misalignments of 12 degrees and biases of 150 mg, each to be set."""
    axes = turn(degrees) @ swap
    found = compared(axes, axes, BIAS_G)
    assert [(c.name, c.sensor) for c in found.conventions] == [("both_mounting", "device")]
    value = found.conventions[0].value
    assert value["angle"] == pytest.approx(degrees, abs=0.5)
    assert sensor_axes.mounted(value) == pytest.approx(axes, abs=0.01)
    assert {(p.name, p.sensor) for p in found.differs} == {("bias", "accel")}
    for p in found.differs:
        assert p.difference == pytest.approx(1000.0 * BIAS_G["xyz".index(p.axis)], abs=4.0)
    assert all(after < 0.1 * before for before, after, _ in found.gap.values())
    counts = np.array([[8000, -3000, 1200]], dtype=np.int16)
    put_right = convention_findings._counts(
        np.rint(counts @ axes.T).astype(np.int16),
        convention_findings._matrix(found.conventions, "accel"))
    assert put_right == pytest.approx(counts, abs=80)


@pytest.mark.long
def test_a_gyro_alone_may_lie_crooked():
    found = compared(np.eye(3), turn(15.0))
    assert [(c.name, c.sensor) for c in found.conventions] == [("gyro_mounting", "gyro")]
    assert not found.differs


@pytest.mark.long
def test_what_axes_of_a_part_are_off_by_is_no_mounting():
    found = compared(turn(2.5), np.eye(3))
    assert not found.conventions
    assert ("misalignment", "accel") in {(p.name, p.sensor) for p in found.differs}


def test_the_turn_that_is_nearest_is_found_where_all_channels_follow():
    for degrees in (8.0, 30.0, 44.0):
        axes = turn(degrees) @ SWAP
        assert sensor_axes.turned(np.diag([1.03, 0.97, 1.01]) @ axes) == pytest.approx(
            axes, abs=0.03)
    assert sensor_axes.turned(turn(2.0)) is None  # of parts
    assert sensor_axes.turned(np.diag([1.0, 1.0, 0.2]) @ turn(20.0)) is None
    assert sensor_axes.turned(np.diag([1.0, 1.0, -1.0])) is None  # a mirror
