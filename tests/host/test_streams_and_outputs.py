"""The command line where its streams, its locale or its outputs are not what they should be."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sixflip_host.capture import capture_file
from sixflip_host.cli import main
from tests.worlds import hostile_sessions

TOOL = [sys.executable, "-m", "sixflip_host"]


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    path = tmp_path_factory.mktemp("session") / "capture.csv"
    capture_file.write(path, hostile_sessions.Session(1).capture())
    return str(path)


def shell(command, **more):
    return subprocess.run(["bash", "-c", command, "bash", *TOOL], capture_output=True, text=True,
                          errors="replace", timeout=120, **more)


@pytest.mark.parametrize("words", ("show %s", "solve %s", "solve %s --json", "--help"))
@pytest.mark.parametrize("into, code, said", ((">&-", 0, ""), (">/dev/full", 1, "No space left")))
def test_stdout_closed_or_full(session, words, into, code, said):
    words = words % session if "%" in words else words
    done = shell('"$@" %s %s' % (words, into))
    assert done.returncode == code
    assert said in done.stderr
    assert done.stderr.count("\n") == (code != 0)


@pytest.mark.parametrize("words", ("show %s", "solve %s", "--help"))
def test_an_ascii_terminal_gets_ascii(session, words):
    words = words % session if "%" in words else words
    done = shell('"$@" ' + words, env=dict(os.environ, LC_ALL="C", PYTHONUTF8="0",
                                           PYTHONCOERCECLOCALE="0"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.isascii()


def test_a_pipe_closed_early_is_not_a_failed_check(session):
    done = shell('"$@" show %s | true; echo ${PIPESTATUS[0]}' % session)
    assert done.stdout.strip() in ("141", "0")
    assert done.stderr == ""


@pytest.mark.parametrize("seconds", (0, 0.05, 0.1, 0.2, 0.4))
def test_ctrl_c_of_a_real_process_is_one_line(session, seconds, tmp_path):
    with open(tmp_path / "stderr", "w+") as said:
        process = subprocess.Popen([*TOOL, "refine", session, "--verbose"], stderr=said,
                                   stdout=subprocess.DEVNULL)
        while not (tmp_path / "stderr").stat().st_size:     # Python itself has started
            time.sleep(0.005)
        time.sleep(seconds)
        process.send_signal(signal.SIGINT)
        process.wait(timeout=60)
        said.seek(0)
        lines = said.read().splitlines()
    if seconds < 0.1 or " exit code " not in lines[-1]:     # else it was done before
        assert lines[-1] == "sixflip: stopped"
        # The second is what Python makes of 130 after a KeyboardInterrupt in exec() of a text,
        # which dataclasses and named tuples are made with; $? is 130 with either.
        assert process.returncode in (130, -signal.SIGINT)
    assert not any("Traceback" in line for line in lines)


def test_a_pipe_is_written_into_not_replaced(session, tmp_path):
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    with open(tmp_path / "read", "wb") as read:
        reader = subprocess.Popen(["cat", str(pipe)], stdout=read)
    assert main(["export", session, "-o", str(pipe)]) == 0
    assert reader.wait(timeout=60) == 0
    assert (tmp_path / "read").read_bytes() == Path(session).read_bytes()
    assert pipe.is_fifo()


def test_a_link_stays_a_link(session, tmp_path):
    there = tmp_path / "there.csv"
    there.write_bytes(b"# sixflip-capture 1\n")
    link = tmp_path / "link.csv"
    link.symlink_to(there)
    assert main(["export", session, "-o", str(link)]) == 0
    assert link.is_symlink()
    assert there.read_bytes() == Path(session).read_bytes()


def test_a_full_disk_is_one_line(session, capsys):
    assert main(["export", session, "-o", "/dev/full", "--format", "csv"]) == 4
    assert capsys.readouterr().err.count("\n") == 1
    assert Path("/dev/full").is_char_device()


def test_a_long_complaint_is_cut(tmp_path, capsys):
    assert main(["solve", "x" * 5000]) == 4
    assert len(capsys.readouterr().err) < 1200
