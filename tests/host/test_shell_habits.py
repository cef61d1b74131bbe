"""What a shell and a script expect: examples that parse, completion, --quiet, --json, NO_COLOR,
files that are whole or not there."""

import contextlib
import fcntl
import io
import json
import os
import pty
import shlex
import shutil
import struct
import subprocess
import sys
import termios

import numpy as np
import pytest

from sixflip_host import atomic_write, cli, completion
from sixflip_host.capture import capture_file
from sixflip_host.cli import VERBS, main
from sixflip_host.history import logbook, store
from tests.worlds.board_session import leave_files, unlabelled

COMMAND = [sys.executable, "-m", "sixflip_host"]
OLD = b"# sixflip-capture 1\n"       # of the same kind, or it would not be replaced
ENVIRONMENT = dict(os.environ)


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("board")
    capture = unlabelled()
    capture.meta["device_id"] = "e6614c311b4c5a2f"
    leave_files(folder, capture, gyro=True)
    return folder


@pytest.mark.parametrize("verb", VERBS)
def test_every_example_parses(verb):
    lines = [line.strip() for line in cli.load(verb).EXAMPLE.split("\n")]
    assert lines
    for line in lines:
        words = shlex.split(line)
        words = words[:words.index(">")] if ">" in words else words
        assert words[:2] == ["sixflip", verb]
        args = cli.parser_for(verb).parse_args(words[2:])
        assert args.quiet is args.verbose is args.debug is False


# -- completion


