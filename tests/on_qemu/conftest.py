"""One emulated board for all tests of this folder, one just powered up where the heap is short,
or one line why not."""

import pytest

from tests.debian_tier import Unavailable, without

from .board import QemuBoard, cortex_m3
from .firmware import build


@pytest.fixture(scope="session")
def machine():
    try:
        return cortex_m3(build())
    except Unavailable as error:
        without("emulated Cortex-M3", error)


@pytest.fixture(scope="session")
def board(machine):
    with QemuBoard(machine) as running:
        yield running


@pytest.fixture
def powered_up(machine):
    """A board that ran nothing before: a soft reset leaves the memory as it was, and the collector
    takes what is left there for pointers."""
    with QemuBoard(machine) as running:
        yield running
