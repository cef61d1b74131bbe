"""The loop closed for the gyro in motion: real turns made again with and without the effect. The
turns alone are judged: a tenth of a whole diagnosis."""
import numpy as np
import pytest

from sixflip_host.diagnosis import closed_loops, diagnosis, turn_model
from sixflip_host.diagnosis.detect import saturation
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


def test_a_peak_that_is_cut_off_has_lost_what_its_flanks_foretell():
    """What reads as much as anything does was taken to have lost a share of that, another one in
    each turn: two sessions did not agree, and half of the gap stayed."""
    turns = judged([], 4, True, cut_off)
    form, = turns.posterior.best.forms
    assert form.variant == "at its end"
    assert turns.causes[0].theta[0] == pytest.approx(1.0, abs=0.15)
    loop = closed_loops.close_turns(turns, turns.model.conditions.reference_c)
    assert loop.effects[0]["level"] == pytest.approx(135.0, rel=0.02)   # deg/s
    assert loop.share > 0.5     # the turns that are made again are those that were cut off
    assert turns.adequacy.ok


def peak(hz, seconds=3.0, uneven=0.0):
    """(rates (n,) deg/s of a turn of 180 at its fastest, dt (n,) s)."""
    generator = np.random.default_rng(1)
    dt = (1.0 + uneven * generator.uniform(-1.0, 1.0, int(seconds * hz))) / hz
    t = np.cumsum(dt) - 0.5 * dt
    return 180.0 * np.sin(np.pi * t / seconds) ** 2 + generator.normal(0.0, 0.05, len(t)), dt


def lost(rates, dt, top):
    """Degrees that a peak has lost, of an axis beside two that rest."""
    other = np.zeros_like(rates)
    less = saturation.lost_at_peaks(np.column_stack([other, rates, other]), dt,
                                    np.array([1.0, 0.97 * top, 1.0]))
    assert not less[:, [0, 2]].any()
    return float(less[:, 1] @ dt)


SAMPLED = [(100.0, 0.0), (100.0, 0.5), (1000.0, 0.0), (10.0, 0.0)]


@pytest.mark.parametrize("hz, uneven", SAMPLED)
def test_a_whole_peak_has_lost_next_to_nothing(hz, uneven):
    rates, dt = peak(hz, uneven=uneven)
    assert lost(rates, dt, rates.max()) < 0.01 * (rates @ dt)


@pytest.mark.parametrize("hz, uneven", SAMPLED)
def test_the_flanks_of_a_peak_foretell_what_it_has_lost(hz, uneven):
    rates, dt = peak(hz, uneven=uneven)
    cut = np.minimum(rates, 130.0)
    assert lost(cut, dt, 130.0) == pytest.approx((rates - cut) @ dt, rel=0.2)


def test_a_peak_whose_end_is_not_there_has_lost_nothing_that_is_known():
    rates, dt = peak(100.0)
    assert lost(np.minimum(rates, 130.0)[:150], dt[:150], 130.0) == 0.0


def test_a_share_that_is_lost_beyond_a_level_closes_the_gap_when_simulated_again():
    turns = judged([{"effect": "saturation", "sensor": "gyro", "y": 0.3, "level": 57.0}], 4,
                   True)
    loop = closed_loops.close_turns(turns, turns.model.conditions.reference_c)
    assert [e["effect"] for e in loop.effects] == ["saturation"]
    assert loop.share > 0.7  # the level is one of half an octave
