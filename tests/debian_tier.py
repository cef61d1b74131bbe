"""Tiers that need Debian packages: installed when root, else a skip with one line, never in CI."""

import contextlib
import fcntl
import os
import shutil
import subprocess
import sys

import pytest

from sixflip_host.virtual.micropython_fetch import cache_dir


class Unavailable(Exception):
    """The tier cannot be had on this machine; the text is the line for the user."""


@contextlib.contextmanager
def alone(name):
    """One process at a time: several workers of a test run want the same thing made."""
    folder = cache_dir()
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / (name + ".lock"), "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def install(packages, missing):
    """Install Debian packages when missing() names anything that is not there; Unavailable."""
    if not missing():
        return
    with alone("apt"):
        absent = missing()
        if not absent:
            return
        line = "no %s: apt-get install %s" % (", ".join(absent), " ".join(packages))
        if not shutil.which("apt-get") or os.geteuid() != 0:
            raise Unavailable(line)
        answer = None
        for words in (["update"], ["install", "-y", "--no-install-recommends", *packages]):
            answer = subprocess.run(
                ["apt-get", "-q", "-o", "DPkg::Lock::Timeout=300", *words],
                stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=1200,
                env=dict(os.environ, DEBIAN_FRONTEND="noninteractive"))
        if answer.returncode or missing():
            raise Unavailable(line + " (tried, failed: %s)" % answer.stderr.strip()[-200:])


def without(tier, error):
    """Skip the test, which conftest.py makes a failure in CI."""
    pytest.skip("no %s: %s" % (tier, error))


def exit_code_without(tier, error):
    """For a benchmark: one line, and no failure but in CI."""
    print("sixflip: no %s: %s" % (tier, error), file=sys.stderr)
    return 1 if os.environ.get("CI") == "true" else 0
