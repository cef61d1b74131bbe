"""The gyro bench: its claims hold on a few sessions, and it can say no."""

import math

from sixflip_host.simulation.simulated_session import capture_of
from sixflip_sim import worlds
from tests.studies.bench import gyro as bench


def test_claims_hold_on_a_few_sessions(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["gyro.py", "--trials", "10"])
    assert bench.main() == 0
    assert "gy85     bias error" in capsys.readouterr().out


def test_a_claim_that_does_not_hold_is_exit_1(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["gyro.py", "--trials", "3"])
    monkeypatch.setattr(bench, "MATRIX_95", 1e-5)
    assert bench.main() == 1
    assert "claim does not hold: mpu6050: matrix error, 95 %" in capsys.readouterr().out


def test_the_bound_is_what_two_flips_an_axis_leave():
    taken = capture_of(worlds.make({"seed": 4, "tilt_deg": 1.0}))
    scale, bias = bench.bound(taken.placements(), taken.moves(), taken.meta["gyro_lsb_per_dps"])
    for one in scale:
        assert abs(one - 0.4 / 180 / math.sqrt(2)) < 1e-5
    # 12 rests of 650 samples with 0.05 deg/s each
    for one in bias:
        assert abs(one - 0.05 / math.sqrt(12 * 650)) < 1e-4
    # of one normal deviate half lie within 0.6745, of three within the cube root of a half
    assert abs(bench.largest_of_three([1.0, 1e-9, 1e-9], 0.5) - 0.6745) < 1e-3
    assert abs(bench.largest_of_three([1.0] * 3, 0.5) - 1.2637) < 1e-3


def test_a_move_of_n_samples_spans_n_intervals():
    # one interval too many is 0.4 % of scale in a move of 2.5 s
    taken = capture_of(worlds.make({"seed": 4}))
    assert len(taken.moves()) == 11
    for move in taken.moves():
        assert move.duration_us == 10000 * move.n
