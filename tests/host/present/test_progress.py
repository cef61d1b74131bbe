"""Progress bars: on stderr, on a terminal, for what takes longer than a second."""

import io
import re
import time

from sixflip_host import progress


class Terminal(io.StringIO):
    """A stderr that says it is a terminal."""

    def isatty(self):
        return True


def test_silent_in_a_pipe(monkeypatch, capsys):
    monkeypatch.setattr(progress, "PATIENCE_S", -1)
    assert list(progress.steps("abc", "spelling")) == ["a", "b", "c"]
    assert capsys.readouterr().err == ""


def test_silent_when_quick(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    assert list(progress.steps("abc", "spelling")) == ["a", "b", "c"]
    assert terminal.getvalue() == ""


def test_shows_what_takes_long(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setattr(progress, "PATIENCE_S", -1)
    assert list(progress.steps("abc", "spelling")) == ["a", "b", "c"]
    assert "spelling" in terminal.getvalue()


def test_a_long_work_says_its_steps_and_leaves_nothing_behind(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setattr(progress, "PATIENCE_S", 0.0)
    with progress.during("diagnose"):
        while not progress._running.progress:       # it appears after PATIENCE_S
            time.sleep(0.01)
        progress.doing("reading")
        progress.doing("the gyro at rest")
        assert list(progress.steps("ab", "simulating")) == ["a", "b"]
    assert re.search("diagnose, 1 step done: (the gyro at rest|simulating, . of 2)",
                     terminal.getvalue())
    progress.doing("nothing is running any more")


def test_a_long_work_is_silent_in_a_pipe(monkeypatch, capsys):
    monkeypatch.setattr(progress, "PATIENCE_S", 0.0)
    with progress.during("diagnose"):
        progress.doing("reading")
        time.sleep(0.05)
    assert capsys.readouterr().err == ""
