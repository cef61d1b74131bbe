"""sixflip plan: its words, its JSON, its plan file and its complaints."""
import json

import pytest

from sixflip_host.cli import Parser, main
from sixflip_host.errors import BadFile, UsageError
from sixflip_host.planning import detectable, plan_answer, plan_file, protocols
from sixflip_host.planning.alias import PlannedModel
from sixflip_host.planning.plan_findings import findings_of
from sixflip_host.planning.protocols import rows_of
from sixflip_host.verbs import plan
from sixflip_sim.effects.library import NAMES


def planned(capsys, *words):
    parser = Parser()
    plan.add_arguments(parser)
    assert plan.run(parser.parse_args(list(words))) == 0
    return capsys.readouterr().out


def of(answer, effect, sensor="accel"):
    return [e for e in answer["effects"] if (e["effect"], e["sensor"]) == (effect, sensor)][0]


def test_json_of_the_paper_session(capsys):
    answer = json.loads(planned(capsys, "--protocol", "paper", "--json"))
    assert answer["accel"] == {"equations": 36, "residual": 24, "even_contrasts": 6}
    assert answer["minutes"] == 3.0 and answer["placements"] == 12
    assert {e["effect"] for e in answer["effects"]} == set(NAMES)
    assert of(answer, "cubic")["silent"] and of(answer, "cubic")["absorbed_by"] == "scale"
    assert of(answer, "quadratic")["absorbed_by"] == "box"
    assert of(answer, "thermal_bias")["class"]["box_tilt"] == pytest.approx(0.98, abs=0.1)
    assert of(answer, "hysteresis")["class"] == {"creep": pytest.approx(1.0, abs=0.01)}
    assert of(answer, "earth_rate", "gyro")["class"] == {"g_sensitivity": 1.0}
    assert not of(answer, "thermal_bias")["seen_at_typical_size"]


def test_the_recommended_session_sees_what_the_paper_one_cannot(capsys):
    answer = json.loads(planned(capsys, "--json"))
    for effect in ("cubic", "quadratic", "thermal_bias", "thermal_scale", "warm_up", "creep"):
        assert of(answer, effect)["seen_at_typical_size"], effect
    assert "warm_up" not in of(answer, "thermal_bias")["class"]
    assert of(answer, "local_gravity")["silent"]
    assert 10 <= answer["minutes"] / 2 <= 15  # each of the two sessions


def test_words_and_picture(capsys, tmp_path):
    picture = tmp_path / "alias.png"
    words = planned(capsys, "--protocol", "paper", "--plot", str(picture))
    words = " ".join(words.replace("|", " ").split())  # whatever the terminal's width
    assert "24 residual degrees of freedom" in words
    assert "absorbed by scale" in words and "What to add" in words
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_certified_box_brings_back_the_even_nonlinearity(capsys):
    answer = json.loads(planned(capsys, "--protocol", "paper", "--certified-box", "--json"))
    assert not of(answer, "quadratic")["silent"]
    assert "asymmetry" in of(answer, "quadratic")["class"]


def test_smallest_sizes_agree_with_the_prototype():
    """mg/degC, mg/g2, mg/g of 12 poses and of 24 there and back, white + placement + flicker."""
    expected = {"paper": {"thermal_bias": 0.625, "quadratic": 1.226, "hysteresis": 0.373},
                "backward": {"thermal_bias": 0.178, "quadratic": 0.871, "hysteresis": 0.254}}
    for name, sizes in expected.items():
        design = PlannedModel(rows_of(protocols.named(name)), certified_box=True)
        power = detectable.power_of(design, "mpu6050-accel")
        for effect, size in sizes.items():
            found = detectable.middle(power.smallest(effect))
            assert found == pytest.approx(size, rel=0.1), (name, effect)


def test_a_simulated_drift_of_the_smallest_size_is_seen_four_times_in_five():
    import numpy as np
    design = PlannedModel(rows_of(protocols.named("backward")), certified_box=True)
    power = detectable.power_of(design, "mpu6050-accel")
    size = power.smallest("quadratic")["x"]
    column = design.raw("quadratic")[1][:, 0]
    from sixflip_host.experiment.projection import without
    left = without(power.space, power.whitened(column[:, None]))[:, 0]
    direction = left / np.linalg.norm(left)
    draw = np.random.default_rng(1)
    noise = np.linalg.inv(power.whitened(np.eye(len(column)))) @ draw.normal(
        size=(len(column), 4000))
    z = direction @ power.whitened(noise + size * column[:, None])
    seen = (np.abs(z) > detectable.QUANTILE - detectable.POWER_80).mean()
    assert seen == pytest.approx(0.80, abs=0.03)


def test_additions_resolve_something_and_are_ranked():
    protocol = protocols.named("paper")
    base = findings_of(protocol)
    additions = plan_answer.ranked(protocol, base, "mpu6050", False, 100.0)
    rates = [a.per_minute for a in additions]
    assert rates == sorted(rates, reverse=True) and min(rates) > 0
    named = {a.name: a for a in additions}
    assert ("accel", "creep", "hysteresis") in named["dwell of 60 s"].pairs
    assert ("accel", "thermal_bias", "warm_up") in named["a cooling session"].pairs
    assert ("accel", "cubic") in named["12 leaning poses"].shown
    short = plan_answer.ranked(protocol, base, "mpu6050", False, 100.0, most_minutes=4.0)
    assert {a.name for a in short} <= {"random order", "return to the first pose",
                                       "turns both ways"}


