"""The loop closed for the gyro in motion: real turns made again with and without the effect. The
turns alone are judged: a tenth of a whole diagnosis."""
import numpy as np
import pytest

from sixflip_host.diagnosis import closed_loops, diagnosis, turn_model
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session

LSB = 65.5  # of an MPU6050 at 500 deg/s


def judged(effects, seed, fast=False, read=np.array):
    """SensorGap of the turns; fast: of 2 to 4 s a move; read: counts of the gyro (n, 3) out of
    what it would have read."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": seed,
                               "effects": effects})
    for world in plan.worlds if fast else ():
        world["order"] = [dict(pose if isinstance(pose, dict) else {"pose": pose},
                               move_s=2.0 + k % 3) for k, pose in enumerate(world["order"])]
    captures = [simulated_session.session(plan, k) for k in range(2)]
    for capture in captures:
        capture.gyro = read(capture.gyro)
    sessions = [blocks.session_of(str(k), capture) for k, capture in enumerate(captures)]
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


def cut_off(counts):
    """Rates of z that end at 135 deg/s, with noise on top of the limit."""
    read = counts.astype(float)
    at_end = np.abs(read[:, 2]) > 135 * LSB
    read[at_end, 2] = np.sign(read[at_end, 2]) * 135 * LSB + np.random.default_rng(2).normal(
        0.0, 4.0, at_end.sum())
    return read.round().astype(counts.dtype)


def softly(counts):
    """Rates of x that come to an end slowly."""
    read = counts.astype(float)
    read[:, 0] = 200 * LSB * np.tanh(read[:, 0] / (200 * LSB))
    return read.round().astype(counts.dtype)


@pytest.mark.parametrize("read, axis", [(cut_off, "z"), (softly, "x")])
def test_rates_that_read_as_less_than_they_are_have_their_name_among_others(read, axis):
    """A limit with noise on it was unexplained, one that rates come to slowly cubic alone."""
    turns = judged([], 4, True, read)
    cause, = turns.causes
    assert "saturation" in cause.names and cause.letters == [axis]


def test_a_share_that_is_lost_beyond_a_level_closes_the_gap_when_simulated_again():
    turns = judged([{"effect": "saturation", "sensor": "gyro", "y": 0.3, "level": 57.0}], 4,
                   True)
    loop = closed_loops.close_turns(turns, turns.model.conditions.reference_c)
    assert [e["effect"] for e in loop.effects] == ["saturation"]
    assert loop.share > 0.7  # the level is one of half an octave
