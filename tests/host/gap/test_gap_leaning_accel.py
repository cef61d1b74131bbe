"""What the accelerometer reads too much leans the box as far as it knows, and is none of the
gyro's, nor of what moves between the rests; what no thermometer saw may be the temperature's."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import answer, diagnosis, rests_judged, turn_model
from sixflip_host.diagnosis.detect.detection import BELOW, RANGE
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


def diagnosed(effects, seed, change=lambda capture: None, scene="recommended"):
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": scene, "seed": seed,
                               "world": {"placement_scatter_deg": 0.05, "tilt_deg": 1.0},
                               "effects": effects})
    captures = [simulated_session.session(plan, k) for k in range(len(plan.worlds))]
    for capture in captures:
        change(capture)
    return diagnosis.diagnose_sessions([blocks.session_of(str(k), c)
                                        for k, c in enumerate(captures)],
                                       diagnosis.Settings(jobs=1))


@pytest.mark.long
@pytest.mark.parametrize("effects", [
    [{"effect": "warm_up", "sensor": "accel", "x": 14.0, "tau_s": 90.0},
     {"effect": "quadratic", "sensor": "accel", "y": 8.0}],
    [{"effect": "warm_up", "sensor": "accel", "z": 9.0, "tau_s": 120.0},
     {"effect": "filter_lag", "sensor": "gyro", "tau": 10.0}]])
def test_a_bias_that_lasts_turns_no_gyro_and_hides_nothing_in_motion(effects):
    """Half a degree that gravity seemed to lean was a gyro that does something in motion, or made
    all that moves unfit to be judged."""
    found = diagnosed(effects, seed=8)
    assert found.turns.adequacy.ok and not found.turns.posterior.best.forms
    causes = {(c["sensor"], name) for c in answer.as_dict(found)["causes"] for name in c["class"]}
    assert causes >= {(e["sensor"], e["effect"]) for e in effects}
    assert not [place for place in found.where if place.domain == "motion" and not any(
        e["effect"] == "filter_lag" for e in effects)]
    assert found.verdict == "explained"


def swapped(capture):
    capture.accel = capture.accel[:, [1, 0, 2]]


def deaf(capture):
    capture.accel = (np.sign(capture.accel) * np.maximum(np.abs(capture.accel) - 600, 0)).astype(
        np.int16)


def no_thermometer(capture):
    capture.temp = None


@pytest.mark.parametrize("change, effect", [(swapped, "axis_swap"), (deaf, "dead_band")])
def test_where_the_accelerometer_says_nothing_of_gravity_the_gyro_is_not_accused(change, effect):
    """Beside x and y swapped the gyro seemed to be swapped as well; by what a dead band leaves
    of gravity its turns ended degrees off."""
    found = diagnosed([], 8, change, "paper")
    causes = answer.as_dict(found)["causes"]
    assert [(c["sensor"], c["effect"]) for c in causes] == [("accel", effect)]
    assert not [place for place in found.where if place.sensor == "gyro"]


@pytest.mark.long
def test_a_warm_up_that_no_thermometer_saw_may_be_the_temperature_s():
    found = diagnosed([{"effect": "thermal_bias", "sensor": "accel", "z": 1.5}], 8,
                      no_thermometer, "paper")
    assert all(set(c["class"]) != {"warm_up"} for c in answer.as_dict(found)["causes"])
    seen = diagnosed([{"effect": "warm_up", "sensor": "accel", "z": 12.0, "tau_s": 120.0}], 8,
                     no_thermometer)
    told = answer.as_dict(seen)
    cause, = told["causes"]
    assert told["next"][0]["capture"].endswith("with its temperature")
    assert {"warm_up", "thermal_bias"} <= set(cause["class"]) and cause["effect"] is None


@pytest.mark.parametrize("limit, levels, usable", [
    (RANGE, {}, True), (RANGE, {"x": 250.0}, False), (BELOW, {}, False)])
def test_a_few_samples_at_the_end_of_a_known_range_leave_the_other_turns(
        limit, levels, usable, monkeypatch):
    """21 samples at 500 deg/s hid that the scales up and down differ by 2 %."""
    monkeypatch.setattr(turn_model, "usable", lambda session, nominal: True)
    rests = SimpleNamespace(sessions=[None], nominal=[None])
    cut = SimpleNamespace(sensor="gyro", effect="saturation", limits={"x": limit}, levels=levels)
    assert rests_judged._turn(rests, [cut]) is usable
