"""The loop closed for the gyro in motion: real turns made again with and without the effect."""
import pytest

from sixflip_host.diagnosis import closed_loop_turns, diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


def test_scales_that_differ_by_direction_close_the_gap_when_simulated_again():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 4,
                               "effects": [{"effect": "asymmetry", "sensor": "gyro", "x": 3.0}]})
    sessions = [blocks.of(str(k), simulated_session.session(plan, k)) for k in range(2)]
    found = diagnosis.of(sessions, diagnosis.Settings())
    loop = closed_loop_turns.close(found.turns, found.conditions.reference_c)
    assert [e["effect"] for e in loop.effects] == ["asymmetry"]
    assert loop.effects[0]["x"] == pytest.approx(3.0, abs=0.2)
    assert loop.before > 3.0 * loop.floor
    assert loop.after < 1.3 * loop.floor
    assert loop.share > 0.95


def test_nothing_found_is_nothing_to_add():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 5,
                               "effects": []})
    sessions = [blocks.of(str(k), simulated_session.session(plan, k)) for k in range(2)]
    found = diagnosis.of(sessions, diagnosis.Settings())
    assert found.turns is not None
    assert closed_loop_turns.close(found.turns, 25.0) is None
