"""A robot's log beside its simulator's: rows that are lost, clocks that differ, a car that stays
level. The motions are made here, of splines and sines; nothing of the simulator makes them."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis.simulator import (
    alignment,
    comparison,
    evidence_of_logs,
    pairing,
    simulator_answer,
    traces,
)

G, RATE_HZ = 9.80665, 100.0
META = {"sensor": "mpu6050", "rate_hz": RATE_HZ, "accel_lsb_per_g": 8192, "accel_range_g": 4,
        "gyro_lsb_per_dps": 65.5, "gyro_range_dps": 500}


def trotting(seconds=90.0, gait_hz=2.3):
    """(t, specific force m/s2, rate rad/s) of a thing that trots and turns between two stops."""
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t - 5.0, seconds - 5.0 - t) / 2.0, 0.0, 1.0)
    way = way ** 2 * (3.0 - 2.0 * way)
    phase = 2.0 * np.pi * gait_hz * t
    angles = way[:, None] * np.stack([0.05 * np.sin(phase), 0.07 * np.sin(2.0 * phase + 0.4),
                                      2.0 * np.sin(0.23 * t) + np.sin(0.61 * t)], 1)
    turn = Rotation.from_euler("xyz", angles).as_matrix()
    step = Rotation.from_matrix(np.swapaxes(turn[:-2], 1, 2) @ turn[2:]).as_rotvec()
    rate = np.pad(step * RATE_HZ / 2.0, ((1, 1), (0, 0)))
    shaken = way[:, None] * np.stack([0.8 * np.sin(phase), 0.5 * np.cos(phase),
                                      1.5 * np.sin(2.0 * phase)], 1)
    return t, np.einsum("nji,nj->ni", turn, shaken + [0.0, 0.0, G]), rate


def driving(seconds=200.0):
    """(t, specific force, acceleration without gravity, rate) of a car between three stops, that
    pitches as it goes over waves and turns to one side mostly."""
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 70.0 - 8.0, 64.0 - t % 70.0) / 3.0, 0.0, 1.0)
    way = way ** 2 * (3.0 - 2.0 * way)
    yaw_rate = way * (0.15 + 0.2 * np.sin(0.37 * t))
    pitch, roll = (way * size * (np.sin(hz * 2.0 * np.pi * t) + np.sin(hz * 3.7 * t + 1.0))
                   for size, hz in ((0.008, 0.7), (0.01, 0.5)))
    turn = Rotation.from_euler("ZYX", np.stack([
        np.cumsum(yaw_rate) / RATE_HZ, pitch, roll], 1)).as_matrix()
    step = Rotation.from_matrix(np.swapaxes(turn[:-2], 1, 2) @ turn[2:]).as_rotvec()
    free = way[:, None] * np.stack([0.6 * np.sin(0.21 * t), 9.0 * yaw_rate, 0.0 * t], 1)
    up = turn[:, 2]
    return t, free + G * up, free, np.pad(step * RATE_HZ / 2.0, ((1, 1), (0, 0)))


def read(t, force, rate, seed, keep=slice(None), stretched=1.0):
    """The Capture of it with the noise of an MPU-6050."""
    rng = np.random.default_rng(seed)
    accel = np.rint((force / G + 0.004 * rng.standard_normal(force.shape)) * 8192)
    gyro = np.rint((np.degrees(rate) + 0.05 * rng.standard_normal(rate.shape)) * 65.5)
    t_us = np.rint(1e6 * stretched * t).astype(np.int64)
    return Capture(dict(META), t_us[keep], np.clip(accel, -32768, 32767).astype(np.int16)[keep],
                   np.clip(gyro, -32768, 32767).astype(np.int16)[keep])


def without_some(n, seed, share=0.03):
    """(n,) False where rows are lost, two to eleven in a run."""
    rng, keep = np.random.default_rng(seed), np.ones(n, bool)
    while keep.mean() > 1.0 - share:
        first = rng.integers(20, n - 20)
        keep[first:first + rng.integers(2, 12)] = False
    return keep


@pytest.mark.parametrize("seed", [1, 2])
def test_rows_that_are_lost_make_no_convention_and_no_number(seed):
    """A trotting robot's were "at the body's centre", "unknown", 120 mg apart."""
    t, force, rate = trotting()
    real = read(t, force, rate, seed, without_some(len(t), seed))
    found = comparison.compare([("real", real)], "sim", read(t, force, rate, 50 + seed))
    assert found.alignment.same and not found.conventions and not found.differs
    for _, after, noise in found.gap.values():
        assert after < 2.0 * noise


