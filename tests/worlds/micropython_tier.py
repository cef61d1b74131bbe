"""Fixtures of the tests that need a real MicroPython: found, or one clear line why not.

SIXFLIP_MICROPYTHON, PATH, or what `make micropython` has put into the cache. For a user a
missing one is a skip, which is a failure in CI (CI=true).
"""

import hashlib
import json
import shutil

import pytest

from sixflip_host.board import firmware_update
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


@pytest.fixture(scope="session")
def provisioned(micropython, once, tmp_path_factory):
    """provisioned(path, settings): a flash with the firmware and these settings, whose sensor is
    named; provisioned by one test of a run, and copied for all others."""
    def put(path, settings):
        def make():
            image = tmp_path_factory.mktemp("provisioned") / "flash.img"
            with VirtualBoard(dict(STILL, sensor=settings["sensor"]), image,
                              micropython=micropython) as board, \
                    MpremoteLink(board.port) as link:
                firmware_update.copy(link, settings, lambda text: None)
            return str(image)
        text = json.dumps(settings, sort_keys=True)
        shutil.copy(once("flash-" + hashlib.sha256(text.encode()).hexdigest()[:16], make), path)
    return put


@pytest.fixture
def board(micropython, tmp_path):
    """A virtual board with an erased flash, lying still."""
    with VirtualBoard(STILL, tmp_path / "flash.img", micropython=micropython) as board:
        yield board


@pytest.fixture
def link(board):
    with MpremoteLink(board.port) as link:
        yield link
