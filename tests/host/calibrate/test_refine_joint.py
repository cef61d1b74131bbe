"""Rests and moves together: what comes back from a known sensor, and from the Xsens recording."""

import numpy as np
import pytest

from sixflip.accelerometer import solver as accelerometer
from sixflip_host.calibrate import joint_refinement, refinement, refinement_answer
from sixflip_host.experiment import blocks, turns
from tests.worlds import hand_session, xsens_recording
from tests.worlds.hand_session import RAD

PULL = np.array([[0.1, 0.02, 0.0], [-0.15, 0.05, 0.1], [0.0, -0.1, 0.05]])  # deg/s a g


def solved(capture, per_g=False):
    session, _ = refinement.session_of(capture)
    return session, joint_refinement.refine(session, per_g)


def six_face_errors(seed, flip_error_deg, hand_deg=0.0, scatter_deg=0.0):
    """Vector errors, mg: assuming 180, with the refined angles, the joint solution."""
    sensor = hand_session.Sensor(seed)
    poses = hand_session.six_faces(seed, 2.0, flip_error_deg, scatter_deg, hand_deg)
    capture = hand_session.session(sensor, poses, seed)
    session, result = solved(capture)
    placements = capture.placements()

    def on_board(angles):
        P = np.array(accelerometer.solve(placements, hand_session.LSB_G, angles=angles).P)
        return sensor.vector_error_mg(P[:3, :3].T, P[3, :3] / accelerometer.G)

    return (on_board(None), on_board(refinement_answer.angles(session, result)),
            sensor.vector_error_mg(*result.accelerometer()))


@pytest.mark.parametrize("off", [5.0, 10.0, -10.0])
def test_flips_all_off_to_the_same_side_are_compensated(off):
    errors = np.array([six_face_errors(seed, off) for seed in range(10)])
    assumed, with_angles, joint = np.median(errors, axis=0)
    assert assumed > 1.0
    assert with_angles <= 0.25
    assert joint <= 0.25


def test_good_flips_lose_nothing():
    errors = np.array([six_face_errors(seed, 0.0) for seed in range(10)])
    assumed, with_angles, joint = np.sqrt(np.mean(errors**2, axis=0))
    assert with_angles <= 1.05 * assumed
    assert joint <= 1.15 * assumed


def test_a_box_set_down_askew_gains_from_the_moves():
    errors = np.array([six_face_errors(seed, 5.0, 0.4, 0.05) for seed in range(8)])
    _, with_angles, joint = np.median(errors, axis=0)
    assert joint < 0.8 * with_angles


def test_the_refinement_and_the_diagnosis_see_the_same_rests_and_moves_and_neither_writes():
    capture = hand_session.session(hand_session.Sensor(1), hand_session.free_poses(1, 6), 1)
    session, _ = refinement.session_of(capture)
    seen = turns.usable_turns(session.session, session.force)
    assert [turn.first for turn in seen] == [
        move.first for move in blocks.moves_of(session.session)]
    assert session.moves.seconds.tolist() == pytest.approx([turn.seconds for turn in seen])
    assert blocks.session_of("the same", capture).runs == session.session.runs
    for array in (session.force, session.rate_error, session.move_error, session.moves.dt,
                  session.moves.before):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_gyro_scale_of_the_first_pass_owes_nothing_to_the_flips():
    """Flips 10 deg too far would put 5.6 % into a scale that believed them."""
    for seed in range(3):
        sensor = hand_session.Sensor(seed)
        capture = hand_session.session(sensor, hand_session.six_faces(seed, 2.0, 10.0), seed)
        _, result = solved(capture)
        error = result.first.gyro()[0] @ sensor.Kw - np.eye(3)
        assert np.abs(np.diag(error)).max() < 0.002
        assert np.abs(result.excess()[0] / RAD - 10.0).max() < 0.4


def body_frame(A, sensor):
    """Rotation between the solution's axes (x kept) and the box's."""
    U, _, V = np.linalg.svd(A @ sensor.K)
    return U @ V


@pytest.mark.parametrize("seed", range(3))
def test_free_hand_session(seed):
    sensor = hand_session.Sensor(seed, noise_mg=1.0, noise_dps=0.05)
    capture = hand_session.session(sensor, hand_session.free_poses(seed, 30), seed)
    _, result = solved(capture)
    Q = body_frame(result.accelerometer()[0], sensor)
    error = Q.T @ result.gyro()[0] @ sensor.Kw - np.eye(3)
    assert np.abs(np.diag(error)).max() < 4e-4
    assert result.free[:12].sum() == 9


def test_g_sensitivity_comes_back():
    sensor = hand_session.Sensor(3, noise_mg=1.0, noise_dps=0.05, per_g=PULL)
    capture = hand_session.session(sensor, hand_session.free_poses(3, 30), 3)
    session, result = solved(capture, per_g=True)
    assert refinement.pulled_by_gravity(session)
    # The solution's axes are turned against the box's by Q; the gyro's own are not.
    Q = body_frame(result.accelerometer()[0], sensor)
    found = refinement_answer.gyro(result)
    assert np.abs(np.array(found["per_g_dps"]) @ Q - PULL).max() < 0.01
    assert np.abs(np.array(found["bias_dps"]) - sensor.bw).max() < 0.02


def test_g_sensitivity_is_not_invented():
    sensor = hand_session.Sensor(4)
    capture = hand_session.session(sensor, hand_session.free_poses(4, 20), 4)
    session, _ = refinement.session_of(capture)
    assert not refinement.pulled_by_gravity(session)


def test_standard_errors_are_the_errors():
    """Over 20 sessions the normalised errors of the accelerometer have a spread of about one."""
    normalised = []
    for seed in range(20):
        sensor = hand_session.Sensor(seed)
        capture = hand_session.session(sensor, hand_session.six_faces(seed, 2.0, 0.0, 0.05), seed)
        _, result = solved(capture)
        A = np.linalg.inv(sensor.K)
        true = np.concatenate([A.ravel(), -A @ sensor.b])
        normalised.append((result.p[:12] - true) / result.sigma()[:12])
    spread = float(np.sqrt(np.mean(np.square(normalised))))
    assert 0.6 < spread < 1.5


def test_xsens_fuller_problem(recordings):
    capture = xsens_recording.read(recordings)
    session, _ = refinement.session_of(capture, free=True)
    assert len(session.names) == 38
    assert len(session.moves) == 37
    without, with_it, pull = refinement.bias_of_rests(session)
    assert (without > 20).all()
    assert (with_it < 2.2).all()
    plain = joint_refinement.refine(session)
    fuller = joint_refinement.refine(session, per_g=True)
    assert refinement_answer.moves_off_deg(session, plain) > 0.45
    assert refinement_answer.moves_off_deg(session, fuller) < 0.14
    per_g = np.abs(fuller.gyro()[2]) / RAD
    assert 0.145 < per_g.max() < 0.165
    assert np.sqrt(np.mean(refinement_answer.norm_off_mg(fuller) ** 2)) < 0.105
