"""Two logs of one motion that never rests: conventions and numbers are told by the pair."""
import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import (
    comparison,
    convention_findings,
    traces,
)
from sixflip_host.present import simulator_words
from tests.worlds.flown import G, flown, forces
from tests.worlds.tumbled import read

# Of the real sensors: what is read of force and rate, offsets in m/s2 and rad/s.
CROOKED = np.array([[1.012, 0.004, 0.0], [-0.006, 0.992, 0.008], [0.003, 0.0, 1.006]])
OFFSETS = {"accel": np.array([0.2, -0.3, 0.15]), "gyro": np.array([0.02, -0.03, 0.01])}


@pytest.fixture(scope="module")
def flight():
    return flown(2, seconds=40.0)


def real_log(flight, seed=1):
    t, turn, rate, _, acceleration = flight
    return read(t, (forces(turn, acceleration) @ CROOKED.T + OFFSETS["accel"]) / G,
                np.degrees(rate @ CROOKED.T + OFFSETS["gyro"]), seed)


def compared(flight, force, rate):
    return comparison.compare([("real", real_log(flight))], "sim", read(
        flight[0], force / G, np.degrees(rate), 101))


def as_real(force, rate):
    return force @ CROOKED.T + OFFSETS["accel"], rate @ CROOKED.T + OFFSETS["gyro"]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_vertical_is_known_without_a_rest(seed):
    """Half a g of what moves it, sensors that are off by a per cent and by a degree a second."""
    flight = flown(seed)
    trace = traces.trace_from_capture("it", real_log(flight, seed))
    assert not trace.rests
    found = traces.motion(trace)
    off = np.degrees(np.arccos(np.clip((found.up * flight[1][:, 2]).sum(axis=1), -1.0, 1.0)))
    assert np.sqrt((off ** 2).mean()) < 2.5 and off.max() < 6.0
    moved = np.einsum("nji,nj->ni", flight[1], flight[4])
    assert (found.moved - moved).std() < 0.12 * moved.std()


def test_a_healthy_pair_is_not_accused(flight):
    found = compared(flight, *as_real(forces(flight[1], flight[4]), flight[2]))
    assert found.alignment.same and not found.conventions and not found.differs


@pytest.mark.parametrize("seconds", [11.0, 19.9])
def test_a_log_of_ten_seconds_is_compared(seconds):
    """Of less than twenty nothing was seen, and a healthy simulator's answer was that of one whose
    gyro reads a tenth too much."""
    flight = flown(3, seconds=seconds)
    force, rate = forces(flight[1], flight[4]), flight[2]
    healthy = compared(flight, *as_real(force, rate))
    assert healthy.fits and not healthy.conventions and not healthy.differs
    scaled = compared(flight, *as_real(force, 1.1 * rate))
    scales = [p.difference for p in scaled.differs if (p.name, p.sensor) == ("scale", "gyro")]
    assert scales == pytest.approx([-100.0 * 0.1 / 1.1] * 3, abs=0.1)


def test_a_turned_sign_is_told(flight):
    """It was "this capture cannot tell", at a correlation of 1.000."""
    turned = compared(flight, -forces(flight[1], flight[4]), flight[2])
    assert [c.name for c in turned.conventions] == ["force_sign"]


def test_swapped_axes_are_told(flight):
    force, rate = (values[:, [1, 0, 2]] * [1.0, -1.0, 1.0]
                   for values in (forces(flight[1], flight[4]), flight[2]))
    swapped = compared(flight, force, rate)
    assert [c.name for c in swapped.conventions] == ["both_axes"]
    assert swapped.task.attitude["before"] > 10.0 > 1.0 > swapped.task.attitude["after"]


def test_the_numbers_are_those_of_the_pair(flight):
    force, rate = as_real(forces(flight[1], flight[4]), flight[2] * [1.05, 1.0, 1.0])
    rate = np.vstack([np.repeat(rate[:1], 4, axis=0), rate[:-4]]) + [0.0, 0.01, 0.0]
    found = compared(flight, force, rate)
    assert not found.conventions
    differs = {(p.name, p.sensor, p.axis): p for p in found.differs}
    assert differs["delay", "gyro", ""].difference == pytest.approx(-40.0, abs=1.0)
    assert differs["scale", "gyro", "x"].difference == pytest.approx(-100.0 * 0.05 / 1.05, abs=0.1)
    bias = differs["bias", "gyro", "y"]
    assert bias.difference == pytest.approx(-np.degrees(0.01), abs=0.05)
    assert bias.set_to == pytest.approx(bias.difference)
    assert not [p for p in found.differs if p.sensor == "accel"]


@pytest.mark.long
@pytest.mark.parametrize("name", ["time_step", "no_gravity", "world_frame_rates",
                                  "no_centripetal_term", "gravity_after_rotation"])
def test_what_needs_the_vertical_is_told_by_its_own(name, flight):
    _, turn, rate, speed, acceleration = flight
    level, moved = forces(turn, 0.0 * acceleration), forces(turn, acceleration, 0.0)
    force, rates = {
        "time_step": (level + 2.0 * moved, rate), "no_gravity": (moved, rate),
        "world_frame_rates": (level + moved, np.einsum("nij,nj->ni", turn, rate)),
        "no_centripetal_term": (level + moved - np.cross(
            rate, np.einsum("nji,nj->ni", turn, speed)), rate),
        "gravity_after_rotation": (moved + [0.0, 0.0, G], rate)}[name]
    found = compared(flight, force, rates)
    assert name in [c.name for c in found.conventions]
    if name in convention_findings.OF_ATTITUDE:
        assert not [p for p in found.parameters if (p.name, p.sensor) == ("scale", "accel")]


def test_a_noise_that_is_not_known_is_not_told_as_none():
    gap = {"accel": {"unit": "mg", "before": 30.0, "after": 4.0, "floor": 0.0}}
    said, = simulator_words.lines({"gap": gap, "task": None, "unseen": []})
    assert said.endswith("noise alone is not known.")


def test_what_to_set_is_a_change_where_the_log_does_not_show_what_there_is():
    """Whoever set the -50.95 mg that were told of a simulator with 50 mg would have had -101."""
    number = {"differs": True, "unit": "mg", "difference": -50.9, "how": "", "set": -50.9,
              "difference_interval_90": [-52.0, -49.0], "real": None, "real_interval_90": None,
              "simulator": None, "simulator_interval_90": None}
    shown = {**number, "set": 0.1, "simulator": 51.0, "simulator_interval_90": [50.5, 51.5]}
    for each, said in ((number, "-50.9 mg more than it has"), (shown, "0.1 mg")):
        (row,) = simulator_words.parameter_rows({"parameters": {"accel": {"bias": {"x": each}}}})
        assert row[4] == said
