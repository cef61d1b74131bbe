"""The link's promises: hashes, names, time-outs, one terminal at a time, cables pulled out."""

import contextlib
import os
import pty
import threading
import tty

import pytest

from sixflip_host.board import raw_repl
from sixflip_host.board.board_link import MpremoteLink, NoSpace, safe_name
from sixflip_host.errors import NoBoard, SixflipError
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.micropython_tier import STILL


@pytest.fixture
def silent_port():
    master, slave = pty.openpty()
    tty.setraw(slave)
    yield os.ttyname(slave)
    os.close(master)
    os.close(slave)


def test_files_come_back_as_they_went(link):
    data = os.urandom(5000)
    link.put("a/b/c.bin", data)
    link.put("empty", b"")
    assert link.get("a/b/c.bin") == data
    assert link.get("empty") == b""
    assert {name: row[0] for name, row in link.files().items()} == {"a/b/c.bin": 5000, "empty": 0}
    link.put("a/b/c.bin", b"new")
    assert link.get("a/b/c.bin") == b"new"


def test_files_hashes_only_what_is_asked_for(link):
    link.put("x", b"1")
    link.put("y", b"2")
    files = link.files(["y"])
    assert files["x"] == (1, None)
    assert files["y"][1].startswith("d4735e3a")


def test_missing_file_is_one_line(link):
    with pytest.raises(SixflipError, match="ENOENT"):
        link.get("nothing.bin")


def test_second_terminal_is_told_so(board, link):
    with pytest.raises(NoBoard, match="another program holds the port"):
        MpremoteLink(board.port)


def test_silent_port_is_no_board(silent_port, monkeypatch):
    monkeypatch.setattr(raw_repl, "HANDSHAKE_S", 1.0)
    with MpremoteLink(silent_port) as link, pytest.raises(NoBoard, match="raw REPL within 1 s"):
        link.files()


def test_a_board_that_hears_no_ctrl_c_while_it_starts():
    master, slave = os.openpty()
    tty.setraw(slave)
    heard = []

    def board():
        while True:
            for letter in os.read(master, 64):
                heard.append(letter)
                if letter == 1 and heard.count(3) > 3:
                    os.write(master, b"raw REPL; CTRL-B to exit\r\n>")
                elif letter == 4:
                    return os.write(master, b"soft reboot\r\nraw REPL; CTRL-B to exit\r\n>")
    starting = threading.Thread(target=board)
    starting.start()
    with MpremoteLink(os.ttyname(slave)) as link:
        link.enter()
        assert link.raw and heard.count(3) > 3
    starting.join()
    os.close(master)
    os.close(slave)


def test_port_that_never_stops_talking_is_no_board(silent_port, monkeypatch):
    monkeypatch.setattr(raw_repl, "HANDSHAKE_S", 1.0)
    with MpremoteLink(silent_port) as link:
        stop = threading.Event()

        def talk():
            while not stop.is_set():
                link.transport.serial.buffer.extend(b"GPS,4711,52.5\r\n")
                stop.wait(0.001)

        talker = threading.Thread(target=talk)
        talker.start()
        try:
            with pytest.raises(NoBoard, match="does not answer"):
                link.files()
        finally:
            stop.set()
            talker.join()


@pytest.mark.parametrize("port, says", [
    ("/dev/ttyNOTHERE", "no such port"), ("/etc/passwd", "not a serial port"),
    ("socket://127.0.0.1:1", "nothing listens")])
def test_port_that_will_not_open(port, says):
    with pytest.raises(NoBoard, match=says):
        MpremoteLink(port)


def test_no_space_keeps_the_old_file(micropython, tmp_path):
    with VirtualBoard(STILL, tmp_path / "f.img", micropython=micropython,
                      flash_bytes=65536) as board, MpremoteLink(board.port) as link:
        link.put("keep", b"old")
        with pytest.raises(NoSpace, match="no space left"):
            link.put("keep", bytes(100000))
        assert link.get("keep") == b"old"
        assert list(link.files([])) == ["keep"]


def test_cable_pulled_out_in_mid_copy(board, link):
    link.files()
    threading.Timer(0.1, board.unplug).start()
    with pytest.raises(NoBoard, match="went away while copying big"):
        link.put("big", bytes(1000000))


def test_bad_cable_is_never_taken_for_data(board, link):
    """Every byte the board sends may be wrong: what get() returns is right, or it raises."""
    data = bytes(range(256)) * 8
    link.put("f", data)
    for place in range(40, 2000, 280):
        sent = [0]

        def corrupt(piece, place=place, sent=sent):
            hit = place - sent[0]
            sent[0] += len(piece)
            if 0 <= hit < len(piece) and chr(piece[hit]).isalnum():
                piece = piece[:hit] + bytes([piece[hit] ^ 1]) + piece[hit + 1:]
            return piece

        board.relay.corrupt = corrupt
        with contextlib.suppress(SixflipError):
            assert link.get("f") == data
        board.relay.corrupt = None
        link.raw = False


def test_lines_survive_a_reset_and_an_answer_comes_back(link):
    link.put("main.py", b"import sys\nprint('up')\nprint(sys.stdin.readline())\n")
    link.reset()
    lines = link.lines(5)
    assert any("up" in next(lines) for _ in range(3))
    link.send("over")
    assert any("over" in next(lines) for _ in range(3))


@pytest.mark.parametrize("name", ["../x", "/etc/x", "a/../../x", "", "a\\b", "c:x", "a\nb", "."])
def test_names_that_leave_the_folder(name):
    assert not safe_name(name)


def test_names_that_stay():
    assert safe_name("sixflip/chips/mpu6050.py")
