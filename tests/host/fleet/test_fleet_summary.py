"""A summary is its capture to the last digit, as far as solve and the rests' model look at it."""
import copy
import io

import numpy as np
import pytest

from sixflip_host.calibrate import solution, solution_json
from sixflip_host.capture import capture_file
from sixflip_host.diagnosis import rest_model, rests_judged, samples_judged, settings
from sixflip_host.errors import BadFile
from sixflip_host.experiment import attitude_fit, blocks, session_terms
from sixflip_host.experiment.session import OF_BLOCKS
from sixflip_host.fleet import analysis, diagnosed, effects, sources, summary, summary_file
from sixflip_host.simulation import scenario, simulated_session


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """(path, Capture, Summary) of a session of the paper's twelve poses."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "backward", "seed": 4, "effects": [
        {"effect": "thermal_bias", "sensor": "accel", "z": -1.0}]})
    path = str(tmp_path_factory.mktemp("board") / "s.csv")
    capture_file.write(path, simulated_session.session(plan, 0))
    capture = capture_file.read(path)
    return path, capture, summary_file.of_capture(path)[0]


def test_it_is_solved_as_the_capture_is(captured):
    _, capture, one = captured
    assert solution_json.to_json(one.solved()) == solution_json.to_json(solution.solve(capture))


def test_the_rests_of_both_are_the_same_rows(captured):
    _, capture, one = captured
    units = []
    for session in (blocks.session_of("s", capture), one.session()):
        nominal = attitude_fit.fit(session)
        model = rest_model.RestModel("gyro", "mpu6050", settings.Settings())
        units.append(model.unit(session_terms.agreed([session])[0], nominal, False))
        assert session.contradicted() == []
    assert np.array_equal(units[0].quadratic, units[1].quadratic)
    assert np.array_equal(units[0].inner, units[1].inner)


def test_a_part_and_fewer_poses_are_those_of_the_capture(captured):
    _, capture, one = captured
    both = blocks.session_of("s", capture), one.session()
    for change in (lambda s: s.part(range(3, 9)), lambda s: s.without_poses(["Z-a", "X+b"])):
        mine, kept = (change(session) for session in both)
        for name in OF_BLOCKS:
            assert np.array_equal(getattr(mine, name), getattr(kept, name)), name
        assert np.array_equal(mine.friction, kept.friction)
        assert np.array_equal(mine.turned, kept.turned)
        up = np.eye(3)[np.zeros(len(mine.runs), int)]
        assert np.array_equal(mine.remembered(up, 60.0), kept.remembered(up, 60.0))


def test_it_is_under_two_kilobytes_a_pose(captured):
    _, _, one = captured
    assert len(one.placements()) == 24
    assert len(summary_file.encode(one)) < 2000 * len(one.placements())


def test_the_kept_one_is_read_while_the_capture_is_the_same(captured, monkeypatch):
    path, _, one = captured
    monkeypatch.setattr(summary_file.open_recording, "read_samples", lambda path: 1 / 0)
    again, why = summary_file.of_capture(path)
    assert again.about == one.about and why == ""
    with open(path, "ab") as file:
        file.write(b"1,2\n")
    with pytest.raises(ZeroDivisionError):
        summary_file.of_capture(path)


def test_the_effect_of_the_capture_is_in_its_information(captured):
    _, _, one = captured
    found, _ = effects.information(rests_judged.usable_rests([one.session()], [], []), "mpu6050")
    k = effects.NAMES["accel"].index("accel.thermal_bias.z")
    precision, score = found["accel"].precision, found["accel"].score
    sigma = 1.0 / np.sqrt(precision[k, k])
    assert abs(score[k] / precision[k, k] + 1.0) < 4.0 * sigma + 0.2
    assert abs(score[k]) * sigma > 5.0


def test_a_board_is_diagnosed_from_its_summary(captured):
    _, _, one = captured
    found, *_ = diagnosed.diagnose_board([one], [one.session()])
    cause, = (c for c in found["causes"] if c["sensor"] == "accel")
    assert "thermal_bias" in cause["class"] and cause["axes"] == ["z"]
    assert found["gap"]["accel"]["before"] > 0.0 and "gyro" in found["gap"]
    assert "of the accelerometer z" in diagnosed.words(found)


def test_a_board_has_the_same_effects_with_a_diagnosis_and_without(captured):
    _, _, one = captured
    _, rests, gaps = diagnosed.diagnose_board([one], [one.session()])
    alone, _ = effects.information(rests, "mpu6050")
    beside, _ = effects.information(rests, "mpu6050", gaps)
    for sensor, own in alone.items():
        scale = np.sqrt(np.maximum(np.diag(own.precision), 1e-12))  # of what shows nothing
        assert (scale > 1e-3).sum() > 6
        off = (beside[sensor].precision - own.precision) / scale / scale[:, None]
        assert np.abs(off).max() < 1e-6
        assert np.abs((beside[sensor].score - own.score) / scale).max() < 1e-4


def test_what_only_samples_show_is_in_the_diagnosis_as_it_was_found(captured):
    _, _, one = captured
    seen = {"sensor": "accel", "effect": "vibration", "axes": ["x"], "domain": "frequency",
            "score_nats": 60.0, "words": "at 20 Hz", "value": {"x": 5.0}, "unit": "mg",
            "plausible": True, "share": 0.9, "number": 10.0, "place": {"vibration": 0.999}}
    samples = dict(one.about["samples"], findings=[seen])
    few = one.session().part(range(3)).of_runs(())    # nothing but what the samples say
    told = summary.Summary(dict(one.about, samples=samples), one.arrays)
    found, *_ = diagnosed.diagnose_board([told], [few])
    assert [c["effect"] for c in found["causes"]] == ["vibration"]
    assert found["verdict"] == "cannot tell"


def test_a_capture_without_a_pose_is_no_session(captured, tmp_path):
    _, capture, _ = captured
    moving = capture_file.Capture(capture.meta, capture.t_us[:500], capture.accel[:500],
                                  pose=np.zeros(500, np.int16))
    path = str(tmp_path / "m.csv")
    capture_file.write(path, moving)
    row = analysis.row(sources.Board("m", "", (path,)))
    assert row["failure"] == "no session: nothing lies still in a pose that is known, in m.csv"


def test_a_damaged_one_is_one_sentence(captured):
    _, _, one = captured
    data = summary_file.encode(one)
    for bad in (b"", data[:200], data[:-40], b"PK" + data[5:], data.replace(b"npy", b"npz"),
                data[:900] + bytes(64) + data[964:]):
        with pytest.raises(BadFile, match="summary"):
            summary_file.decode("s", bad)


def test_arrays_of_another_shape_are_refused(captured):
    _, _, one = captured
    for name in ("placement_sums", "move_of", "runs"):
        changed = dict(one.arrays, **{name: np.zeros((2, 3, 1))})
        with pytest.raises(BadFile, match="damaged"):
            summary_file.decode("s", summary_file.encode(summary.Summary(one.about, changed)))
    out = io.BytesIO()
    np.savez(out, about=np.array([{"x": 1}], object))
    with pytest.raises(BadFile, match="damaged"):
        summary_file.decode("s", out.getvalue())


def test_numbers_out_of_range_are_refused_one_by_one(captured):
    _, _, one = captured
    changes = {
        "placement_of": (0, 0, 9999), "placement_sums": (0, 2, 1 << 40),
        "placement_noise": (1, 1, -1.0), "move_of": (0, 1, 99), "runs": (0, 0, 0),
        "block_placement": (0, None, 50), "block_t": (3, None, 1e6),
        "block_seconds": (0, None, 0.0), "block_accel": (0, 0, np.nan),
        "block_noise_accel": (0, None, 0.0), "thermometer": (2, None, np.inf)}
    for name, (row, column, value) in changes.items():
        array = np.array(one.arrays[name])
        array[(row,) if column is None else (row, column)] = value
        changed = summary.Summary(one.about, dict(one.arrays, **{name: array}))
        with pytest.raises(BadFile, match="damaged"):
            summary_file.decode("s", summary_file.encode(changed))
    assert summary_file.decode("s", summary_file.encode(one)).solved().verdict


def test_a_capture_is_summarised_without_what_nobody_read(captured):
    """Rows with 0 on all axes of the accelerometer were in the means of a board's rests, which
    `diagnose` leaves them out of."""
    _, capture, one = captured
    spoilt = copy.copy(capture)
    spoilt.accel = np.array(capture.accel)
    spoilt.accel[np.random.default_rng(2).choice(len(capture), 200, replace=False)] = 0
    made = summary.summarise("s", spoilt)
    gap, whole = (diagnosed.diagnose_board([each], [each.session()])[0] for each in (made, one))
    assert gap["verdict"] == whole["verdict"]
    assert [c["effect"] for c in gap["causes"]] == [c["effect"] for c in whole["causes"]]
    read, (damage,) = samples_judged.without_damage([("s", spoilt)])
    assert damage.value == {"rows": 200} and damage.words in made.solved().remarks
    assert solution_json.to_json(made.solved())["accel"] == solution_json.to_json(
        solution.solve(read[0][1]))["accel"]
