"""`sixflip refine` as a user meets it: answers, records, and one sentence for bad input."""

import argparse
import contextlib
import io
import json

import numpy as np
import pytest

from sixflip.record import correction_record
from sixflip_host import record_terms
from sixflip_host.calibrate import refinement, refinement_record
from sixflip_host.capture import capture_file
from sixflip_host.errors import SixflipError
from sixflip_host.present import calibration_words
from sixflip_host.verbs import refine
from tests.worlds import hand_session
from tests.worlds.hand_session import RAD, G


@pytest.fixture(scope="module")
def sensor():
    return hand_session.Sensor(1)


@pytest.fixture(scope="module")
def capture(sensor):
    return hand_session.session(sensor, hand_session.six_faces(1, 1.0, 0.0, 0.0, 0.4), 1)


def command(*words):
    parser = argparse.ArgumentParser()
    refine.add_arguments(parser)
    return refine.run(parser.parse_args([str(word) for word in words]))


def written(tmp_path, capture, name="capture.csv"):
    path = tmp_path / name
    capture_file.write(path, capture)
    return path


def text(found):
    """What is printed of it."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        calibration_words.show_refinement(found)
    return out.getvalue()


def test_json_has_the_form_of_solve(tmp_path, capture, sensor, capsys):
    assert command(written(tmp_path, capture), "--json") == 0
    found = json.loads(capsys.readouterr().out)
    P = np.array(found["accel"]["P"])
    assert sensor.vector_error_mg(P[:3, :3].T, P[3, :3] / G) < 0.5
    assert np.abs(np.array(found["accel"]["v"]) / G + sensor.b).max() < 1e-3
    assert np.shape(found["accel"]["sigma"]["P"]) == (4, 4)
    assert np.shape(found["gyro"]["P"]) == (4, 3)
    assert np.abs(np.array(found["gyro"]["bias_dps"]) - sensor.bw).max() < 0.02
    assert set(found["flips"]) == {"Z+", "Z-", "X+", "X-", "Y+", "Y-"}
    assert found["verdict"] == "good"


def test_a_flip_off_half_a_turn_is_flagged_by_name(sensor):
    poses = hand_session.six_faces(2, 2.0)
    up = hand_session.Rotation.from_rotvec([0, 0, 7 * RAD])
    poses[5] = (poses[5][0], up * poses[5][1])  # X+b
    found = refinement.refine(hand_session.session(sensor, poses, 2))
    assert [face for face, flip in found["flips"].items() if flip["off"]] == ["X+"]
    assert abs(found["flips"]["X+"]["angle_deg"] - 187.0) < 0.3
    assert "X+" in text(found) and "deg off a half turn" in text(found)


def test_a_and_b_found_far_apart_are_no_flip(sensor):
    """Unlabelled, Z+ visited twice with other faces between: not one table's flip."""
    poses = hand_session.six_faces(6, 2.0)
    order = [0, 4, 6, 8, 10, 2, 1]
    free = hand_session.session(sensor, [poses[k] for k in order], 6)
    flip = refinement.refine(free)["flips"]["Z+"]
    assert flip["reason"] == "no gyro over this flip, 180 assumed"
    free.pose = None
    found = refinement.refine(free)
    assert found["flips"] == {}
    assert found["verdict"] == "doubtful"


def test_a_record_is_written_and_read_back(tmp_path, capture):
    out = tmp_path / "refined.bin"
    assert command(written(tmp_path, capture), "-o", out) == 0
    record = correction_record.decode(out.read_bytes())
    found = refinement.refine(capture)
    assert np.abs(np.array(record.accel["P"]) - found["accel"]["P"]).max() < 1e-12
    assert record.measured() == ["accel", "gyro", "gyro_bias"]
    assert record.accel["verdict"] == "good"


def test_six_faces_without_labels_or_gyro_are_refused(tmp_path, sensor, capsys):
    bare = hand_session.session(sensor, hand_session.six_faces(3, 0.0), 3, gyro=False)
    record = tmp_path / "out.bin"
    assert command(written(tmp_path, bare), "--free", "-o", record) == 1
    out = capsys.readouterr().out
    assert "refused: these poses determine 6 of 9 parameters" in out
    assert not record.exists()


def test_without_gyro_the_accelerometer_is_still_refined(sensor):
    bare = hand_session.session(sensor, hand_session.six_faces(3, 2.0), 3, gyro=False)
    found = refinement.refine(bare)
    P = np.array(found["accel"]["P"])
    assert sensor.vector_error_mg(P[:3, :3].T, P[3, :3] / G) < 0.3
    assert found["gyro"] is None
    assert "no gyro columns" in text(found)


