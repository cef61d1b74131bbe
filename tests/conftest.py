"""Where the tests find what they cannot carry: recordings and a MicroPython interpreter.

For a user a missing one is a skip with one clear line; in CI (CI=true) every skip is a failure.
"""

import fcntl
import gc
import json
import os
import signal
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy; the runs are side by side
os.environ["SIXFLIP_HISTORY"] = ""      # the history of whoever runs the tests is not theirs
# A shell starts what it runs in the background with Ctrl-C ignored, and so would be every program
# that a test starts and then stops with it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_runtest_call():
    """The firmware collects garbage at every pose, as it must in a board's heap; what pytest,
    numpy, fixtures and the tests before hold need not be searched each time: that was nine
    tenths of the time of a session."""
    gc.collect()
    gc.freeze()


def pytest_xdist_auto_num_workers():
    """Workers of -n auto: one more than this process has cores. Part of a worker's time is
    waiting, for a board's answer, a download or a package, in which another test computes."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return (cores or 1) + 1


# CI cuts a run off that takes longer than it allows, and what it had found is lost with it.
LAST_START_S = float(os.environ.get("SIXFLIP_LONG_UNTIL", "inf"))  # of a long test, Unix time
NOT_BEGUN = []


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item):
    if time.time() > LAST_START_S and item.get_closest_marker("long"):
        NOT_BEGUN.append(item.nodeid)
        return True
    return None


def pytest_sessionfinish(session):
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["not_begun"] = NOT_BEGUN


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    NOT_BEGUN.extend(getattr(node, "workeroutput", {}).get("not_begun", ()))


def pytest_terminal_summary(terminalreporter):
    if NOT_BEGUN:
        terminalreporter.write_line("%d long tests not begun in the time that there was:" %
                                    len(NOT_BEGUN), red=True)
        terminalreporter.write_line("\n".join(sorted(NOT_BEGUN)))


# In no package registry, so of all tiers this one alone may be absent in CI.
MAY_BE_ABSENT = "no firmware image for the emulated Pico"


def fail_in_ci(report):
    """Make the report of a skip that of a failure, where CI=true; its line stays."""
    if report.skipped and os.environ.get("CI") == "true":
        reason = report.longrepr[2].removeprefix("Skipped: ")
        if not reason.startswith(MAY_BE_ABSENT):
            report.outcome, report.longrepr = "failed", reason + " (in CI nothing may be missing)"


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport():
    fail_in_ci((yield).get_result())


@pytest.hookimpl(hookwrapper=True)
def pytest_make_collect_report():
    fail_in_ci((yield).get_result())


def of_this_run(tmp_path_factory):
    """The folder that all workers of this run share."""
    folder = tmp_path_factory.getbasetemp()
    return folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder


@pytest.fixture(scope="session", autouse=True)
def cutoffs_of_this_run(tmp_path_factory):
    """What a diagnosis simulates of a protocol before it judges is simulated by today's code, and
    by one test for all others: its cache is one folder of this run, for every worker and every
    program that a test starts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SIXFLIP_THRESHOLDS", str(of_this_run(tmp_path_factory) / "cutoffs"))
        yield


@pytest.fixture(scope="session")
def once(tmp_path_factory):
    """once(name, make): what make() returns, of JSON, worked out once a run: by the first of the
    workers that asks for it, while the others wait."""
    folder = of_this_run(tmp_path_factory) / "once"
    folder.mkdir(exist_ok=True)

    def value(name, make):
        path = folder / (name + ".json")
        with open(path.with_suffix(".lock"), "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.exists():
                path.write_text(json.dumps(make()))
        return json.loads(path.read_text())
    return value


@pytest.fixture(scope="session")
def recordings():
    """Folder of the real recordings: SIXFLIP_DATA, or ../shared/data beside the project."""
    folder = Path(os.environ.get("SIXFLIP_DATA", ROOT.parent / "shared" / "data"))
    if not (folder / "README.md").is_file():
        pytest.skip("no recordings at %s: set SIXFLIP_DATA to the folder that holds them" % folder)
    return folder
