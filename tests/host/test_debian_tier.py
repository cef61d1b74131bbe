"""Tiers that need Debian packages: one line and a skip for a user, a failure in CI; and long tests
for which CI has no time."""

import os
import subprocess
import sys

import pytest

from tests import debian_tier


def test_nothing_is_installed_when_nothing_is_missing(monkeypatch):
    monkeypatch.setattr(debian_tier.subprocess, "run", None)  # would be a TypeError
    debian_tier.install(("a-package",), lambda: [])


def test_a_user_is_told_what_to_install(monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(debian_tier.Unavailable) as told:
        debian_tier.install(("one", "two"), lambda: ["the-tool"])
    assert str(told.value) == "no the-tool: apt-get install one two"


@pytest.mark.parametrize("ci, reason, outcome", [
    ("", "no such board: no such tool", "skipped"),
    ("true", "no such board: no such tool", "failed"),
    ("true", "no firmware image for the emulated Pico: set", "skipped")])
def test_a_skip_for_a_user_is_a_failure_in_ci(ci, reason, outcome, monkeypatch, request):
    monkeypatch.setenv("CI", ci)
    with pytest.raises(pytest.skip.Exception, match=reason) as skipped:
        debian_tier.without(*reason.removeprefix("no ").split(": "))
    said = ("file.py", 1, "Skipped: %s" % skipped.value)
    report = pytest.CollectReport("a test", "skipped", said, [])
    (tests,) = [one for one in request.config.pluginmanager.get_plugins()
                if hasattr(one, "MAY_BE_ABSENT")]
    tests.fail_in_ci(report)
    assert report.outcome == outcome
    assert reason in str(report.longrepr)


def test_a_benchmark_says_so_in_one_line(monkeypatch, capsys):
    monkeypatch.delenv("CI", raising=False)
    assert debian_tier.exit_code_without("such board", "no such tool") == 0
    assert capsys.readouterr().err == "sixflip: no such board: no such tool\n"
    monkeypatch.setenv("CI", "true")
    assert debian_tier.exit_code_without("such board", "no such tool") == 1


@pytest.mark.parametrize("workers", ["0", "2"])
def test_what_could_not_begin_in_time_is_listed_by_name(workers):
    """The long test that an earlier run of this one would be is not begun, the short one is."""
    here = "tests/host/test_debian_tier.py::"
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-n", workers, "-p", "no:cacheprovider",
         here + "test_a_long_one", here + "test_a_benchmark_says_so_in_one_line"],
        env={**os.environ, "SIXFLIP_LONG_UNTIL": "0"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 long tests not begun in the time that there was:\n%stest_a_long_one\n" % here in (
        done.stdout)
    assert "1 passed" in done.stdout


@pytest.mark.long
def test_a_long_one():
    assert float(os.environ.get("SIXFLIP_LONG_UNTIL", "inf")) > 0.0
