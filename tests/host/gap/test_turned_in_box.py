"""Guided sessions of six faces beside a simulator of another hand's motion: what they say of each
sensor's misalignment, and which of the two is turned in its box."""
import numpy as np
import pytest

from sixflip_host.diagnosis import diagnose
from sixflip_host.diagnosis.detect import wrong_scale
from sixflip_host.diagnosis.simulator import (
    comparison,
    own_calibration,
    parameters,
    traces,
    turned_in_box,
)
from sixflip_host.experiment import blocks
from sixflip_host.planning import next_capture
from tests.worlds import guided

OFF = ~np.eye(3, dtype=bool)


def turn_of(degrees, axis):
    """(3, 3) small turn as a sensor's matrix."""
    x, y, z = np.radians(degrees) * np.eye(3)[axis]
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def session(seed, **of_sensors):
    return traces.trace_from_capture("log %d" % seed, guided.session(seed, **of_sensors))


def misaligned(real, sim):
    """({(sensor, axis): degrees of the misalignments that differ}, sentences on what is not
    seen) of two Traces of different motions."""
    own = own_calibration.fitted(real), own_calibration.fitted(sim)
    turned, unseen = turned_in_box.as_the_box_says(real, sim, *own)
    numbers, _ = comparison.numbers_of(real, sim, sim, (turned, own[1]), {}, [])
    return {(p.sensor, p.axis): p.difference for p in numbers
            if p.differs and p.name == "misalignment"}, unseen


def random_misalignment(generator):
    return np.radians(generator.normal(0.0, 0.5, (3, 3))) * OFF


@pytest.mark.parametrize("seed", range(6))
def test_six_faces_and_their_moves_say_how_both_sensors_are_misaligned(seed):
    """Within intervals of a tenth of a degree: what the faces leave open of the accelerometer is
    none of the gyro's (half a degree of it passed for a gyro's, with intervals of 0.15)."""
    generator = np.random.default_rng(seed)
    accel, gyro = random_misalignment(generator), random_misalignment(generator)
    own = own_calibration.fitted(session(100 + seed, accel=accel, gyro=gyro))
    # The accelerometer's own frame: measured = symmetric · turn · force.
    left, sizes, right = np.linalg.svd(np.eye(3) + accel)
    of_accel = np.linalg.inv((left * sizes) @ left.T) - own.accel
    of_gyro = np.linalg.inv((np.eye(3) + gyro) @ (left @ right).T) - own.gyro
    for off, sigma in ((of_accel, own.accel_sigma), (of_gyro, own.gyro_sigma)):
        assert (np.abs(off) < 3.0 * sigma)[OFF].all()
        assert sigma[OFF].max() < np.radians(0.12)


@pytest.mark.parametrize("seed", range(6))
def test_a_right_simulator_of_other_hands_is_not_accused(seed):
    generator = np.random.default_rng(seed)
    accel, gyro = random_misalignment(generator), random_misalignment(generator)
    said, unseen = misaligned(*(
        session(first + seed, accel=accel, gyro=gyro) for first in (200, 300)))
    assert not said and not unseen


@pytest.mark.parametrize("axis", range(3))
def test_faces_say_that_it_is_the_accelerometer_that_is_turned(axis):
    """By one degree, which was one of the gyro."""
    i, j = (k for k in range(3) if k != axis)
    told = turn_of(1.0, axis)
    said, unseen = misaligned(session(400 + axis, accel=told), session(500 + axis))
    assert {key[0] for key in said} == {"accel"} and len(said) == 2 and not unseen
    for row, column in ((i, j), (j, i)):
        assert said["accel", "xyz"[row] + "xyz"[column]] == pytest.approx(
            np.degrees(told[row, column]), abs=0.15)


@pytest.mark.parametrize("axis", range(3))
def test_faces_say_that_it_is_the_gyro(axis):
    said, unseen = misaligned(session(600 + axis, gyro=turn_of(1.0, axis)), session(700 + axis))
    assert {key[0] for key in said} == {"gyro"} and len(said) == 2 and not unseen


def test_where_no_faces_are_known_the_turn_is_said_to_be_either():
    said, unseen = misaligned(session(800, accel=turn_of(1.0, 2), labels=False),
                              session(900, labels=False))
    assert {key[0] for key in said} == {"gyro"} and len(unseen) == 1
    assert " about z beside the other" in unseen[0] and unseen[0].endswith("be the gyro")


def test_the_faces_measure_a_turn_against_their_box():
    own = own_calibration.fitted(trace := session(1000, accel=turn_of(0.6, 1)))
    measured, sigma = turned_in_box.turn(trace, own)
    assert np.degrees(measured) == pytest.approx([0.0, 0.6, 0.0], abs=0.1)
    assert np.degrees(sigma).max() < 0.06
    assert parameters.DIFFERS * sigma.max() < np.radians(0.6)


@pytest.mark.parametrize("limit_dps", [60.0, 100.0])
def test_moves_in_which_the_gyro_was_cut_off_say_nothing_of_its_scale(limit_dps):
    """A scale of -10 +- 2 % of one that is right, and "turns 0.608 times as far as gravity"."""
    capture = guided.session(1100, limit_dps=limit_dps)
    own = own_calibration.fitted(traces.trace_from_capture("log", capture))
    assert (np.abs(own.gyro - np.eye(3)) < 3.0 * own.gyro_sigma).all()
    assert wrong_scale.findings([blocks.session_of("log", capture)]) == []


def test_a_unit_that_is_put_right_has_its_counts_too():
    """A gyro in rad/s in whole counts of 0.87 deg/s: its bias was known better than they tell, and
    its noise was 5.7e-149."""
    real, sim = (guided.session(seed) for seed in (1200, 1201))
    sim.gyro = np.rint(np.radians(sim.gyro)).astype(np.int16)
    found = comparison.compare([("real", real)], "simulator", sim)
    assert [(c.name, c.sensor) for c in found.conventions] == [("gyro_unit", "gyro")]
    assert [(p.name, p.axis) for p in found.differs if p.sensor == "gyro"] in (
        [], [("step", axis) for axis in "xyz"])


def test_what_was_found_alike_is_said_of_different_motions():
    """"This capture cannot tell", of two logs whose biases, scales and misalignments agree."""
    real, sim = (guided.session(seed) for seed in (1300, 1301))
    found = diagnose.diagnose([("real", real)], simulator=[("simulator", sim)])
    assert found.verdict == "cannot tell"
    assert next_capture.untold(found)["why"].startswith(
        "bias, fast noise, misalignment, noise density, scale are alike in both, but the two logs "
        "are of")
