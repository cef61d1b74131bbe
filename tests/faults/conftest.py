"""Where the tests of faults find what the other tests have: a simulated board, a MicroPython."""

import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "device"), str(TESTS / "host")]

from micropython_tier import micropython  # noqa: E402

__all__ = ["micropython"]


@pytest.fixture(autouse=True)
def a_folder_of_its_own(tmp_path, monkeypatch):
    """What a verb writes to where it is called goes nowhere into the checkout."""
    monkeypatch.chdir(tmp_path)
