"""The gyro in the answer of solve, and sessions that cannot give one."""

import json

import numpy as np
import pytest

from sixflip_host.capture import capture_file
from sixflip_host.capture.capture import Capture
from sixflip_host.cli import main
from tests.worlds.hand_session import Sensor, session, six_faces


def labelled(seed=4, gyro=True, wobble_deg=0.5):
    sensor = Sensor(seed)
    return sensor, session(sensor, six_faces(seed, 2.0, hand_deg=0.4), seed, gyro=gyro,
                           wobble_deg=wobble_deg)


def solve(tmp_path, capsys, capture, *words):
    """The JSON answer of a session whose accelerometer is good, and the words."""
    path = tmp_path / "capture.csv"
    capture_file.write(path, capture)
    assert main(["solve", str(path), "--json", *words]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["accel"]["verdict"] == "good"
    assert main(["solve", str(path), *words]) == 0
    return answer, " ".join(capsys.readouterr().out.split())


def flips(capture):
    """Slices of the samples of every flip, in the order of the session."""
    rests = capture.placements()
    return [slice(a.first + a.n, b.first) for a, b in zip(rests, rests[1:])
            if (a.pose - 1) // 2 == (b.pose - 1) // 2]


def test_the_answer_has_the_form_of_the_format(tmp_path, capsys):
    sensor, capture = labelled()
    answer, words = solve(tmp_path, capsys, capture)
    gyro = answer["gyro"]
    assert list(gyro) == ["P", "bias_dps", "sigma", "flips", "verdict", "reason"]
    assert np.shape(gyro["P"]) == (4, 3) == np.shape(gyro["sigma"]["P"])
    P = np.array(gyro["P"])
    assert P[:3].T @ sensor.Kw == pytest.approx(np.eye(3), abs=0.006)
    assert gyro["bias_dps"] == pytest.approx(sensor.bw, abs=0.02)
    assert list(gyro["flips"]) == ["Z+", "Z-", "X+", "X-", "Y+", "Y-"]
    for face, flip in gyro["flips"].items():
        assert list(flip) == ["angle_deg", "used", "fault", "reason"]
        assert flip["used"] and flip["angle_deg"] == pytest.approx(180, abs=2)
        assert "%.2f" % flip["angle_deg"] in words and face in words
    assert gyro["verdict"] == "good" and "turned, deg" in words


def test_a_move_of_which_no_sample_was_kept(tmp_path, capsys):
    """As where a board has taken a face again and a block ends where the next one begins."""
    _, capture = labelled()
    first, second = capture.placements()[1:3]
    assert first.pose != second.pose and second.first > first.first + first.n
    kept = np.ones(len(capture), bool)
    kept[first.first + first.n:second.first] = False
    less = Capture(capture.meta, capture.t_us[kept], capture.accel[kept], capture.gyro[kept],
                   pose=capture.pose[kept])
    gyro = solve(tmp_path, capsys, less)[0]["gyro"]
    assert gyro["verdict"] == "good"
    assert gyro["flips"] == solve(tmp_path, capsys, capture)[0]["gyro"]["flips"]


def test_without_gyro_columns(tmp_path, capsys):
    _, capture = labelled(gyro=False)
    answer, words = solve(tmp_path, capsys, capture)
    assert answer["gyro"] is None and "no gyro columns" in answer["gyro_reason"]
    assert "gyro: not calibrated: the capture has no gyro columns" in words


def test_saturated_in_every_flip(tmp_path, capsys):
    """The gyro is refused and says why; the accelerometer is what it would have been."""
    _, capture = labelled()
    before, _ = solve(tmp_path, capsys, capture, "--flips", "180")
    for flip in flips(capture):
        capture.gyro[flip.start + 100, 1] = -32768
    answer, words = solve(tmp_path, capsys, capture)
    assert answer["accel"] == before["accel"]
    gyro = answer["gyro"]
    assert gyro["verdict"] == "refused"
    assert all(not flip["used"] and "saturated" in flip["reason"]
               for flip in gyro["flips"].values())
    assert "no usable flip" in gyro["reason"] and "saturated" in gyro["reason"]
    assert gyro["sigma"]["P"][:3] == [[None] * 3] * 3 and "1.00000, not measured" in words
    assert "gyro: refused: no usable flip" in words


def test_time_jumps_inside_a_flip(tmp_path, capsys):
    """That flip alone is left out, with the reason, and the jump is spoken of."""
    _, capture = labelled()
    second = flips(capture)[1]
    capture.t_us[second.start + 120:] += 7_000_000
    answer, words = solve(tmp_path, capsys, capture)
    gyro = answer["gyro"]
    assert [face for face, flip in gyro["flips"].items() if not flip["used"]] == ["Z-"]
    assert gyro["flips"]["Z-"]["reason"] and gyro["verdict"] == "doubtful"
    assert "one flip alone about z" in gyro["reason"]
    assert "the timestamps jump in 1 place, the farthest by 7.01 s after sample" in words


def test_time_jumps_inside_a_rest(tmp_path, capsys):
    """A rest is a rest however long its samples were away."""
    _, capture = labelled()
    before, _ = solve(tmp_path, capsys, capture, "--flips", "180")
    capture.t_us[200:] += 60_000_000
    answer, words = solve(tmp_path, capsys, capture, "--flips", "180")
    assert answer["accel"] == before["accel"]
    assert np.array(answer["gyro"]["P"]) == pytest.approx(np.array(before["gyro"]["P"]), abs=1e-4)
    assert "the timestamps jump" in words


def test_milliseconds_for_microseconds(tmp_path, capsys):
    """Half a turn would be a fifth of a degree: what to correct is said in one line."""
    _, capture = labelled()
    capture.t_us //= 1000
    path = tmp_path / "capture.csv"
    capture_file.write(path, capture)
    assert main(["solve", str(path)]) == 4
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "its samples are 10 us apart, expected about 1e+04: rate_hz is 100; correct the one " \
        "that is wrong, times are in microseconds" in said


def test_a_clock_at_twice_the_rate(tmp_path, capsys):
    """One that does not fit the header is named: half a turn would be a quarter."""
    _, capture = labelled()
    capture.t_us //= 2
    answer, words = solve(tmp_path, capsys, capture)
    assert "the timestamps say 200 samples a second, the header 100" in words
    assert answer["gyro"]["verdict"] == "refused"


def test_refine_says_it_in_one_line(tmp_path, capsys):
    _, capture = labelled(gyro=False)
    path = tmp_path / "capture.csv"
    capture_file.write(path, capture)
    main(["refine", str(path)])
    said = capsys.readouterr()
    assert "gyro" in said.out + said.err
