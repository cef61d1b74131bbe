"""One emulated board for all tests of this folder, or one line why not."""

import pytest

from tests.debian_tier import Unavailable, without

from .board import QemuBoard, cortex_m3
from .firmware import build


@pytest.fixture(scope="session")
def board():
    try:
        elf = build()
    except Unavailable as error:
        without("emulated Cortex-M3", error)
    with QemuBoard(cortex_m3(elf)) as running:
        yield running
