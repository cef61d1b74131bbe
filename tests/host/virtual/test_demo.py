"""The demo from end to end, on MicroPython and on CPython."""

import json

import pytest

from sixflip_host import cli
from sixflip_host.errors import SixflipError
from sixflip_host.verbs import demo
from sixflip_host.virtual import demo_truth, micropython_fetch


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_demo_on_the_virtual_board(micropython, sensor, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("SIXFLIP_MICROPYTHON", micropython)
    assert cli.main(["demo", "--keep", str(tmp_path / "kept"), "--sensor", sensor]) == 0
    out = capsys.readouterr().out
    assert "worst vector" in out and "The README's 0.20 mg is" in out
    kept = tmp_path / "kept"
    assert (kept / "raw_corrected.png").read_bytes()[:4] == b"\x89PNG"
    assert (kept / "flash.img").exists()
    lines = (kept / "events.jsonl").read_text().splitlines()
    said = [json.loads(line) for line in lines]
    assert [event["event"] for event in said].count("pose") == 12
    [solved] = [event for event in said if event["event"] == "solved"]
    # the flash takes its time in the middle of flips too
    assert solved["gyro"]["verdict"] == "good" and "left out" not in solved["gyro"]["reason"]


def test_demo_without_micropython_says_so_and_goes_on(tmp_path, capsys, monkeypatch):
    def none():
        raise SixflipError("none here")

    monkeypatch.setattr(micropython_fetch, "fetch", none)
    # a chip whose simulated twin builds on another's, whose driver is not on the board
    assert cli.main(["demo", "--sensor", "lsm6dsv"]) == 0
    out = capsys.readouterr().out
    assert "no MicroPython to be had: none here" in out
    assert "under CPython" in out


def test_demo_fails_when_verify_does(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(demo.cli, "run", lambda argv, run=cli.run: (
        1 if argv[0] == "verify" else run(argv)))
    assert cli.main(["demo", "--board", "local"]) == 1
    assert "does not confirm" in capsys.readouterr().err


def test_rests_leave_out_moves_and_edges():
    up, side = [0.0, 0.0, 9.8], [9.8, 0.0, 0.0]
    move = [[0.1 * k, 0.0, 9.8 - 0.1 * k] for k in range(98)]
    found = demo_truth.rests([up] * 300 + move + [side] * 300)
    assert found == [pytest.approx(up), pytest.approx(side)]


def test_too_few_rests_are_no_comparison():
    assert demo_truth.compare([("Z+a", (0, 0, 9.8))], [], [[0, 0, 9.8]]) is None


def test_error_is_the_length_of_the_difference():
    assert demo_truth.error_mg([0.0, 0.03, 0.04], [0, 0, 0]) == pytest.approx(50 / 9.80665)
