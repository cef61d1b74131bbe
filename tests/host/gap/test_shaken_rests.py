"""A thing that stands still while a machine runs beside it, or its readings move by themselves,
and one that moves without a turn."""
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.capture import shaken_rests
from sixflip_host.capture.capture_file import Capture
from sixflip_host.capture.rests import Run
from sixflip_host.diagnosis import answer, diagnose, diagnosis
from sixflip_host.experiment import blocks

RATE, SECONDS = 100.0, 300.0
T = np.arange(int(RATE * SECONDS)) / RATE
ON = ((T > 40.0) & (T < 130.0)) | ((T > 190.0) & (T < 270.0))
SHAKES = 15.0 * np.sin(2.0 * np.pi * (17.0 * T + 0.4 * np.sin(0.21 * T)))  # mg


def standing(up=0.0, turns=0.0, seed=3):
    """Session of a thing that nobody labelled; up (n,): mg along z beside gravity and noise;
    turns (n,): deg/s about z."""
    rng = np.random.default_rng(seed)
    accel, gyro = rng.normal(0.0, 2.8, (len(T), 3)), rng.normal(0.0, 0.04, (len(T), 3))
    accel[:, 2] += 1000.0 + up
    gyro[:, 2] += turns
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 16384.0,
            "gyro_lsb_per_dps": 65.5}
    return blocks.session_of("s", Capture(
        meta, np.rint(1e6 * T).astype(np.int64), np.rint(16.384 * accel).astype(np.int16),
        np.rint(65.5 * gyro).astype(np.int16)))


def whole(session):
    return len(blocks.with_whole_rests(session).runs)


def pulses(force_mg, seconds, starts):
    """mg of something that gains speed at some of the starts, s, and loses it at the next ones."""
    return sum((-1) ** k * force_mg * ((T > at) & (T < at + seconds))
               for k, at in enumerate(starts))


@pytest.mark.parametrize("shift_mg", [0.0, 4.0])
def test_a_machine_nearby_cuts_no_rest(shift_mg):
    """What it did for two thirds of a log was taken for a motion, and was "no gap"."""
    session = standing(np.where(ON, SHAKES + shift_mg, 0.0))
    assert whole(session) == 1
    said = diagnosis.diagnose_sessions([session])
    found, = [f for f in said.findings if f.effect == "vibration"]
    assert "z" in found.axes and found.value["z"] == pytest.approx(15.0 * 0.57 ** 0.5, rel=0.2)
    assert said.verdict == ("partly explained" if shift_mg else "explained")


@pytest.mark.parametrize("shift_mg, said", [(0.0, "no gap"), (8.0, "unexplained")])
def test_a_machine_beside_both_logs_of_a_rest_is_no_gap_and_what_it_shifts_is_one(shift_mg, said):
    """The pieces between which it ran were alike, and its run was in the simulator alone."""
    logs = [standing(np.where(ON, SHAKES + shift, 0.0), seed=seed).capture
            for shift, seed in ((shift_mg, 13), (0.0, 14))]
    for log in logs:
        log.pose = None
    told = answer.as_dict(diagnose.diagnose([("real", logs[0])], [("simulated", logs[1])]))
    assert told["verdict"] == said
    assert any((where["sensor"], where["axis"], where["domain"]) == ("accel", "z", "time")
               for where in told["where"]) == bool(shift_mg)
    assert not any("the simulator has" in remark for remark in told["remarks"])


def test_another_force_for_long_that_nothing_makes_up_for_is_no_speed():
    session = standing(np.where(ON, SHAKES + 20.0, 0.0))
    assert len(session.runs) > 2 and whole(session) == 1


def test_a_log_that_begins_and_ends_while_a_machine_runs_is_one_rest():
    session = standing(np.where(ON, 0.0, SHAKES))
    only, = blocks.with_whole_rests(session).runs
    assert (only.first, only.end) == (0, len(T))


@pytest.mark.parametrize("force_mg, seconds", [(100.0, 2.5), (150.0, 0.4), (30.0, 12.0)])
def test_a_lift_moves_without_a_turn(force_mg, seconds):
    """Its starts and stops, and a drive between the two that is louder than a rest."""
    session = standing(pulses(force_mg, seconds, (45.0, 120.0, 195.0, 260.0)) + np.where(
        ON, SHAKES, 0.0))
    assert whole(session) == len(session.runs) > 2


