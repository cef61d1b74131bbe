"""Where the tests of faults find what the other tests have: a simulated board, a MicroPython."""

import pytest

from tests.worlds.micropython_tier import micropython

__all__ = ["micropython"]


@pytest.fixture(autouse=True)
def a_folder_of_its_own(tmp_path, monkeypatch):
    """What a verb writes to where it is called goes nowhere into the checkout."""
    monkeypatch.chdir(tmp_path)
