"""solve: sessions with one known error each, and the reason the tool gives."""

import json

import numpy as np
import pytest

from sixflip.accelerometer import solver as accelerometer
from sixflip.poses.faces import pose_code
from sixflip_host.calibrate import reference
from sixflip_host.capture import capture_file
from sixflip_host.cli import main
from tests.worlds.board_session import unlabelled
from tests.worlds.hand_session import G, Sensor, session, six_faces


def labelled(seed=1, tilt_deg=2.0, gyro=False, **scene):
    """Sensor and a labelled capture of the paper's session."""
    sensor = Sensor(seed)
    return sensor, session(sensor, six_faces(seed, tilt_deg), seed, gyro=gyro, **scene)


def solve(tmp_path, capsys, capture, *words):
    """(exit code, the JSON answer)."""
    path = tmp_path / "capture.csv"
    capture_file.write(path, capture)
    code = main(["solve", str(path), "--json", *words])
    return code, json.loads(capsys.readouterr().out)


def refuse(tmp_path, capsys, capture, words):
    """The session must be refused, with these words in the reason; the answer."""
    code, answer = solve(tmp_path, capsys, capture)
    assert code == 1
    assert answer["accel"]["verdict"] == "refused"
    assert words in answer["accel"]["reason"], answer["accel"]["reason"]
    return answer


def test_the_answer_has_the_form_of_the_format(tmp_path, capsys):
    sensor, capture = labelled()
    code, answer = solve(tmp_path, capsys, capture)
    assert code == 0
    assert list(answer) == ["format", "sensor", "g", "accel", "gyro", "gyro_reason", "flips"]
    assert (answer["format"], answer["sensor"], answer["g"]) == (1, "mpu6050", G)
    accel = answer["accel"]
    assert list(accel) == ["P", "T", "scale", "v", "sigma", "residual_mg", "tilt_deg",
                           "tilt_spread_deg", "level", "verdict", "reason"]
    assert np.shape(accel["P"]) == (4, 4) and np.shape(accel["T"]) == (3, 3)
    assert [row[3] for row in accel["P"]] == [0, 0, 0, 1]
    assert np.shape(accel["sigma"]["P"]) == (4, 4)
    assert len(accel["sigma"]["scale"]) == len(accel["sigma"]["v"]) == 3
    assert list(accel["residual_mg"]) == [face + flip for face in (
        "Z+", "Z-", "X+", "X-", "Y+", "Y-") for flip in "ab"]
    assert (accel["level"], accel["verdict"]) == ("tilt solved", "good")
    assert accel["tilt_deg"] == pytest.approx(2, abs=0.02)
    assert accel["tilt_spread_deg"] < 0.05
    P = np.array(accel["P"])
    assert sensor.vector_error_mg(P[:3, :3].T, P[3, :3] / G) < 0.5


def test_answer_is_the_references(tmp_path, capsys):
    _, capture = labelled(seed=3)
    found = reference.solve(capture.placements(), capture.meta["accel_lsb_per_g"], G)
    accel = solve(tmp_path, capsys, capture)[1]["accel"]
    assert np.array(accel["P"]) == pytest.approx(found.P, rel=1e-9, abs=1e-12)
    assert np.array(accel["sigma"]["P"])[:, :3] == pytest.approx(found.sigma_P, rel=1e-6)
    assert accel["v"] == pytest.approx(found.v, rel=1e-9)


def test_without_labels_the_poses_are_found(tmp_path, capsys):
    capture = unlabelled(2)
    code, answer = solve(tmp_path, capsys, capture)
    assert (code, answer["accel"]["verdict"]) == (0, "good")
    assert len(answer["accel"]["residual_mg"]) == 12
    assert answer["accel"]["tilt_deg"] == pytest.approx(2, abs=0.05)


def test_gravity_of_a_place_goes_into_the_answer(tmp_path, capsys):
    _, capture = labelled()
    answer = solve(tmp_path, capsys, capture, "--lat", "0", "--height", "0")[1]
    assert answer["g"] == pytest.approx(9.7803253, abs=1e-7)
    assert solve(tmp_path, capsys, capture, "--g", "9.81")[1]["g"] == 9.81


@pytest.mark.parametrize("level", ["tilt solved", "flip average", "no flips"])
def test_levels(tmp_path, capsys, level):
    _, capture = labelled()
    answer = solve(tmp_path, capsys, capture, "--level", level)[1]
    assert answer["accel"]["level"] == level


def keep(capture, wanted):
    """Take the label off every pose that is not wanted."""
    capture.pose[~np.isin(capture.pose, [pose_code(name) for name in wanted])] = 0
    return capture


def test_six_faces_without_flips_are_doubtful_at_best(tmp_path, capsys):
    _, capture = labelled(tilt_deg=0.1)
    code, answer = solve(tmp_path, capsys, keep(capture, ["Z+a", "Z-a", "X+a", "X-a", "Y+a",
                                                          "Y-a"]))
    assert (code, answer["accel"]["verdict"]) == (0, "doubtful")
    assert "no flips" in answer["accel"]["reason"]
    assert answer["accel"]["tilt_deg"] is None