@pytest.fixture(scope="module")
def bash_script(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "sixflip"
    path.write_text(subprocess.run([*COMMAND, "completion", "bash"], env=ENVIRONMENT, check=True,
                                   capture_output=True, text=True).stdout)
    return path


def offered(script, folder, line):
    """What bash offers at the end of a line."""
    words = line.split(" ")
    code = """source %s
COMP_WORDS=(%s); COMP_CWORD=%d; COMP_LINE=%s; COMP_POINT=${#COMP_LINE}; COMPREPLY=()
_shtab_sixflip; printf '%%s\\n' "${COMPREPLY[@]}" """ % (
        script, " ".join(shlex.quote(word) for word in words), len(words) - 1, shlex.quote(line))
    done = subprocess.run(["bash", "--norc", "-c", code], capture_output=True, text=True,
                          cwd=folder, timeout=20)
    return done.stdout.split()


def test_bash_offers_verbs_options_choices_and_files(bash_script, tmp_path):
    (tmp_path / "walk.csv").write_text("")
    assert set(VERBS) <= set(offered(bash_script, tmp_path, "sixflip "))
    assert offered(bash_script, tmp_path, "sixflip ver") == ["verify"]
    assert {"--json", "--quiet", "--plot"} <= set(
        offered(bash_script, tmp_path, "sixflip history --"))
    assert offered(bash_script, tmp_path, "sixflip completion z") == ["zsh"]
    assert "mcap" in offered(bash_script, tmp_path, "sixflip export x --format mc")
    assert offered(bash_script, tmp_path, "sixflip solve wa") == ["walk.csv"]
    assert offered(bash_script, tmp_path, "sixflip report x -o wa") == ["walk.csv"]


SHELLS = [(shell, check) for shell, check in (("zsh", ["zsh", "-n"]), ("bash", ["bash", "-n"]),
                                              ("fish", ["fish", "--no-execute"]))
          if shutil.which(shell)]


@pytest.mark.parametrize("shell,check", SHELLS)
def test_the_script_is_one_of_that_shell(shell, check, tmp_path, capsys):
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(verb in script for verb in VERBS) and "doctor" in script
    (tmp_path / "script").write_text(script)
    done = subprocess.run([*check, str(tmp_path / "script")], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_all_three_shells_are_served(capsys):
    for shell in completion.SHELLS:
        assert main(["completion", shell]) == 0
        assert "virtual-board" in capsys.readouterr().out
    assert main(["completion", "cmd.exe"]) == 2


# -- quiet, verbose, json


def test_quiet_leaves_the_exit_code_and_json(pulled, capsys):
    assert main(["verify", str(pulled), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert main(["--quiet", "solve", str(pulled / "capture.bin"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["accel"]["verdict"] == "good"
    assert main(["--quiet", "solve", "no such file"]) == 4
    out, error = capsys.readouterr()
    assert out == "" and "no such file" in error
    assert main(["completion", "fish", "--quiet"]) == 0
    assert capsys.readouterr().out


def test_verbose_says_what_is_done_and_not_on_stdout(pulled, capsys):
    assert main(["verify", str(pulled), "--json"]) == 0
    plain = capsys.readouterr()
    assert main(["verify", str(pulled), "--json", "--verbose"]) == 0
    told = capsys.readouterr()
    assert told.out == plain.out and plain.err == ""
    assert "reading %s" % (pulled / "record_a.bin") in told.err and "exit code 0" in told.err
    assert main(["verify", str(pulled), "--json"]) == 0     # and only where it was asked for
    assert capsys.readouterr().err == ""


def test_verbose_cannot_steer_the_terminal(capsys):
    assert main(["--verbose", "solve", "\x1b[2J"]) == 4
    assert "\x1b" not in capsys.readouterr().err


NO_JSON = {
    "calibrate": "guides a person; history --json and show --json say what came of it",
    "ui": "a page for a person", "demo": "a show for a person",
    "stream": "its lines are JSON as they are", "completion": "is read by a shell",
    "export": "writes the file asked for and prints nothing",
    "apply": "writes the file asked for and prints nothing",
    "report": "prints the name it was given", "simulate": "writes the files asked for",
    "restore": "one line and an exit code",
}


@pytest.mark.parametrize("verb", VERBS)
def test_json_wherever_a_script_might_read(verb):
    options = [word for action in cli.parser_for(verb)._actions for word in action.option_strings]
    assert ("--json" in options) != (verb in NO_JSON)


def test_json_of_an_import(pulled, tmp_path, capsys):
    capture = capture_file.read(pulled / "capture.bin")
    lines = ["ax,ay,az,gx,gy,gz"] + [",".join(map(str, row)) for row in np.hstack(
        [capture.accel, capture.gyro]).tolist()]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    assert main(["import", str(tmp_path / "log.csv"), "-o", str(tmp_path / "c.csv"), "--rate",
                 "100", "--accel-lsb", "16384", "--gyro-lsb", "65.5", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["samples"] == len(capture) and len(answer["poses"]) == 12


def test_json_of_the_virtual_board(micropython, tmp_path):
    environment = dict(ENVIRONMENT, SIXFLIP_MICROPYTHON=str(micropython))
    board = subprocess.Popen(
        [*COMMAND, "virtual-board", "--json", "--flash", str(tmp_path / "flash.img")],
        env=environment, stdout=subprocess.PIPE, text=True)
    try:
        there = json.loads(board.stdout.readline())
        assert os.path.exists(there["port"]) and there["flash"] == str(tmp_path / "flash.img")
        assert len(there["board"]) == 16
    finally:
        board.terminate()
        board.wait()
        board.stdout.close()


# -- colour


def on_a_terminal(words, columns=100, **variables):
    """What a command writes on a terminal."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = subprocess.Popen([*COMMAND, *words], stdin=slave, stdout=slave, stderr=slave,
                               env=dict(ENVIRONMENT, TERM="xterm-256color", **variables))
    os.close(slave)
    out = b""
    with contextlib.suppress(OSError):      # the end of a terminal
        while piece := os.read(master, 65536):
            out += piece
    os.close(master)
    assert process.wait() == 0
    return out.decode("utf-8")


def test_no_color(pulled):
    words = ["show", str(pulled / "record_a.bin")]
    coloured = on_a_terminal(words)
    assert "\x1b[1;32m" in coloured or "\x1b[32" in coloured
    plain = on_a_terminal(words, NO_COLOR="1")
    codes = {code for part in plain.split("\x1b[")[1:] for code in part.split("m")[0].split(";")}
    assert not codes & {str(n) for n in (*range(30, 49), *range(90, 108))}
    assert "good" in plain


def test_the_history_fits_80_columns(pulled, tmp_path, monkeypatch):
    file = str(tmp_path / "history.sqlite")
    monkeypatch.setenv("SIXFLIP_HISTORY", file)
    for number in range(3):
        logbook.pulled(pulled, "e6614c311b4c5a2f")
        store.add(file, [store.Happened("e6614c311b4c5a2f", "calibration", "calibrate",
                                        1.8e9 + number * 1e5, "doubtful", temp_c=-12.5 * number,
                                        answer={"scale": [1.0] * 3, "v": [-1.23456] * 3})])
    for words in (["history"], ["history", "e66"]):
        shown = on_a_terminal(words, 80, SIXFLIP_HISTORY=file)
        assert "e6614c311b4c5a2f" in shown and "…" not in shown


# -- Ctrl-C leaves files whole


WRITERS = {
    "export": ["export", "BOARD/capture.bin", "-o", "OUT/x.csv"],
    "parquet": ["export", "BOARD/capture.bin", "-o", "OUT/x.parquet"],
    "header": ["export", "BOARD/record_a.bin", "-o", "OUT/x.h"],
    "apply": ["apply", "BOARD/record_a.bin", "BOARD/capture.bin", "-o", "OUT/x.npz"],
    "plan": ["plan", "--protocol", "paper", "--plot", "OUT/x.png", "--save", "OUT/y.json"],
}


def press(monkeypatch, moment):
    """Ctrl-C at a moment of a write: created, half, before or after the rename."""
    class Half(io.FileIO):
        def write(self, data):
            super().write(data[:len(data) // 2])
            raise KeyboardInterrupt

    def opened(path, mode):
        if mode != "xb":
            return io.FileIO(path, mode.replace("b", ""))
        file = Half(path, "x")
        if moment == "half":
            return file
        file.close()
        raise KeyboardInterrupt

    def replace(source, target):
        if moment == "after":
            os.rename(source, target)
        raise KeyboardInterrupt
    if moment in ("created", "half"):
        monkeypatch.setattr(atomic_write, "open", opened, raising=False)
    else:
        monkeypatch.setattr(atomic_write.os, "replace", replace)


@pytest.mark.parametrize("moment", ["created", "half", "before", "after"])
def test_ctrl_c_while_writing_leaves_a_whole_file(pulled, tmp_path, monkeypatch, capsys, moment):
    words = [word.replace("BOARD", str(pulled)).replace("OUT", str(tmp_path))
             for word in WRITERS["export"]]
    written = tmp_path / "x.csv"
    assert main(words) == 0
    whole = written.read_bytes()
    written.write_bytes(OLD)
    with monkeypatch.context() as patch:
        press(patch, moment)
        assert main(words) == cli.INTERRUPTED
    assert capsys.readouterr().err == "sixflip: stopped\n"
    assert written.read_bytes() == (whole if moment == "after" else OLD)
    assert os.listdir(tmp_path) == ["x.csv"]


def test_what_is_written_has_the_rights_of_any_new_file(tmp_path):
    before = os.umask(0o027)
    try:
        atomic_write.write_bytes(tmp_path / "a", b"x")
        assert (tmp_path / "a").stat().st_mode & 0o777 == 0o640
    finally:
        os.umask(before)


@pytest.mark.parametrize("name", WRITERS)
def test_every_writer_goes_through_the_one_that_is_whole_or_not(pulled, tmp_path, monkeypatch,
                                                                capsys, name):
    """Ctrl-C just before the rename: whatever was written, nothing of it is there."""
    words = [word.replace("BOARD", str(pulled)).replace("OUT", str(tmp_path))
             for word in WRITERS[name]]

    def pressed(*args):
        raise KeyboardInterrupt
    monkeypatch.setattr(atomic_write.os, "replace", pressed)
    assert main(words) == cli.INTERRUPTED
    assert os.listdir(tmp_path) == []
