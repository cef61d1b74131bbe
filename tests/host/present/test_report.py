"""The report: one file that fetches and runs nothing, with what the calibration was."""

import base64
import io
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from sixflip.poses.faces import pose_name
from sixflip_host.calibrate import solution
from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.cli import main
from sixflip_host.history import logbook, store
from sixflip_host.present import calibration_pictures
from sixflip_host.present.page import Page
from sixflip_host.simulation import scenario, simulated_session
from tests.worlds.board_session import leave_files, unlabelled

BOARD = "e6614c311b4c5a2f"


class Seen(HTMLParser):
    """Everything in a page: tags with their attributes, and the text."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.words, self.pictures = [], [], {}
        self.feed(path.read_text(encoding="utf-8"))
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.tags.append(tag)
        assert not any(name.startswith("on") or name in ("href", "action") for name in attrs)
        if tag == "img":
            head, data = attrs["src"].split(",", 1)
            assert head == "data:image/png;base64"
            self.pictures[attrs["alt"]] = Image.open(io.BytesIO(base64.b64decode(data)))

    def handle_data(self, data):
        self.words.append(data)


def report(tmp_path, *words):
    output = tmp_path / "report.html"
    assert main(["report", *map(str, words), "-o", str(output)]) == 0
    seen = Seen(output)
    assert not {"script", "link", "iframe", "object", "form", "svg"} & set(seen.tags)
    assert "http" not in output.read_text(encoding="utf-8").replace("http-equiv", "")
    for picture in seen.pictures.values():
        assert picture.width > 500 and len(picture.convert("RGB").getcolors(1 << 20)) > 20
    return seen


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("board")
    capture = unlabelled()
    capture.meta["device_id"] = BOARD
    return folder, leave_files(folder, capture, gyro=True)


def test_calibration_verification_and_history(pulled, tmp_path, monkeypatch):
    monkeypatch.setenv(store.VARIABLE, str(tmp_path / "history.sqlite"))
    folder, record = pulled
    logbook.pulled(folder, BOARD)
    store.add(store.path(), [store.Happened(BOARD, "calibration", "calibrate", 1.7e9, "good",
                                            answer={"scale": [1.0] * 3, "v": [0.1] * 3})])
    seen = report(tmp_path, folder / "record_a.bin", folder / "capture.bin")
    assert "Calibration of board " + BOARD in seen.text
    assert "kept on the board: good : table tilt 2." in seen.text
    assert re.search(r"all \d{3} comparisons agree", seen.text)
    assert "%+.2f ± " % (-1e3 * np.linalg.solve(
        np.array(record.accel["P"])[:3, :3].T, record.accel["P"][3][:3])[0] / 9.80665) in seen.text
    assert all(pose_name(code) in seen.text for code in range(1, 13))
    assert set(seen.pictures) == {
        "Error of every vector, raw and corrected", "The two captures of every face",
        "What is left over", "As every face saw it", "The session",
        "Its parameters since the first calibration"}
    assert "History of this board" in seen.text and "calibrate" in seen.text


def test_the_vectors_are_those_of_the_capture(pulled):
    capture = capture_binary.decode((pulled[0] / "capture.bin").read_bytes())
    found = solution.solve(capture)
    names, raw, corrected, true = calibration_pictures.vectors(found, pulled[1].accel["P"])
    rest = capture.pose == 5
    assert names[4] == "X+a" and raw[4] == pytest.approx(
        capture.accel[rest].mean(axis=0) / 16384, abs=1e-12)
    assert np.linalg.norm(true, axis=1) == pytest.approx(1.0, abs=1e-9)
    off = np.linalg.norm(corrected - true, axis=1)
    assert off.max() < 1e-3 < 0.05 < np.linalg.norm(raw - true, axis=1).max()


def test_a_session_that_is_refused(tmp_path):
    capture = unlabelled()
    few = capture_file.Capture(capture.meta, *(block[:3000] for block in (
        capture.t_us, capture.accel, capture.gyro, capture.temp)))
    capture_file.write(tmp_path / "few.csv", few)
    seen = report(tmp_path, tmp_path / "few.csv")
    assert "solved here from the capture: refused" in seen.text
    assert list(seen.pictures) == ["The session"] and "Verification" not in seen.text


def test_sums_only(tmp_path):
    capture = unlabelled()
    leave_files(tmp_path, capture, sums_only=True)
    seen = report(tmp_path, tmp_path)
    assert "the board kept only the sums" in seen.text and "The session" not in seen.pictures


NASTY = "</td><script>alert(1)</script><img src=x onerror=alert(2)>\u202e\x1b[2J"


def test_what_files_say_is_only_text(pulled, tmp_path, monkeypatch):
    monkeypatch.setenv(store.VARIABLE, str(tmp_path / "history.sqlite"))
    whole = capture_file.read(pulled[0] / "capture.bin")
    capture = capture_file.Capture(whole.meta, *(block[:3000] for block in (
        whole.t_us, whole.accel, whole.gyro, whole.temp)))
    capture.meta.pop("board_capture")
    capture.meta.update(device_id=NASTY, firmware=NASTY, who_am_i=[NASTY], board=["x", NASTY],
                        held_by_hand=["Z+a", NASTY])
    capture_file.write(tmp_path / "nasty.csv", capture)
    store.add(store.path(), [store.Happened(NASTY, "check", "check", 1.0, NASTY, NASTY)])
    seen = report(tmp_path, tmp_path / "nasty.csv")
    assert "\u202e" not in seen.text and "\x1b" not in seen.text
    assert "<script>alert(1)</script>" in seen.text     # to be read, not to be run
    assert "History of this board" in seen.text


def test_a_browser_is_told_to_run_and_fetch_nothing():
    page = Page("title").html()
    assert "default-src 'none'; img-src data:; style-src 'unsafe-inline'" in page


def test_a_rest_and_its_gap(tmp_path):
    rng = np.random.default_rng(1)
    counts = np.rint(rng.normal(0, 40, (2000, 3)) + [0, 0, 16384]).astype(np.int16)
    counts[:, 0] += np.rint(100 * np.sin(2 * np.pi * 17.0 * np.arange(2000) / 100)).astype(int)
    rest = capture_file.Capture({"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384,
                                 "accel_range_g": 2}, 10000 * np.arange(2000), counts)
    capture_file.write(tmp_path / "rest.csv", rest)
    seen = report(tmp_path, tmp_path / "rest.csv", "--gap")
    assert "The gap to a nominal simulator" in seen.text and "vibration" in seen.text
    assert "Spectrum and Allan deviation" in seen.pictures


def test_the_gap_of_poses_is_measured_again_with_what_was_found(tmp_path):
    """The page once had a diagnosis of its own, without the loop that `diagnose` closes."""
    plan = scenario.from_dict({"sensor": "adxl345", "scene": "thermal", "seed": 35, "effects": [
        {"effect": "thermal_bias", "sensor": "accel", "z": -8.0}]})
    capture_file.write(tmp_path / "poses.csv", simulated_session.session(plan, 0))
    seen = report(tmp_path, tmp_path / "poses.csv", "--gap")
    assert "Simulated again with" in seen.text


@pytest.mark.parametrize("words,code,said", [
    (["no such"], 4, "cannot be read"), (["FOLDER", "-o", "x.pdf"], 2, "expected the name of an"),
    (["FOLDER/capture.bin"] * 2, 2, "2 captures and 0 records: expected DIR"),
    (["FOLDER/record_a.bin"], 2, "0 captures and 1 records"),
    (["FOLDER", "FOLDER/capture.bin"], 4, "is a folder, expected it alone")])
def test_wrong_words(pulled, tmp_path, monkeypatch, capsys, words, code, said):
    monkeypatch.chdir(tmp_path)
    assert main(["report", *(one.replace("FOLDER", str(pulled[0])) for one in words)]) == code
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not list(tmp_path.iterdir())
