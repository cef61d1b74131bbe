"""Where the tests find what they cannot carry: recordings and a MicroPython interpreter.

For a user a missing one is a skip with one clear line; in CI (CI=true) it is a failure.
"""

import gc
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy; the runs are side by side
os.environ["SIXFLIP_HISTORY"] = ""      # the history of whoever runs the tests is not theirs


def pytest_runtest_call():
    """The firmware collects garbage at every pose, as it must in a board's heap; what pytest,
    numpy, fixtures and the tests before hold need not be searched each time: that was nine
    tenths of the time of a session."""
    gc.collect()
    gc.freeze()


def missing(what):
    """Skip for a user, fail in CI."""
    if os.environ.get("CI") == "true":
        pytest.fail(what + " (in CI nothing may be missing)")
    pytest.skip(what)


@pytest.fixture(scope="session")
def recordings():
    """Folder of the real recordings: SIXFLIP_DATA, or ../shared/data beside the project."""
    folder = Path(os.environ.get("SIXFLIP_DATA", ROOT.parent / "shared" / "data"))
    if not (folder / "README.md").is_file():
        missing("no recordings at %s: set SIXFLIP_DATA to the folder that holds them" % folder)
    return folder
