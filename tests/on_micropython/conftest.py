"""Starts the MicroPython that `make micropython` unpacks (or SIXFLIP_MICROPYTHON, or PATH)."""

import os
import subprocess
from pathlib import Path

import pytest

from sixflip_host.virtual.micropython_fetch import MISSING, find

HERE = Path(__file__).resolve().parent


@pytest.fixture(scope="session")
def micropython():
    """run(script, *arguments, heap="64k") -> the finished process, its output as text."""
    executable = find()
    if executable is None:
        pytest.skip(MISSING)

    def run(script, *arguments, heap=None, path=None):
        options = ["-X", "heapsize=" + heap] if heap else []
        environment = dict(os.environ)
        if path:
            environment["MICROPYPATH"] = str(path)
        return subprocess.run(
            [executable, *options, str(HERE / script), *arguments],
            capture_output=True, text=True, timeout=300, env=environment,
            stdin=subprocess.DEVNULL)

    return run
