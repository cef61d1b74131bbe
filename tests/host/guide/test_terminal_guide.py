"""The guided screen in a real terminal: a pseudo-terminal and an emulator of one."""

import os

import pytest

from sixflip_host.board import firmware_update
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.capture import capture_file
from sixflip_host.guide.session_state import State, after
from sixflip_host.guide.terminal_guide import Guide, key_names
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.board_session import unlabelled
from tests.worlds.micropython_tier import SESSION
from tests.worlds.terminal import Terminal


@pytest.fixture(scope="module")
def flash(micropython, tmp_path_factory):
    """The flash of a board that was provisioned."""
    image = tmp_path_factory.mktemp("provisioned") / "flash.img"
    with VirtualBoard(SESSION, image, micropython=micropython) as board, \
            MpremoteLink(board.port) as link:
        firmware_update.copy(link, {"pose_samples": 200}, lambda line: None)
    return image


@pytest.fixture
def port(micropython, flash, tmp_path):
    """A virtual board, thirty times as fast as a real one."""
    image = tmp_path / "flash.img"
    image.write_bytes(flash.read_bytes())
    with VirtualBoard(SESSION, image, micropython=micropython, speed=30) as board:
        yield board.port


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    """The first minute of a session in a file."""
    path = tmp_path_factory.mktemp("capture") / "capture.csv"
    whole = unlabelled()
    keep = whole.t_us < whole.t_us[0] + 60e6
    capture_file.write(path, capture_file.Capture(
        whole.meta, whole.t_us[keep], whole.accel[keep], whole.gyro[keep], whole.temp[keep]))
    return ["--replay", str(path), "--speed", "6"]


@pytest.mark.long
def test_quit_and_come_back_without_losing_what_was_captured(port):
    """On a board, to the end; the first time without colour."""
    with Terminal("calibrate", "--port", port, NO_COLOR="1") as terminal:
        terminal.wait("waiting for the board")
        terminal.wait("2 X+ up      ✓     ✓")
        terminal.press("q")
        terminal.wait("y yes")
        terminal.press("y")
        assert terminal.ended() == 130
        assert "sixflipcalibrate--continue" in terminal.words
        assert b"\x1b[3" not in terminal.sent       # not one colour
    with Terminal("calibrate", "--port", port, "--continue") as terminal:
        terminal.wait("1 Z+ up      ✓     ✓", "2 X+ up      ✓     ✓", "calibrating: lay the box")
        assert b"\x1b[3" in terminal.sent
        terminal.wait("verdict: good", "12 of 12 taken", "saved in slot a")
        terminal.press("q")
        assert terminal.ended() == 0
        assert "saved in slot a, sequence 1" in terminal.text   # on the ordinary screen


def test_a_session_with_redo_help_and_the_result(capture):
    """Led through the faces; Z+ taken again by a key; the result stays until the person leaves."""
    with Terminal("calibrate", *capture) as terminal:
        terminal.wait("half a turn, Z+ stays up", "▶1 Z+ up      ✓     ·", "180 deg")
        terminal.wait("KEEP STILL", "%  still ", "x   ", "noise ")
        terminal.wait("Z+b taken")
        terminal.press("?")
        terminal.wait("any key closes this")
        terminal.press("x")
        terminal.press("r")
        terminal.wait("redo which face?  1 Z+")
        terminal.press("1")
        terminal.wait("Z+ again; left:")
        terminal.press("q")
        terminal.wait("quit? What is captured stays on the board")
        terminal.press("n")
        terminal.wait("verdict: refused", "stopped by the host", "1 Z+ up      ·     ·",
                      "q or Enter leave")
        terminal.press("\r")
        assert terminal.ended() == 1
        assert "verdict: refused" in terminal.text


def test_ctrl_c_leaves_the_terminal_as_it_was(capture):
    with Terminal("calibrate", *capture) as terminal:
        terminal.wait("1 Z+ up      ✓     ✓")
        terminal.press("\x03")
        assert terminal.ended() == 130
        assert "stopped;ofareplaynothingiskept" in terminal.words
        assert terminal.sent.count(b"\x1b[?1049h") == terminal.sent.count(b"\x1b[?1049l") == 1
        assert b"\x1b[?25h" in terminal.sent    # the cursor is back


@pytest.mark.parametrize("more", [{"TERM": "dumb"}, {"lines": 20}, {"columns": 70}])
def test_lines_where_a_screen_cannot_be(capture, more):
    with Terminal("calibrate", *capture, **more) as terminal:
        terminal.wait("typed lines: redo FACE, undo, quit")
        terminal.wait("Z+a taken")
        os.write(terminal.terminal, b"quit\n")
        assert terminal.ended() == 1
        assert b"\x1b" not in terminal.sent


def test_in_ascii_where_the_terminal_has_nothing_else(capture):
    with Terminal("calibrate", *capture, PYTHONIOENCODING="ascii") as terminal:
        terminal.wait("half a turn, Z+ stays up", ">1 Z+ up      x     .", "--->", "/  Z+   /|")
        terminal.press("u")
        terminal.wait("Z+ again")
        assert terminal.sent.isascii()


class Board:
    """In place of a BoardSession: keeps what it is asked for."""

    step = None

    class link:  # noqa: N801
        port = "port"

    def __init__(self, *events):
        self.state = State()
        for event in events:
            self.state = after(self.state, event, 0.0)
        self.asked = []

    def redo(self, face):
        self.asked.append(("redo", face))

    def undo(self):
        self.asked.append("undo")


SIX_FACES = {"event": "calibrating", "missing": ["Z+a"]}
OVER = {"event": "solved", "verdict": "refused"}


@pytest.mark.parametrize("events, pressed, asked, leave", [
    ([SIX_FACES], ["r", "2"], [("redo", "X+")], False),
    ([SIX_FACES], ["r", "esc", "u"], ["undo"], False),
    ([SIX_FACES], ["r", "9", "enter"], [], False),
    ([SIX_FACES], ["q", "n", "u"], ["undo"], False),
    ([SIX_FACES], ["q", "y"], [], True),
    ([SIX_FACES], ["?", "u"], [], False),
    ([], ["r", "u", "z"], [], False),
    ([SIX_FACES, OVER], ["u", "r", "6"], [("redo", "Y-")], False),
    ([SIX_FACES, OVER], ["enter"], [], True),
    ([dict(SIX_FACES, plan=True)], ["r", "1"], [], False)])
def test_what_keys_mean(events, pressed, asked, leave):
    board = Board(*events)
    guide = Guide(board)
    for key in pressed:
        guide.press(key)
    assert (board.asked, guide.leave) == (asked, leave)
    assert len(guide.lines()) == 24


@pytest.mark.parametrize("data, names", [
    (b"q", ["q"]), (b"\r", ["enter"]), (b"\x1b", ["esc"]), (b"\x1b[A", []), (b"r1", ["r", "1"]),
    (b"\x00\xff", [])])
def test_names_of_keys(data, names):
    assert key_names(data) == names
