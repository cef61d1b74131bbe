"""Sessions that do not show the same things: one without a thermometer, one without flips."""
import numpy as np
import pytest

from sixflip.poses import faces
from sixflip_host.diagnosis import answer, diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


def captures():
    """Two sessions of the paper's 12 poses by one part, with a g-sensitivity."""
    part = {"gyro_bias_dps": [0.5, -0.3, 0.2], "accel_bias_mg": [20.0, -15.0, 30.0]}
    return [simulated_session.session(scenario.from_dict({
        "sensor": "mpu6050", "scene": "paper", "seed": seed, "world": dict(part),
        "effects": [{"effect": "g_sensitivity", "sensor": "gyro", "xy": 0.2}]}), 0)
        for seed in (5, 6)]


def no_thermometer(capture):
    capture.temp = None


def steady(capture):
    capture.temp[:] = capture.temp[0]


def no_flips(capture):
    flipped = [code for code in range(1, 13) if faces.is_b(code)]
    capture.pose[np.isin(capture.pose, flipped)] = 0


@pytest.mark.parametrize("change, which", [(no_thermometer, 1), (steady, 0), (no_flips, 1)])
def test_what_one_session_cannot_show_does_not_stop_the_others(change, which):
    found = captures()
    change(found[which])
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(found)]
    result = diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1))
    cause, = [c for c in answer.as_dict(result)["causes"] if c["sensor"] == "gyro"]
    assert cause["effect"] == "g_sensitivity"
    assert cause["value"]["xy"] == pytest.approx(0.2, abs=0.02)
    for gap in result.gaps.values():
        for unit in gap.units:
            assert [(d.effect, d.variant, d.keys) for d in unit.designs] == [
                (d.effect, d.variant, d.keys) for d in gap.units[0].designs]
    names = {d.effect for d in result.gaps["accel"].units[0].designs}
    assert ("thermal_bias" in names) == (change is not no_thermometer)
