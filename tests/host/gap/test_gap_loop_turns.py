"""The loop closed for the gyro in motion: real turns made again with and without the effect. The
turns alone are judged: a tenth of a whole diagnosis."""
import pytest

from sixflip_host.diagnosis import closed_loops, diagnosis, turn_model
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session


def judged(effects, seed):
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": seed,
                               "effects": effects})
    sessions = [blocks.session_of(str(k), simulated_session.session(plan, k)) for k in range(2)]
    return turn_model.TurnModel("gyro", "mpu6050", diagnosis.Settings()).fit(
        sessions, [attitude_fit.fit(session) for session in sessions])


def test_scales_that_differ_by_direction_close_the_gap_when_simulated_again():
    turns = judged([{"effect": "asymmetry", "sensor": "gyro", "x": 3.0}], 4)
    loop = closed_loops.close_turns(turns, turns.model.conditions.reference_c)
    assert [e["effect"] for e in loop.effects] == ["asymmetry"]
    assert loop.effects[0]["x"] == pytest.approx(3.0, abs=0.2)
    assert loop.before > 3.0 * loop.floor
    assert loop.after < 1.3 * loop.floor
    assert loop.share > 0.95


def test_nothing_found_is_nothing_to_add():
    turns = judged([], 5)
    assert turns.units[0].turns and not turns.chosen
    assert closed_loops.close_turns(turns, 25.0) is None
