"""`sixflip diagnose` from the command line, on simulated captures with known causes."""
import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from sixflip.capture import blocks as capture_blocks
from sixflip.capture import writer as capture_writer
from sixflip_host import cli
from sixflip_host.capture import capture_file
from sixflip_host.diagnosis import diagnose
from sixflip_host.simulation import scenario, simulated_session

KEYS = {"format", "verdict", "causes", "where", "gap", "unseen", "next"}
CAUSE_KEYS = {"sensor", "axes", "effect", "class", "score_nats", "value", "unit", "interval_90",
              "plausible", "share", "probability", "class_probabilities"}
EFFECTS = [{"effect": "thermal_bias", "sensor": "accel", "z": -1.8},
           {"effect": "g_sensitivity", "sensor": "gyro", "xy": 0.1}]


def captures(folder, scene, effects, seed=9):
    """Paths of the simulated sessions of a scene."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": scene, "seed": seed,
                               "world": {"tilt_deg": 1.0, "placement_scatter_deg": 0.05},
                               "effects": effects})
    paths = []
    for number in range(len(plan.worlds)):
        path = folder / ("%s%d.csv" % (scene, number))
        capture_file.write(str(path), simulated_session.session(plan, number))
        paths.append(str(path))
    return paths


@pytest.fixture(scope="module")
def two_sessions(tmp_path_factory):
    return captures(tmp_path_factory.mktemp("gap"), "recommended", EFFECTS)


@pytest.fixture(scope="module")
def made():
    """{what was diagnosed: its Diagnosis} of the tests that ask for made_once."""
    return {}


@pytest.fixture
def made_once(made, monkeypatch):
    """The diagnosis of the two sessions is made once for the JSON, the words and the page: its
    result is a frozen value, and each test goes the verb's whole way with it."""
    make = diagnose.diagnose

    def once(captures, *settings):
        key = repr(([name for name, _ in captures], settings))
        if key not in made:
            made[key] = make(captures, *settings)
        return made[key]
    monkeypatch.setattr(diagnose, "diagnose", once)


