"""Progress bars: on stderr, on a terminal, for what takes longer than a second."""

import io

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
