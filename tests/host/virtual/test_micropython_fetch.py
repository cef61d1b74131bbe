"""Finding a MicroPython: the right executable, the machine's own mirror, clear words."""

import os
import stat

import pytest

from sixflip_host.errors import NoBoard, SixflipError
from sixflip_host.virtual import debian_packages, micropython_fetch


def executable(path, text):
    path.write_text("#!/bin/sh\necho \"%s\"\n" % text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_version_of_what_is_one_and_what_is_not(tmp_path):
    good = executable(tmp_path / "a", "(name='micropython', version=(1, 22, 0, ''), _mpy=1)")
    other = executable(tmp_path / "b", "namespace(name='cpython', version=(3, 11))")
    assert micropython_fetch.version(good) == (1, 22)
    assert micropython_fetch.version(other) is None
    assert micropython_fetch.version(tmp_path / "missing") is None


def test_a_named_one_that_is_too_old_is_an_error(tmp_path, monkeypatch):
    old = executable(tmp_path / "old", "(name='micropython', version=(1, 19, 1))")
    monkeypatch.setenv("SIXFLIP_MICROPYTHON", old)
    with pytest.raises(NoBoard, match="is not a MicroPython 1.21 or newer"):
        micropython_fetch.find()


def test_found_on_path_before_the_cache(tmp_path, monkeypatch):
    new = executable(tmp_path / "micropython", "(name='micropython', version=(1, 23, 0))")
    monkeypatch.delenv("SIXFLIP_MICROPYTHON", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path) + os.pathsep + os.environ["PATH"])
    assert micropython_fetch.find() == new


@pytest.mark.parametrize("name, text", [
    ("sources.list", "# deb http://old/debian x\ndeb [arch=amd64] http://here/debian/ x main\n"),
    ("sources.list.d/debian.sources", "Types: deb\nURIs: http://here/debian\nSuites: x\n")])
def test_mirror_is_the_machines_own(tmp_path, name, text):
    (tmp_path / "sources.list.d").mkdir()
    (tmp_path / name).write_text(text)
    assert debian_packages.debian_mirror("by hand", tmp_path) == "http://here/debian"


def test_no_mirror_is_one_line(tmp_path):
    with pytest.raises(SixflipError, match="SIXFLIP_MICROPYTHON"):
        debian_packages.debian_mirror("name it in SIXFLIP_MICROPYTHON", tmp_path)


def test_no_apt_is_one_line(tmp_path, monkeypatch):
    monkeypatch.delenv("SIXFLIP_MICROPYTHON", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("SIXFLIP_CACHE", str(tmp_path / "cache"))
    with pytest.raises(SixflipError, match="no apt-get and dpkg"):
        micropython_fetch.fetch()