def test_a_missing_pose(tmp_path, capsys):
    _, capture = labelled()
    capture.pose[capture.pose == pose_code("Y-b")] = 0
    answer = refuse(tmp_path, capsys, capture, "Y-b missing")
    assert np.shape(answer["accel"]["P"]) == (4, 4)     # it still prints what it found


def test_a_missing_face(tmp_path, capsys):
    _, capture = labelled()
    capture.pose[np.isin(capture.pose, [pose_code("X-a"), pose_code("X-b")])] = 0
    refuse(tmp_path, capsys, capture, "face X- is missing")


def test_no_pose_at_all(tmp_path, capsys):
    _, capture = labelled()
    capture.pose[:] = 0
    answer = refuse(tmp_path, capsys, capture, "is missing")
    assert answer["accel"]["P"] is None


def rename(capture, one, other):
    a, b = pose_code(one), pose_code(other)
    capture.pose = np.select([capture.pose == a, capture.pose == b], [b, a], capture.pose).astype(
        np.int16)
    return capture


def test_swapped_poses_are_named(tmp_path, capsys):
    _, capture = labelled()
    answer = refuse(tmp_path, capsys, rename(capture, "X+a", "Z-b"), "X+a shows Z-")
    assert "Z-b shows X+" in answer["accel"]["reason"]


def test_an_inverted_axis(tmp_path, capsys):
    _, capture = labelled()
    capture.accel[:, 1] *= -1
    refuse(tmp_path, capsys, capture, "negative scale")


def placement(capture, name):
    """The slice of samples of a pose."""
    at = np.flatnonzero(capture.pose == pose_code(name))
    return slice(at[0], at[-1] + 1)


def test_a_face_eight_degrees_crooked(tmp_path, capsys):
    _, capture = labelled(tilt_deg=0.5)
    c, s = np.cos(np.radians(8)), np.sin(np.radians(8))
    for name in ("X+a", "X+b"):     # something lies under that face: it tilts about y
        at = placement(capture, name)
        x, z = capture.accel[at, 0].astype(float), capture.accel[at, 2].astype(float)
        capture.accel[at, 0], capture.accel[at, 2] = c * x - s * z, s * x + c * z
    refuse(tmp_path, capsys, capture, "X+")


def test_a_box_moved_while_captured(tmp_path, capsys):
    _, capture = labelled()
    at = placement(capture, "Y+b")
    capture.accel[at.start + 250:at.stop, 0] += 400
    refuse(tmp_path, capsys, capture, "pose Y+b moved while it was captured")


def test_a_saturated_pose(tmp_path, capsys):
    _, capture = labelled()
    capture.accel[placement(capture, "Z-a"), 2] = -32768
    refuse(tmp_path, capsys, capture, "Z-a is saturated")


def test_a_stale_pose(tmp_path, capsys):
    _, capture = labelled()
    at = placement(capture, "X-b")
    capture.accel[at] = capture.accel[at.start]
    refuse(tmp_path, capsys, capture, "X-b is stale")


def test_counts_in_steps_of_four_are_said(tmp_path, capsys):
    _, capture = labelled()
    capture.accel &= ~3
    capture_file.write(tmp_path / "capture.csv", capture)
    assert main(["solve", str(tmp_path / "capture.csv")]) == 0
    assert "multiple of 4" in capsys.readouterr().out


def test_no_colour_in_a_pipe(tmp_path, capsys):
    _, capture = labelled()
    capture_file.write(tmp_path / "capture.csv", capture)
    assert main(["solve", str(tmp_path / "capture.csv")]) == 0
    out = capsys.readouterr().out
    assert "\x1b" not in out and "good: " in out and "Z+a" in out


@pytest.mark.parametrize("tilt_deg", [0, 1, 5, 15])
@pytest.mark.parametrize("level", ["tilt solved", "flip average", "no flips"])
@pytest.mark.parametrize("turned", [False, True])
def test_reference_and_board_agree_by_different_routes(tilt_deg, level, turned):
    _, capture = labelled(seed=5, tilt_deg=tilt_deg, rest_s=1.0, move_s=0.5)
    placements = capture.placements()
    angles = {face: np.pi + 0.03 * (face - 2) for face in range(6)} if turned else None
    lsb = capture.meta["accel_lsb_per_g"]
    found = accelerometer.solve(placements, lsb, G, level, angles)
    again = reference.solve(placements, lsb, G, level, angles)
    assert np.array(found.P) == pytest.approx(again.P, rel=1e-9, abs=1e-11)
    if level != "no flips":
        assert found.tilt_deg == pytest.approx(again.tilt_deg, rel=1e-6, abs=1e-9)
    for code, left in found.residual.items():
        assert left == pytest.approx(again.residual[code], abs=1e-11)
