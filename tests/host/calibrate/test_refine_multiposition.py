"""|a| = g in free poses: imu_tk's problem to its optimum, and what it cannot tell."""

import numpy as np
import pytest

from sixflip_host.calibrate import multiposition, refinement_answer
from sixflip_host.capture import rests_by_variance
from tests.worlds import hand_session, xsens_recording


@pytest.fixture(scope="module")
def xsens(recordings):
    return xsens_recording.measured(xsens_recording.read(recordings))


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_imu_tk_own_problem_reaches_its_optimum(xsens):
    fit = multiposition.search(xsens, xsens_recording.G, xsens_recording.INITIAL_REST)
    assert len(fit.rests) == 38
    assert fit.multiple == 6
    assert fit.cost <= 0.1201315
    means = np.array([xsens[f : f + 100].mean(axis=0) for _, f, _ in fit.rests])
    off = multiposition.norm_residual(fit.parameters, means, xsens_recording.G)
    assert round(1e3 * rms(off) / xsens_recording.G, 3) == 0.153
    left = xsens_recording.leave_one_out(means, fit.parameters)
    assert round(1e3 * rms(left) / xsens_recording.G, 3) == 0.207


def test_rests_are_found_without_being_told_of_the_first_one(xsens):
    fit = multiposition.search(xsens, xsens_recording.G)
    assert len(fit.rests) == 38
    assert fit.cost <= 0.1201315


def test_misalignment_is_what_the_nine_terms_are_for(xsens):
    fit = multiposition.search(xsens, xsens_recording.G, xsens_recording.INITIAL_REST)
    means = np.array([xsens[f:end].mean(axis=0) for _, f, end in fit.rests])
    nine = multiposition.solve(means, xsens_recording.G)
    square = fit.parameters.copy()
    square[[1, 2, 4]] = 0.0
    from scipy.optimize import least_squares
    six = least_squares(
        lambda p: multiposition.norm_residual(
            np.insert(p, [1, 1, 2], 0.0), means, xsens_recording.G),
        np.delete(square, [1, 2, 4]))
    assert round(1e3 * rms(six.fun) / xsens_recording.G, 2) == 3.44
    assert round(1e3 * rms(nine.residual) / xsens_recording.G, 2) == 0.10


def free_rests(seed, n, sensor):
    capture = hand_session.session(sensor, hand_session.free_poses(seed, n), seed)
    means = [capture.accel[capture.pose == code].mean(axis=0)
             for code in np.unique(capture.pose[capture.pose > 0])]
    return np.array(means) / hand_session.LSB_G * hand_session.G


def test_a_known_sensor_comes_back():
    sensor = hand_session.Sensor(5, noise_mg=0.0)
    fit = multiposition.solve(free_rests(5, 30, sensor), hand_session.G)
    assert np.abs(fit.bias() / hand_session.G - sensor.b).max() < 3e-5
    # U K is a rotation: its product with its transpose is 1.
    rotation = fit.U @ sensor.K
    assert np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-4


def open_directions(means):
    jacobian = multiposition.norm_jacobian(multiposition.NOMINAL, means, hand_session.G)
    return refinement_answer.undetermined(
        jacobian / (0.15e-3 * hand_session.G), multiposition.NAMES, multiposition.TYPICAL)


def test_six_faces_alone_are_refused_by_name():
    capture = hand_session.session(
        hand_session.Sensor(6), hand_session.six_faces(6, tilt_deg=0.0), 6)
    means = np.array([capture.accel[capture.pose == code].mean(axis=0) for code in range(1, 13)])
    lost = open_directions(means / hand_session.LSB_G * hand_session.G)
    assert len(lost) == 3
    sentence = refinement_answer.not_determined_words(lost, 9)
    assert "determine 6 of 9 parameters" in sentence
    for name in ("xy shear", "xz shear", "yz shear"):
        assert name in sentence
    assert "scale" not in sentence


def test_leaning_poses_leave_nothing_open():
    assert open_directions(free_rests(6, 20, hand_session.Sensor(6))) == []


def test_rests_end_where_the_motion_begins():
    rng = np.random.default_rng(0)
    samples = rng.normal(0, 1.0, (2000, 3))
    samples[800:1000] += 50 * np.sin(np.arange(200) / 7)[:, None]
    limit = 4 * rests_by_variance.variance_at_rest(samples)
    before, after = rests_by_variance.find(samples, limit)
    assert before.end <= 800 < before.end + rests_by_variance.WINDOW
    assert 1000 <= after.first < 1000 + rests_by_variance.WINDOW


def test_no_rests_in_a_recording_that_never_rests():
    rng = np.random.default_rng(1)
    moving = np.cumsum(rng.normal(0, 1.0, (3000, 3)), axis=0)
    with pytest.raises(ValueError, match="12 or more are needed"):
        multiposition.search(moving, 9.8)


def test_fewer_poses_than_parameters_is_an_error():
    with pytest.raises(ValueError, match="8 poses cannot tell 9 parameters"):
        multiposition.solve(np.eye(8, 3) + 0.1, 9.8)