def test_plan_file_round_trip(tmp_path):
    path = tmp_path / "plan.json"
    protocol = protocols.named("recommended")
    plan_file.write(path, protocol)
    again = plan_file.read(path)
    assert plan_file.to_plan(again) == plan_file.to_plan(protocol)
    assert len(again.sessions[0].rests) == 39
    path.write_text('["Z+a", {"pose": "L1", "dwell_s": 8}, "Z+a"]', encoding="utf-8")
    rests = plan_file.read(path).sessions[0].rests
    assert [r.pose for r in rests] == ["Z+a", "L1", "Z+a"] and rests[1].dwell_s == 8.0


@pytest.mark.parametrize("text, expected", [
    ("{", "not JSON"), ("[]", "no poses"), ("3", "expected an object"),
    ('{"sessions": []}', "at least one"), ('["Q+a"]', "no pose is called"),
    ('[{"pose": "Z+a", "dwell_s": -1}]', "dwell_s is -1"),
    ('[{"pose": "Z+a", "dwell": 1}]', "unknown key 'dwell'"),
    ('[{"pose": "Z+a", "turn": "up"}]', "expected left or right"),
    ('[{"pose": "L1", "up": [0, 0, 0]}]', "not all 0"),
    ('{"sixflip_plan": 9, "sessions": [{"poses": ["Z+a"]}]}', "version"),
    ('[{"pose": "Z+a", "dwell_s": NaN}]', "dwell_s is nan"),
])
def test_bad_plan_files_name_the_file_and_what_was_expected(tmp_path, text, expected):
    path = tmp_path / "bad.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadFile) as caught:
        plan_file.read(path)
    assert "bad.json" in str(caught.value) and expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_too_long_a_plan_is_one_line(tmp_path):
    path = tmp_path / "long.json"
    path.write_text(json.dumps(["Z+a", "L1"] * 61), encoding="utf-8")
    parser = Parser()
    plan.add_arguments(parser)
    with pytest.raises(UsageError, match="122 placements, expected at most 120"):
        plan.run(parser.parse_args(["--protocol", str(path)]))


def test_a_few_poses_are_judged_too(capsys, tmp_path):
    path = tmp_path / "few.json"
    for text in ('["Z+a"]', '["L1", "L2"]', '["Z+a", "Z+a", "X+b"]'):
        path.write_text(text, encoding="utf-8")
        answer = json.loads(planned(capsys, "--protocol", str(path), "--json"))
        assert of(answer, "cubic")["silent"] and answer["accel"]["even_contrasts"] == 0


@pytest.mark.parametrize("words, expected", [
    (["--protocol", "papr"], "no protocol named 'papr'"),
    (["--protocol", "drive"], "scene to simulate"),
    (["--rate", "0"], "--rate is 0"), (["--minutes", "-1"], "--minutes is -1")])
def test_bad_options(words, expected):
    parser = Parser()
    plan.add_arguments(parser)
    with pytest.raises(UsageError) as caught:
        plan.run(parser.parse_args(words))
    assert expected in str(caught.value)


def test_plan_begins_with_what_can_be_told_what_cannot_and_what_to_add(capsys):
    first = planned(capsys, "--protocol", "paper").splitlines()[:4]
    assert first[0].startswith("Can tell: accelerometer drift") and first[3] == ""
    assert first[1].startswith("Cannot tell: ") and "cubic" in first[1]
    assert first[2].startswith("Add this: random order (no more time), which tells ")


def test_a_size_that_the_capture_does_not_determine_is_no_number(tmp_path, capsys):
    late = tmp_path / "late.json"       # half a day before the first pose: nothing warms up
    late.write_text(json.dumps({"sixflip_plan": 1, "sessions": [{
        "rest_s": 42000, "poses": [r.pose for r in protocols.named("paper").sessions[0].rests]}]}))
    answer = json.loads(planned(capsys, "--protocol", str(late), "--json"))
    assert of(answer, "warm_up")["smallest"] is None
    assert all(e["smallest"] is None or e["smallest"] < 1e4 for e in answer["effects"])
    assert "too little of it happens" in planned(capsys, "--protocol", str(late))


def test_the_plan_follows_range_and_rate(capsys):
    """A count of ±16 g is 0.49 mg; twice the samples of sqrt(2) the noise tell as much."""
    answers = []
    for words in ([], ["--range", "16g,1500dps"], ["--rate", "400"]):
        assert main(["plan", "--protocol", "paper", "--sensor", "lsm6dsv", "--json", *words]) == 0
        said = capsys.readouterr()
        answers.append(json.loads(said.out))
        assert ("±2000 is taken" in said.err) == (words[:1] == ["--range"])
    usual, wide, fast = [answer["noise"] for answer in answers]
    for kind, step in (("accel", 1000 / 2049), ("gyro", 1 / 14.286)):
        assert wide[kind][0] ** 2 - usual[kind][0] ** 2 == pytest.approx(
            step ** 2 / 12 * (63 / 64 if kind == "accel" else 15 / 16), rel=0.05)
        assert fast[kind][0] == pytest.approx(2 * usual[kind][0], rel=0.05)
    of = [{(e["effect"], e["sensor"]): e["smallest"] for e in answer["effects"]}
          for answer in answers]
    seen = ("vibration", "accel")
    assert of[1][seen] > of[0][seen] and of[2][seen] == pytest.approx(of[0][seen], rel=0.05)
    assert main(["plan", "--range", "8"]) == 2
    assert "expected a full scale" in capsys.readouterr().err