def test_what_turns_moves():
    session = standing(turns=np.where(ON, 2.0 * np.sin(T), 0.0), up=np.where(ON, SHAKES, 0.0))
    assert whole(session) == len(session.runs) > 2


def test_without_a_gyro_nobody_knows_whether_it_turned():
    capture = standing(np.where(ON, SHAKES, 0.0)).capture
    capture.gyro = capture.pose = None
    session = blocks.session_of("s", capture)
    assert len(session.runs) > 2
    assert shaken_rests.joined(capture, session.runs) == list(session.runs)


def test_a_log_of_one_row_a_second_has_noise_to_be_held_against():
    """A single row has no step within its second: any motion was as still as a rest."""
    rng = np.random.default_rng(5)
    accel = rng.normal([0.0, 0.0, 16384.0], 46.0, (300, 3))
    accel[120:180, 0] += 1600.0 * np.sin(np.linspace(0.0, 12.0, 60))
    meta = {"sensor": "mpu6050", "rate_hz": 1.0, "accel_lsb_per_g": 16384.0,
            "gyro_lsb_per_dps": 65.5}
    capture = Capture(meta, np.arange(300) * 1_000_000, np.rint(accel).astype(np.int16),
                      np.rint(rng.normal(0.0, 3.0, (300, 3))).astype(np.int16))
    runs = [Run(0, 0, 110), Run(0, 190, 300)]
    assert shaken_rests.joined(capture, runs) == runs


def turned_over(up):
    """Session of a box that lies in a dozen poses for 8 s each, nobody labelled which; up(t) mg
    along z beside gravity and noise."""
    rng, t = np.random.default_rng(5), np.arange(int(RATE * 130.0)) / RATE
    axes, at_rest = np.zeros((len(t), 3)), np.ones(len(t), bool)
    attitude = Rotation.identity()
    gravity = np.zeros((len(t), 3))
    for k in range(13):
        rest, move = slice(1000 * k, 1000 * k + 800), slice(1000 * k + 800, 1000 * k + 1000)
        gravity[rest] = attitude.inv().apply([0.0, 0.0, 1000.0])
        axis = rng.normal(size=3)
        turn = np.radians(rng.uniform(60.0, 120.0)) * axis / np.linalg.norm(axis)
        share = (1.0 - np.cos(np.pi * np.arange(200) / 200.0)) / 2.0
        gravity[move] = (attitude * Rotation.from_rotvec(share[:, None] * turn)).inv().apply(
            [0.0, 0.0, 1000.0])
        axes[move] = np.degrees(turn) * (np.pi / 4.0 * np.sin(np.pi * np.arange(200) / 200.0)
                                         )[:, None]
        attitude, at_rest[move] = attitude * Rotation.from_rotvec(turn), False
    accel = gravity + rng.normal(0.0, 3.2, gravity.shape)
    accel[:, 2] += up(t)
    gyro = axes + rng.normal(0.0, 0.04, axes.shape)
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 16384.0,
            "gyro_lsb_per_dps": 65.5}
    return blocks.session_of("s", Capture(
        meta, np.rint(1e6 * t).astype(np.int64), np.rint(16.384 * accel).astype(np.int16),
        np.rint(65.5 * gyro).astype(np.int16))), at_rest


@pytest.mark.parametrize("hz, size_mg", [(0.63, 10.0), (1.03, 8.0)])
def test_a_ripple_that_never_ends_leaves_the_rests_whole(hz, size_mg):
    """Of 8 mg at 1 Hz no window was like the next: there was "no rest", and no gap to be seen."""
    session, at_rest = turned_over(lambda t: size_mg * np.sin(2.0 * np.pi * hz * t))
    assert len(session.runs) == 13
    assert sum(run.end - run.first for run in session.runs) > 0.85 * at_rest.sum()
    said = diagnosis.diagnose_sessions([session])
    found, = [f for f in said.findings if f.effect == "vibration"]
    assert set(found.axes) == {"z"} and found.value["z"] == pytest.approx(size_mg, rel=0.12)


def test_what_drives_straight_ahead_is_not_taken_for_a_rest():
    """20 mg for half a second makes 10 cm/s: a gyro is as still as at rest in what goes so."""
    session, _ = turned_over(lambda t: 20.0 * np.sign(np.sin(2.0 * np.pi * t)) * (t % 2.0 < 1.0))
    assert sum(run.end - run.first for run in session.runs) < 0.3 * len(session.capture)
