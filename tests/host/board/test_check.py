"""check: what speaks against a calibration, from a recording and from a board."""

import json
import re

import pytest

from sixflip_host import cli
from sixflip_host.capture import capture_file
from sixflip_host.verbs import check
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.board_session import leave_files, unlabelled
from tests.worlds.hand_session import Sensor
from tests.worlds.micropython_tier import SESSION, STILL
from tests.worlds.resting import rest


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """(capture of a calibration, path of its record)."""
    folder = tmp_path_factory.mktemp("board")
    session = unlabelled(1)
    leave_files(folder, session)
    return session, folder / "record_a.bin"


def run(tmp_path, capsys, calibrated, *words, **what):
    """(exit code, out, err) of a check of a rest."""
    session, record = calibrated
    path = tmp_path / "rest.csv"
    capture_file.write(path, rest(session.meta, **what))
    code = cli.main(["check", str(path), "--record", str(record), *words])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_a_sensor_as_it_was_is_still_valid(tmp_path, capsys, calibrated):
    code, out, _ = run(tmp_path, capsys, calibrated, force=(0.5, -0.5, 0.7071))
    assert code == 0
    assert "still valid" in out
    for word in ("|a|", "noise", "temperature", "gyro bias", "at the calibration"):
        assert word in out


@pytest.mark.parametrize("what, word", [
    ({"sensor": Sensor(2, 3.0)}, "mg off, 5 is the limit"),
    ({"force": (0, 0, 1.006)}, "|a| is +6"),
    ({"shake_mg": 25}, "the noise is"),
    ({"temp": 2500}, "°C, at the calibration it was"),
    ({"rate_dps": (0, 8, 0)}, "the gyro's bias moved by 8"),
])
def test_each_thing_that_speaks_against_it_is_named(tmp_path, capsys, calibrated, what, word):
    code, out, _ = run(tmp_path, capsys, calibrated, **what)
    assert code == 1
    assert "no longer valid" in out
    assert word in out


def test_only_that_thing_is_named(tmp_path, capsys, calibrated):
    code, out, _ = run(tmp_path, capsys, calibrated, "--json", temp=2500)
    found = json.loads(out)
    assert code == 1
    assert found["valid"] is False
    assert len(found["against"]) == 1
    assert abs(found["temp_c"] - (2500 / 340 + 36.53)) < 0.1
    assert abs(found["a_error_mg"]) < 2


def test_a_recording_that_is_no_rest_is_not_judged(tmp_path, capsys, calibrated):
    code, out, err = run(tmp_path, capsys, calibrated, sway_mg=60)
    assert (code, out) == (1, "")
    assert "there is no rest: it moves" in err


@pytest.mark.parametrize("words", [["rest.csv"], ["--record", "a.bin"],
                                   ["rest.csv", "--record", "a.bin", "--port", "local:x"]])
def test_wrong_command_lines(capsys, words):
    assert cli.main(["check", *words]) == 2
    assert capsys.readouterr().err.startswith("sixflip: ")


def test_gravity_of_another_place(tmp_path, capsys, calibrated):
    # Nairobi, 1700 m: gravity is 3 mg less than the standard one
    force = (0, 0, 0.9970)
    code, out, _ = run(tmp_path, capsys, calibrated, "--lat", "-1.3", "--height", "1700",
                       "--json", force=force)
    there = json.loads(out)["a_error_mg"]
    assert code == 0
    _, out, _ = run(tmp_path, capsys, calibrated, "--json", force=force)
    assert abs(json.loads(out)["a_error_mg"] + 3.0) < 0.5
    assert abs(there) < 0.5


def test_words_of_a_board_are_made_harmless():
    found = {"a_error_mg": None, "noise_mg": None, "noise_then_mg": None, "temp_c": None,
             "temp_then_c": None, "bias_dps": None, "bias_then_dps": None, "valid": False,
             "record_verdict": "doubtful", "record_reason": "\x1b[1mno flips",
             "against": ["\x1b[2Jgone"]}
    lines = check.lines(found)
    assert "\x1b" not in "".join(lines)
    assert "doubtful: \\x1b[1mno flips" in lines[0]


class SpokenBoard:
    """A board that says these events, one list after each line it is sent."""

    port = "/dev/spoken"

    def __init__(self, *answers):
        self.answers = list(answers)
        self.sent = []

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    def board_id(self):
        return "e6614c311b4c5a2f"

    def reset(self):
        self.said = self.answers.pop(0)

    def send(self, line):
        self.sent.append(json.loads(line))
        self.said = self.answers.pop(0)

    def lines(self, timeout):
        return iter([json.dumps(event) for event in self.said])


RECORD = {"event": "record", "verdict": "doubtful", "reason": "no flips", "temp_c": 20.0}
CHECK = {"event": "check", "still": True, "reason": "", "bias_dps": [1, 2, 3], "verdict": "good",
         "words": ["|a| is right"], "a_error_mg": 0.4, "noise_mg": 3.0, "temp_c": 25.0}


def ask(monkeypatch, capsys, started, answer=None):
    """(exit code, out, err) of a check of a board that says so; what was sent."""
    board = SpokenBoard([RECORD, {"event": started}], [{"event": "sample"}, answer])
    monkeypatch.setattr(check, "open_link", lambda port: board)
    code = cli.main(["check"])
    said = capsys.readouterr()
    return code, said.out, said.err, board.sent


def test_a_boards_numbers_beside_its_record(monkeypatch, capsys):
    code, out, _, sent = ask(monkeypatch, capsys, "ready", CHECK)
    assert code == 0
    assert sent == [{"cmd": "check"}]
    assert "25.0 °C, at the calibration 20.0 °C" in out
    assert "itself was doubtful: no flips" in out
    assert "still valid" in out


def test_a_board_that_no_longer_holds_is_exit_1(monkeypatch, capsys):
    words = ["|a| is +65.8 mg off, 5 is the limit: calibrate again"]
    code, out, _, _ = ask(monkeypatch, capsys, "ready", dict(CHECK, verdict="doubtful",
                                                             words=words))
    assert code == 1
    assert "no longer valid:\n  " + words[0] in out


@pytest.mark.parametrize("started, answer, word", [
    ("ready", dict(CHECK, still=False, reason="moving"), "there is no rest: moving"),
    ("ready", {"event": "error", "what": "no sensor", "expected": "one"}, "no sensor"),
    ("calibrating", None, "nothing to check"),
])
def test_a_board_that_cannot_check_says_why(monkeypatch, capsys, started, answer, word):
    code, out, err, sent = ask(monkeypatch, capsys, started, answer)
    assert (code, out) == (1, "")
    assert word in err
    assert sent == ([] if started == "calibrating" else [{"cmd": "check"}])


def test_a_board_checks_itself(micropython, tmp_path, capsys):
    with VirtualBoard(SESSION, tmp_path / "flash.img", micropython=micropython) as board:
        port = ["--port", board.port]
        assert cli.main(["provision", *port]) == 0
        assert cli.main(["calibrate", *port]) == 0
        board.power_cycle(dict(STILL, tilt_deg=2.0))
        capsys.readouterr()
        assert cli.main(["check", *port]) == 0
        out = capsys.readouterr().out
        assert "still valid" in out
        assert re.search(r"temperature +25\.\d °C, at the calibration 25\.\d °C", out)
