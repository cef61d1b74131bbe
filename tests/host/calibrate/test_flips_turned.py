"""The angle really turned, in `solve`: measured by the moves, compensated, or 180 and said so."""

import functools
import json

import numpy as np
import pytest

from sixflip.poses.faces import FACES, face_of_code
from sixflip_host.calibrate import flips_turned, solution
from sixflip_host.capture import capture_file
from sixflip_host.cli import main
from tests.worlds import hand_session
from tests.worlds.hand_session import G, Sensor, session, six_faces

SESSIONS = 20


def error_mg(sensor, found):
    P = np.array(found.accel.P)
    return sensor.vector_error_mg(P[:3, :3].T, P[3, :3] / G)


@functools.lru_cache(maxsize=None)
def errors(off, hand):
    """(median error as solved, median with half turns), mg, on a table tilted by 2 degrees."""
    rows = []
    for seed in range(SESSIONS):
        sensor = Sensor(seed)
        capture = session(sensor, six_faces(seed, 2.0, off, 0.0, hand), seed)
        half = solution.judge(capture, capture.placements(), G)
        angles = flips_turned.by_moves(capture).angles
        rows.append([error_mg(sensor, solution.judge(capture, capture.placements(), G,
                                                     angles=angles)), error_mg(sensor, half)])
    return np.median(rows, axis=0)


@pytest.mark.parametrize("off,without", [(5, 1.0), (-10, 2.0)])
def test_flips_off_to_the_same_side(off, without):
    solved, half = errors(off, 0.0)
    assert half > without
    assert solved <= 0.25


@pytest.mark.parametrize("hand", [0.0, 0.4])
def test_good_flips_lose_nothing(hand):
    solved, half = errors(0.0, hand)
    assert solved <= 1.05 * half


def command(tmp_path, capsys, capture, *words):
    """(exit code, JSON answer, words) of solve."""
    path = tmp_path / "capture.csv"
    capture_file.write(path, capture)
    main(["solve", str(path), "--json", *words])
    answer = json.loads(capsys.readouterr().out)
    code = main(["solve", str(path), *words])
    return code, answer, " ".join(capsys.readouterr().out.split())


def one_off(face, degrees, seed=2, tilt_deg=2.0, wobble_deg=0.5):
    """A session in which one flip was off by so much; the box stays flat while it is turned."""
    poses = six_faces(seed, tilt_deg)
    up = hand_session.Rotation.from_rotvec([0, 0, np.radians(degrees)])
    at = 2 * face + 1
    poses[at] = (poses[at][0], up * poses[at][1])
    return session(Sensor(seed), poses, seed, wobble_deg=wobble_deg)


def test_the_angle_is_printed_and_compensated(tmp_path, capsys):
    code, answer, words = command(tmp_path, capsys, one_off(2, -5.2))
    found = answer["flips"]
    assert (code, found["taken_as"], found["reason"]) == (0, "measured", "")
    assert found["faces"]["X+"]["measured_deg"] == pytest.approx(174.8, abs=0.3)
    assert found["faces"]["X+"]["used_deg"] == pytest.approx(174.8, abs=0.3)
    assert all(abs(found["faces"][face]["used_deg"] - 180) < 0.3 for face in FACES if face != "X+")
    assert "flip of X+ was 174." in words and "degrees: compensated" in words
    assert answer["accel"]["verdict"] == "good"
    assert answer["gyro"]["verdict"] == "doubtful"


def test_half_turns_as_asked_for(tmp_path, capsys):
    code, answer, words = command(tmp_path, capsys, one_off(2, -8, tilt_deg=3.0),
                                  "--flips", "180")
    assert answer["flips"] == {"taken_as": "180 degrees", "reason": "as asked for", "faces": {}}
    assert "flips: 180 degrees assumed: as asked for" in words
    assert answer["accel"]["verdict"] == "doubtful"
    assert "off half a turn by 8." in answer["accel"]["reason"]
    assert "about 3.7 mg at 3.0 degrees of tilt" in answer["accel"]["reason"]


def test_the_same_flip_on_a_level_table_does_not_matter(tmp_path, capsys):
    _, answer, _ = command(tmp_path, capsys, one_off(2, -8, tilt_deg=0.3), "--flips", "180")
    assert answer["accel"]["verdict"] == "good"


def test_all_short_is_a_scale_no_chip_has(tmp_path, capsys):
    sensor = Sensor(2)
    sensor.Kw = np.eye(3)
    capture = session(sensor, six_faces(2, 3.0, -10.0, 0.05), 2, wobble_deg=0.5)
    _, answer, _ = command(tmp_path, capsys, capture, "--flips", "180")
    assert answer["accel"]["verdict"] == answer["gyro"]["verdict"] == "doubtful"
    assert "every flip was short by 9.8 degrees" in answer["accel"]["reason"]
    assert "about 4.5 mg at 3.0 degrees of tilt" in answer["accel"]["reason"]
    assert "every flip was short by 9.8 degrees" in answer["gyro"]["reason"]
    # by the moves they are known: nothing to doubt in the accelerometer, all in the gyro
    _, answer, _ = command(tmp_path, capsys, capture)
    assert answer["accel"]["verdict"] == "good"
    assert answer["gyro"]["verdict"] == "doubtful"
    assert "turned by 170.0 degrees, not 180" in answer["gyro"]["reason"]


def test_a_chip_that_really_is_off_is_believed_when_the_moves_say_so(tmp_path, capsys):
    sensor = Sensor(2)
    sensor.Kw = np.eye(3) * 0.945
    capture = session(sensor, six_faces(2, 4.0), 2, wobble_deg=0.5)
    _, answer, _ = command(tmp_path, capsys, capture)
    assert answer["accel"]["verdict"] == answer["gyro"]["verdict"] == "good"
    _, answer, _ = command(tmp_path, capsys, capture, "--flips", "180")
    assert answer["accel"]["verdict"] == answer["gyro"]["verdict"] == "good"


def without_moves(capture):
    """The gyro sees the flips, but was off its rails between the faces."""
    rests = capture.placements()
    for a, b in zip(rests, rests[1:]):
        if face_of_code(a.pose) != face_of_code(b.pose):
            capture.gyro[a.first + a.n:b.first] = 32767
    return capture


def test_moves_that_do_not_tell_the_scale(tmp_path, capsys):
    capture = without_moves(one_off(2, -5, tilt_deg=0.3, wobble_deg=0))
    _, answer, words = command(tmp_path, capsys, capture)
    assert answer["flips"]["taken_as"] == "180 degrees"
    assert "do not determine the gyro's scale" in answer["flips"]["reason"]
    assert "flips: 180 degrees assumed: the face-to-face moves do not determine" in words


@pytest.mark.parametrize("change,reason", [
    (lambda c: setattr(c, "gyro", None), "the capture has no gyro columns"),
    (lambda c: c.gyro.__imul__(0), "the moves tell nothing (gyro x reads the same"),
    (lambda c: c.gyro.__imul__(-1), "the moves tell nothing (gravity at the two ends"),
    (lambda c: setattr(c, "pose", None), "no poses were found")])
def test_180_degrees_and_why(change, reason):
    capture = one_off(2, -5)
    change(capture)
    found = flips_turned.by_moves(capture)
    assert found.angles == {} and found.reason.startswith(reason), found.reason


def test_a_turn_too_far_off_is_not_compensated():
    found = flips_turned.by_moves(one_off(4, -60))
    assert FACES.index("Y+") in found.measured and FACES.index("Y+") not in found.angles
    assert any("Y+" in line and "too far off" in line for line in found.words())