def test_rows_that_are_lost_are_put_in_where_it_moves_and_known():
    t, force, rate = trotting(30.0)
    keep, whole = without_some(len(t), 3), read(t, force, rate, 3)
    keep[1000:1040] = False  # more than a curve can be drawn through
    true = traces.trace_from_capture("true", whole)
    lacking = traces.trace_from_capture("lacking", read(t, force, rate, 3, keep))
    assert lacking.rate_hz == pytest.approx(RATE_HZ, rel=1e-4) and not true.put_in.any()
    row = np.rint(lacking.t * RATE_HZ).astype(int)
    assert not lacking.put_in[keep[row] & (np.abs(row - 1020) > 25)].any()
    assert lacking.put_in[~keep[row]].all() and lacking.put_in[np.isin(row, (999, 1040))].all()
    assert np.array_equal(lacking.rate[keep[row]], true.rate[row[keep[row]]])
    off = (lacking.rate - true.rate[row])[lacking.put_in]
    assert off.std() < 0.1 * true.rate.std() and len(off) > 50
    assert len(lacking.rests) == len(true.rests)
    for first, end in lacking.rests:
        assert not lacking.put_in[first:end].any()


def test_rows_that_are_lost_all_along_a_motion_leave_more_than_its_rests_to_be_compared():
    """Every fifth row was beside all of the motion: of a gyro that reads otherwise in it the rests
    alone were compared, and they were 20 of 50 s together."""
    t, force, rate = trotting(50.0)
    stands = (t < 4.0) | (t > 30.0)
    rate[t > 28.0], force[t > 28.0] = 0.0, [0.0, 0.0, G]
    real, sim = (traces.trace_from_capture(str(seed), read(
        t, force, rate, seed, stands | (np.arange(len(t)) % 5 > 0))) for seed in (3, 53))
    aligned = alignment.align(real, sim)
    pair = pairing.paired(real, sim, aligned, traces.motion(real))
    assert aligned.same and aligned.by == "turn rates" and aligned.overlap_s > 49.0
    assert np.ptp(pair.t) > 48.0 and (pair.rate.std(axis=0) > 0.9 * rate.std(axis=0))[2]


@pytest.mark.parametrize("longest", [25, 50])
def test_a_gap_that_no_curve_is_drawn_through_is_no_range(longest):
    t, force, rate = trotting(60.0)
    rng, keep = np.random.default_rng(longest), np.ones(len(t), bool)
    for first in rng.integers(700, len(t) - 700, 12):
        keep[first:first + longest] = False
    found = comparison.compare([("real", read(t, force, rate, 6, keep))], "sim",
                               read(t, force, rate, 56))
    assert found.alignment.same and not found.conventions
    assert not [p for p in found.differs if p.name in ("range", "step", "shaking")]


@pytest.mark.long
@pytest.mark.parametrize("slower", [0.018, -0.018])
def test_a_gait_seen_by_a_clock_that_runs_slow_is_the_same_motion(slower):
    """It matched itself a step further on, and that was another motion."""
    t, force, rate = trotting(140.0)
    real = read(t, force, rate, 4, stretched=1.0 + slower)
    found = comparison.compare([("real", real)], "sim", read(t, force, rate, 54))
    assert found.alignment.same
    assert found.alignment.drift == pytest.approx(slower, abs=1e-4)
    assert [p.name for p in found.differs if p.sensor == "device"] == ["clock"]


@pytest.mark.long
@pytest.mark.parametrize("kind, sign", [("no_gravity", 0.0), ("gravity_sign", -1.0)])
def test_a_car_whose_simulator_leaves_gravity_out(kind, sign):
    """Its gyro's cross axes make a degree of tilt of each turn: what is without gravity by the
    gyro was too far off, and it had a lever arm of half a metre and a bias of 1 g."""
    t, force, free, rate = driving()
    crossed = rate + np.outer(rate[:, 2], [0.012, -0.01, 0.0])
    simulated = free + sign * (force - free)
    found = comparison.compare([("real", read(t, force, crossed, 5))], "sim",
                               read(t, simulated, rate, 55))
    assert [c.name for c in found.conventions if c.sensor == "accel"] == [kind]
    assert not [p for p in found.differs if (p.sensor, p.name) == ("accel", "bias")]


@pytest.mark.parametrize("rows", [0.5, 1.37, -0.5])
def test_what_is_late_by_a_part_of_a_row_is_not_smoother(rows):
    """Half way between two rows it was, as behind a pole of 16 Hz."""
    at = np.arange(400)
    for hertz in (1.0, 4.0, 6.0):
        omega = 2.0 * np.pi * hertz / 50.0
        late = evidence_of_logs.shifted(np.sin(omega * at)[:, None], rows)[10:-10, 0]
        assert np.abs(late - np.sin(omega * (at[10:-10] - rows))).max() < 1e-3
    for n in range(1, 8):
        few = evidence_of_logs.shifted(np.arange(float(n))[:, None], 0.4)
        # beyond its ends it goes on straight, of one row as it is
        assert few[:, 0] == pytest.approx(np.arange(n) - (0.4 if n > 1 else 0.0))


@pytest.mark.parametrize("shaken, said", [([], "explained"), (["gyro"], "partly explained")])
def test_what_is_left_far_above_noise_is_not_explained_by_a_number(shaken, said):
    log = SimpleNamespace(unexplained=False, conventions=(), differs=["step"], shaken=shaken,
                          alignment=alignment.Alignment(True, 1.0, 0, 0, 0, 0, 9.0))
    assert simulator_answer.verdict("no gap", [log]) == said
