"""Calibrate, restore, pull: what the person sees and what the exit code says."""

import io
import json

import pytest

from sixflip_host import cli
from sixflip_host.board import console, event_words, pulled_files
from sixflip_host.board.board_events import parse
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.capture import capture_file
from sixflip_host.errors import NoBoard
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.micropython_tier import SESSION


@pytest.fixture
def provisioned(micropython, tmp_path, capsys):
    """A board whose operator does the twelve poses after every power-up."""
    with VirtualBoard(SESSION, tmp_path / "flash.img", micropython=micropython) as board:
        assert cli.main(["provision", "--port", board.port]) == 0
        capsys.readouterr()
        yield board


def test_calibrate_pull_restore(provisioned, tmp_path, capsys):
    port = ["--port", provisioned.port]
    assert cli.main(["calibrate", *port]) == 0
    out = capsys.readouterr().out
    assert "Z+a taken; next: turn the box half a turn" in out
    assert "verdict: good" in out
    assert cli.main(["restore", *port]) == 1
    assert "no record before this one" in capsys.readouterr().err
    assert cli.main(["calibrate", *port]) == 0
    assert "not written, no better than slot a, sequence 1" in capsys.readouterr().out
    with MpremoteLink(provisioned.port) as link:      # cut off before the first sample
        data = link.get("unsaved.bin")
        link.put("refused.bin", data[:40 + int.from_bytes(data[6:8], "little")])
    assert cli.main(["pull", *port, "-o", str(tmp_path)]) == 0
    assert "refused.bin is empty" in (out := capsys.readouterr().out) and "next: sixflip" in out
    folder = tmp_path / provisioned.unique_id
    assert capture_file.read(folder / "unsaved.csv").complete
    capture = capture_file.read(folder / "capture.csv")
    assert len(capture.t_us) > 5000
    assert len(set(capture.pose.tolist())) == 13  # twelve poses and moving
    assert (folder / "record_a.bin").read_bytes()[:4] == b"6FLP"


def test_missing_pose_is_refused_with_exit_1(provisioned, capsys):
    with MpremoteLink(provisioned.port) as link:
        settings = json.loads(link.get("sixflip.json"))
        settings["timeout_s"] = 20
        link.put("sixflip.json", json.dumps(settings).encode())
    provisioned.power_cycle(dict(SESSION, mishaps=[{"kind": "missing", "pose": "Y-b"}]))
    assert cli.main(["calibrate", "--port", provisioned.port]) == 1
    assert "Y-" in capsys.readouterr().out


def test_board_without_the_firmware(board, tmp_path, capsys):
    assert cli.main(["calibrate", "--port", board.port]) == 3
    assert "sixflip provision" in capsys.readouterr().err
    assert cli.main(["pull", "--port", board.port, "-o", str(tmp_path)]) == 3
    assert cli.main(["calibrate", "--port", board.port, "--redo", "Z+"]) == 3
    assert "sixflip provision" in capsys.readouterr().err


def test_folder_name_of_a_malicious_id():
    assert pulled_files.folder_name("../../etc") == "etc"
    assert pulled_files.folder_name("..") == "board"


def test_pull_from_a_board_that_lists_strange_names(link, tmp_path):
    link.put("readme", b"x")
    with pytest.raises(NoBoard, match="nothing of sixflip"):
        pulled_files.fetch(link, tmp_path)
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]


@pytest.mark.parametrize("line", [
    "", "rubbish", '{"event": 3}', '[1]', '{"event": "x"', "Traceback: {", '{"a": 1}'])
def test_lines_that_are_no_events(line):
    assert parse(line) is None


def test_event_behind_a_line_cut_off_by_a_reset():
    assert parse('{"event": "sam{"event": "hello"}') == {"event": "hello"}


def test_words_show_reason_number_and_limit():
    event = {"event": "refused", "pose": "X+", "reason": "crooked", "value": 8.04, "limit": 5,
             "unit": "deg"}
    assert event_words.words(event) == ("X+ not taken: the box does not lie flat on this face "
                                    "(8.04 deg, limit 5 deg)")


def test_next_step_asks_for_the_flip_first():
    assert "half a turn" in event_words.next_step(["Z+b", "X+a", "X+b"])
    assert event_words.next_step(["X+a", "X+b", "Y-b", "Y-a"]) == (
        "next: X+ up; left: X+ and its flip, Y- and its flip")
    assert event_words.next_step([]) == "all six faces done"


def test_the_round_of_faces_turns_a_quarter_about_every_axis():
    """Gravity before and after such moves shows the sign of a gyro axis."""
    axis = ["XYZ".index(face[0]) for face in event_words.ROUND]
    about = [3 - a - b for a, b in zip(axis, axis[1:]) if a != b]
    assert len(about) == 5 and set(about) == {0, 1, 2}


def test_console_makes_terminal_codes_visible():
    out = io.StringIO()
    console.Console(out).show({"event": "error", "what": "\x1b[2J", "expected": "peace"})
    assert "\x1b" not in out.getvalue()


def test_ctrl_c_leaves_no_half_line():
    """Wherever Ctrl-C comes between two writes, what is said of it begins a line of its own."""
    class Screen(io.StringIO):
        left = 0

        def isatty(self):
            return True

        def write(self, text):
            if self.left == 0:
                raise KeyboardInterrupt
            self.left -= 1
            return super().write(text)

    for writes in range(12):
        screen = Screen()
        screen.left = writes
        shown = console.Console(screen)
        with pytest.raises(KeyboardInterrupt):
            while True:
                shown.say("Z+b taken")
                for typed in ("redo Z+ and much else", "", "r"):
                    shown.echo(typed)
        screen.left = -1
        shown.clear()
        last = ""  # as a terminal shows it: a line begun again covers what was there
        for text in screen.getvalue().rpartition("\n")[2].split("\r"):
            last = text + last[len(text):]
        assert not last.strip() and not (last and screen.getvalue()[-1] != "\r"), (writes, last)