def test_faces_that_were_never_flipped_are_doubtful(sensor):
    found = refinement.refine(hand_session.session(sensor, hand_session.six_faces(4, 1.0)[::2], 4))
    assert found["verdict"] == "doubtful"
    assert "the table's tilt is in the result" in found["reason"]


def test_gyro_saturated_in_every_flip(sensor):
    fast = hand_session.session(sensor, hand_session.six_faces(5), 5, move_s=0.5)
    with pytest.raises(SixflipError, match="the gyro is saturated in every"):
        refinement.refine(fast)


def test_jumping_timestamps(capture):
    jumpy = capture_file.Capture(
        capture.meta, capture.t_us.copy(), capture.accel, capture.gyro, pose=capture.pose)
    moving = np.flatnonzero(np.diff((capture.pose == 0).astype(int)) == 1) + 50
    for start in moving:
        jumpy.t_us[start:] += 400000
    with pytest.raises(SixflipError, match=r"timestamps jump by 0\.4"):
        refinement.refine(jumpy)


def test_pauses_while_a_flash_is_written_are_bridged(capture):
    keep = np.ones(len(capture), bool)
    for start in np.flatnonzero(np.diff((capture.pose == 0).astype(int)) == 1):
        keep[start + 60:start + 65] = False
    paused = refinement.refine(capture_file.Capture(
        capture.meta, capture.t_us[keep], capture.accel[keep], capture.gyro[keep],
        pose=capture.pose[keep]))
    found = refinement.refine(capture)
    assert paused["moves_left_out"] == []
    assert np.abs(np.subtract(paused["gyro"]["P"], found["gyro"]["P"])).max() < 2e-3


def changed(capture, accel=None, gyro=None, t_us=None, pose=None):
    return capture_file.Capture(
        capture.meta, capture.t_us if t_us is None else t_us,
        capture.accel if accel is None else accel, capture.gyro if gyro is None else gyro,
        pose=capture.pose if pose is None else pose)


@pytest.mark.parametrize("change, sentence", [
    (lambda c: {"accel": c.accel * 0}, r"rest Z\+a reads 0\.00 g, expected about 1 g"),
    (lambda c: {"gyro": c.gyro * 0}, "gyro x reads the same in every sample"),
    (lambda c: {"t_us": c.t_us * 0}, "the timestamps stand still"),
    (lambda c: {"pose": np.where(c.pose == 1, 3, c.pose)}, "rest Z-a is labelled Z-, but"),
])
def test_nonsense_is_one_sentence(capture, change, sentence):
    with pytest.raises(SixflipError, match=sentence):
        refinement.refine(changed(capture, **change(capture)))


def test_labels_too_short_to_be_rests(capture):
    pose = np.zeros_like(capture.pose)
    pose[5:12] = 1
    with pytest.raises(SixflipError, match="no rests, expected labelled poses"):
        refinement.refine(changed(capture, pose=pose))


def test_two_faces_do_not_make_a_calibration(sensor):
    found = refinement.refine(hand_session.session(sensor, hand_session.six_faces(1)[:4], 1))
    assert found["verdict"] == "refused"
    assert "accelerometer x scale" in found["reason"]


def test_one_bad_move_is_left_out_and_said(capture):
    gyro = capture.gyro.copy()
    first = int(np.flatnonzero(capture.pose == 0)[50])
    gyro[first, 1] = 32767
    found = refinement.refine(capture_file.Capture(
        capture.meta, capture.t_us, capture.accel, gyro, pose=capture.pose))
    assert found["moves_left_out"] == ["move Z+a to Z+b: the gyro is saturated"]
    assert found["flips"]["Z+"]["measured_deg"] is None
    assert found["moves"] == 10


def test_no_rests(capture):
    with pytest.raises(SixflipError, match="12 or more are needed|expected"):
        refinement.refine(capture_file.Capture(
            capture.meta, capture.t_us[:600], capture.accel[:600], capture.gyro[:600]), free=True)


@pytest.mark.parametrize("wrong", [
    lambda gyro: gyro[:, [1, 0, 2]], lambda gyro: gyro * np.array([1, 1, -1], dtype=np.int16)])