def diagnosed(capsys, *words):
    assert cli.main(["diagnose", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.long
def test_two_causes_are_named_with_size_axis_and_share(
        two_sessions, made_once, capsys, tmp_path):
    junit = tmp_path / "checks.xml"
    answer = diagnosed(capsys, *two_sessions, "--junit", str(junit), "--add", "found",
                       "--scenario", str(tmp_path / "found.toml"))
    assert set(answer) >= KEYS
    assert answer["verdict"] == "explained"
    assert answer["held_out"] == "each session by the others"
    causes = {c["sensor"]: c for c in answer["causes"]}
    assert len(answer["causes"]) == 2
    assert set(causes["accel"]) == CAUSE_KEYS | {"shape"}
    # Within a session the temperature and its rate are the same thing; between the two, which
    # end at other temperatures, they are not.
    assert causes["accel"]["effect"] == "thermal_bias"
    assert causes["accel"]["axes"] == ["z"]
    low, high = causes["accel"]["interval_90"]["z"]
    assert low - 0.05 < -1.8 < high + 0.05
    assert causes["gyro"]["effect"] == "g_sensitivity"
    assert causes["gyro"]["value"]["xy"] == pytest.approx(0.1, abs=0.005)
    for gap in answer["gap"].values():
        assert gap["explained_share"] > 0.9
        assert gap["after"] < 0.5 * gap["before"]
    places = {(w["sensor"], w["axis"], w["domain"]) for w in answer["where"][:3]}
    assert places >= {("accel", "z", "temperature"), ("gyro", "x", "orientation")}
    assert ElementTree.parse(junit).getroot().get("failures") == "0"
    for loop in answer["simulated"].values():
        assert loop["after"] < 1.3 * loop["floor"] < loop["before"]
    again = scenario.read(str(tmp_path / "found.toml"))
    assert {e["effect"] for e in again.effects} == {"thermal_bias", "g_sensitivity"}
    assert len(again.worlds) == 2


@pytest.mark.long
def test_a_simulator_that_has_the_effects_differs_by_its_parameters_alone(
        two_sessions, tmp_path, capsys):
    twin = captures(tmp_path, "recommended", EFFECTS, seed=31)
    answer = diagnosed(capsys, two_sessions[0], "--sim", twin[0])
    assert answer["causes"] == []
    assert answer["simulator"]["conventions"] == []
    bias = answer["simulator"]["parameters"]["accel"]["bias"]["x"]
    assert bias["differs"] and bias["set"] == pytest.approx(bias["real"], abs=0.1)
    assert answer["verdict"] == "explained"
    assert "thermal_bias" in " ".join(answer["remarks"])


def test_the_first_line_is_the_verdict_and_ci_can_fail_on_it(
        two_sessions, made_once, tmp_path, capsys):
    report = tmp_path / "report"
    junit = tmp_path / "checks.xml"
    code = cli.main(["diagnose", *two_sessions, "--fail-on", "explained", "--report", str(report),
                     "--junit", str(junit)])
    printed = capsys.readouterr()
    assert code == 1
    assert "the verdict is explained" in printed.err
    first = printed.out.splitlines()[0]
    assert "Z accelerometer drifts with temperature" in first
    assert "feels gravity" in first
    assert ElementTree.parse(junit).getroot().get("failures") == "1"
    page = (report / "index.html").read_text()
    assert page.count("data:image/png;base64,") == len(list(report.glob("*.png"))) >= 6
    assert "src=\"http" not in page


def test_twelve_poses_name_nothing_that_they_cannot_tell(tmp_path, capsys):
    for effects in ([], [{"effect": "cubic", "sensor": "accel", "x": 5.0, "z": -5.0}]):
        paths = captures(tmp_path, "paper", effects, seed=5)
        answer = diagnosed(capsys, *paths)
        assert answer["verdict"] == "cannot tell"
        assert "rests would not show most effects" in answer["untold"]["why"]
        assert answer["causes"] == []
        assert answer["held_out"] == "same session"
        silent = {u["effect"] for u in answer["unseen"] if u["sensor"] == "accel"}
        assert {"cubic", "local_gravity", "quadratic", "asymmetry", "supply"} <= silent
        assert answer["next"]


def still(tmp_path, name, counts, rate=100.0, **meta):
    """Path of a capture of one rest, accelerometer only."""
    t_us = np.rint(np.arange(len(counts)) * 1e6 / rate).astype(np.int64)
    head = dict({"sensor": "mpu6050", "rate_hz": rate, "accel_lsb_per_g": 16384,
                 "accel_range_g": 2}, **meta)
    path = tmp_path / name
    capture_file.write(str(path), capture_file.Capture(head, t_us, counts.astype(np.int16)))
    return str(path)


def quiet(seconds=60, seed=1):
    """Counts (n, 3) of a sensor at rest that does nothing but rustle."""
    generator = np.random.default_rng(seed)
    return np.rint(generator.normal([100.0, -200.0, 16400.0], 50.0, (seconds * 100, 3)))


def test_a_quiet_rest_has_no_gap(tmp_path, capsys):
    answer = diagnosed(capsys, still(tmp_path, "quiet.csv", quiet()))
    assert (answer["verdict"], answer["causes"]) == ("no gap", [])
    assert all(gap["explained_share"] is None and gap["before"] < 1.3 * gap["floor"]
               for gap in answer["gap"].values())


def test_steps_lines_drift_and_rails_of_a_single_rest(tmp_path, capsys):
    t = np.arange(6000) / 100.0
    counts = quiet()
    walk = np.cumsum(np.random.default_rng(2).normal(0.0, 2.5, (6000, 3)), axis=0)
    cases = {"quantisation": np.rint(counts / 4) * 4,
             "vibration": counts + np.outer(np.sin(2 * np.pi * 31.0 * t), [0, 80, 0]),
             "drift": counts + walk}
    spiked = counts.copy()
    spiked[3000, 2] = 32767
    cases["saturation"] = spiked
    for effect, values in cases.items():
        answer = diagnosed(capsys, still(tmp_path, effect + ".csv", values))
        assert [c["effect"] for c in answer["causes"]] == [effect]
        assert answer["verdict"] == "explained"


def test_clock_errors_and_missing_samples_are_named_and_jitter_is_not(tmp_path, capsys):
    counts = quiet()
    path = still(tmp_path, "clock.csv", counts)
    capture = capture_file.read(path)
    times = {"sample_rate": np.rint(capture.t_us / 1.007).astype(np.int64),
             "": capture.t_us + np.random.default_rng(3).integers(-900, 900, len(counts)) + 1000}
    for effect, t_us in times.items():
        capture.t_us = t_us
        capture_file.write(path, capture)
        answer = diagnosed(capsys, path)
        assert [c["effect"] for c in answer["causes"]] == ([effect] if effect else [])
    capture = capture_file.read(still(tmp_path, "lost.csv", counts))
    keep = np.random.default_rng(4).uniform(size=len(counts)) > 0.01
    capture.t_us, capture.accel = capture.t_us[keep], capture.accel[keep]
    capture_file.write(path, capture)
    cause, = diagnosed(capsys, path)["causes"]
    assert cause["effect"] == "dropped_samples"
    assert cause["value"]["chance"] == pytest.approx(100 * (1 - keep.mean()), abs=0.15)


def board_file(path, counts, lost=0.0):
    """The file of a board whose every write to flash lasts 37 ms, as an erase does on a Pico."""
    late, data = [], bytearray()
    missing = np.random.default_rng(6).uniform(size=len(counts)) < lost

    def write(block):
        data.extend(block)
        late.append(37000)
    meta = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384}
    writer = capture_writer.BlockWriter(write, json.dumps(meta).encode(), capture_blocks.ACCEL)
    skipped = 0
    for row, gone in zip(counts.astype(int).tolist(), missing):
        if gone:
            skipped += 1
            continue
        pause, late[:] = sum(late), []
        writer.add(10000 * (1 + skipped) + pause, row)
        skipped = 0
    writer.end(True)
    path.write_bytes(data)
    return str(path), missing.mean()


def test_the_pauses_in_which_a_board_writes_are_a_remark_and_losses_beside_them_are_named(
        tmp_path, capsys):
    path, _ = board_file(tmp_path / "capture.bin", quiet())
    text = str(tmp_path / "capture.csv")
    capture_file.write(text, capture_file.read(path))
    for one in (path, text):
        answer = diagnosed(capsys, one)
        assert answer["causes"] == [] and answer["verdict"] == "no gap"
        assert any("to its flash" in remark for remark in answer["remarks"])
    path, share = board_file(tmp_path / "lost.bin", quiet(), lost=0.01)
    cause, = diagnosed(capsys, path)["causes"]
    assert cause["effect"] == "dropped_samples"
    assert cause["value"]["chance"] == pytest.approx(100 * share, rel=0.2)


@pytest.mark.parametrize("words, code, said", [
    (["--without", "gremlins"], 2, "thermal_bias"),
    (["--fail-on", "splendid"], 2, "partly explained"),
    (["--max-gap", "-1"], 2, "more than 0"),
    (["--add", "gremlins"], 2, "thermal_bias")])
def test_nonsense_is_one_line(tmp_path, capsys, words, code, said):
    assert cli.main(["diagnose", still(tmp_path, "quiet.csv", quiet(20)), *words]) == code
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_a_missing_file_is_code_4(capsys):
    assert cli.main(["diagnose", "nowhere.csv"]) == 4
    assert "nowhere.csv" in capsys.readouterr().err
