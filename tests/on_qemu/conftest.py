"""One emulated board for all tests of this folder."""

import os

import pytest

from .board import QemuBoard
from .firmware import Unavailable, build


@pytest.fixture(scope="session")
def board():
    try:
        elf = build()
    except Unavailable as error:
        if os.environ.get("CI") == "true":
            pytest.fail("the emulated Cortex-M3 is missing in CI: %s" % error)
        pytest.skip("no emulated Cortex-M3: %s" % error)
    with QemuBoard(elf) as running:
        yield running
