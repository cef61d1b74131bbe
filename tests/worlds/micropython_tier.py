"""Fixtures of the tests that need a real MicroPython: found, or one clear line why not.

SIXFLIP_MICROPYTHON, PATH, or what `make micropython` has put into the cache. For a user a
missing one is a skip, which is a failure in CI (CI=true).
"""

import pytest

from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.virtual import micropython_fetch
from sixflip_host.virtual.virtual_board import VirtualBoard

STILL = {"sensor": "mpu6050", "seed": 3, "order": []}
SESSION = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0}


@pytest.fixture(scope="session")
def micropython():
    path = micropython_fetch.find()
    if path is None:
        pytest.skip(micropython_fetch.MISSING)
    return path


@pytest.fixture
def board(micropython, tmp_path):
    """A virtual board with an erased flash, lying still."""
    with VirtualBoard(STILL, tmp_path / "flash.img", micropython=micropython) as board:
        yield board


@pytest.fixture
def link(board):
    with MpremoteLink(board.port) as link:
        yield link