def test_a_swapped_or_inverted_gyro_axis_is_refused(capture, wrong):
    found = refinement.refine(changed(capture, gyro=wrong(capture.gyro)))
    assert found["verdict"] == "refused"
    assert "is a gyro axis swapped or inverted?" in found["reason"]


@pytest.fixture(scope="module")
def aged(capture):
    """A record, and the same sensor later: biases and one gyro scale have drifted."""
    found = refinement.refine(capture)
    record = correction_record.encode(refinement_record.build(capture, found))
    later = hand_session.Sensor(1)
    later.b = later.b + [0.012, -0.020, 0.015]
    later.bw = later.bw + [0.3, -0.2, 0.5]
    later.Kw[2] *= 1.004
    return record, later


@pytest.mark.parametrize("ramp", [False, True])
def test_a_vehicle_solves_what_its_floor_tells(aged, ramp):
    data, later = aged
    session = hand_session.session(later, hand_session.on_the_floor(ramp), 2, wobble_deg=1.0)
    found = refinement.refine(session, record=correction_record.decode(data))
    biases = ["%s %s bias" % (what, a) for what in ("accelerometer", "gyro") for a in "xyz"]
    assert set(biases) <= set(found["solved"])
    for name in ("accelerometer x scale", "accelerometer z scale", "accelerometer xy"):
        assert name in found["kept"]
    assert not set(found["solved"]) & set(found["kept"])
    P = np.array(found["accel"]["P"])
    before = np.array(correction_record.decode(data).accel["P"])
    assert (P[:3, 0] == before[:3, 0]).all()  # kept to the last bit
    assert later.vector_error_mg(P[:3, :3].T, P[3, :3] / G) < 0.5
    assert later.vector_error_mg(before[:3, :3].T, before[3, :3] / G) > 20
    assert np.abs(np.array(found["gyro"]["bias_dps"]) - later.bw).max() < 0.05
    assert "kept from the record: " in text(found)


def test_the_ramp_tells_the_gyro_about_the_vertical(aged):
    """Turning on a slope, gravity sees the turn; on a level floor only the half turn is known."""
    data, later = aged
    session = hand_session.session(later, hand_session.on_the_floor(True), 2, wobble_deg=1.0)
    found = refinement.refine(session, record=correction_record.decode(data))
    assert "gyro z scale" in found["solved"]
    assert found["gyro"]["scale_from_moves_sigma"][2] < 0.002


def test_keep_through_the_command(tmp_path, aged, capsys):
    data, later = aged
    kept, out = tmp_path / "record.bin", tmp_path / "new.bin"
    kept.write_bytes(data)
    path = written(tmp_path, hand_session.session(later, hand_session.on_the_floor(), 2))
    assert command(path, "--record", kept, "-o", out) == 0
    assert "solved by this session: " in capsys.readouterr().out
    old, new = correction_record.decode(data), correction_record.decode(out.read_bytes())
    assert new.sequence == old.sequence + 1
    assert new.accel["level"] == old.accel["level"]


def test_keep_of_something_else_is_one_sentence(tmp_path, capture):
    path = written(tmp_path, capture)
    with pytest.raises(SixflipError, match="no correction record"):
        command(path, "--record", path)
    with pytest.raises(SixflipError, match="expected one of the two"):
        command(path, "--record", path, "--free")


def test_a_pull_of_gravity_goes_into_the_record_as_its_term(tmp_path, capture):
    out = tmp_path / "refined.bin"
    assert command(written(tmp_path, capture), "-o", out, "--g-sensitivity", "on") == 0
    record = correction_record.decode(out.read_bytes())
    gyro = refinement.refine(capture, g_sensitivity="on")["gyro"]
    term = record_terms.terms(record)["g_sensitivity"]
    assert term["k"] == gyro["per_g_dps"] and term["origin"] == "refinement"
    assert command(written(tmp_path, capture), "-o", out) == 0
    assert correction_record.decode(out.read_bytes()).terms == []


def test_a_refined_bias_holds_at_the_temperature_it_was_refined_at(sensor):
    warm = hand_session.session(sensor, hand_session.six_faces(3, 2.0), 3)
    warm.temp = np.full(len(warm), 340 * 4, np.int16)
    warm.meta.update(temp_lsb_per_c=340.0, temp_offset_c=36.53)
    kept = refinement_record.build(warm, refinement.refine(warm))
    assert kept.temp_c == pytest.approx(40.53)
    kept.temp_c = 20.0
    again = refinement_record.build(warm, refinement.refine(warm, record=kept), kept)
    assert again.temp_c == pytest.approx(40.53)
