"""The emulated Pico's fixtures.

Its firmware image is in no package registry, so of all tiers this one alone may be absent in CI.
"""

import os
import shutil

import pytest

from sixflip_host.board import calibrate, provision
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.emulated import firmware_image
from sixflip_host.errors import NoBoard
from sixflip_host.virtual import demo, micropython_fetch
from sixflip_host.virtual.virtual_board import VirtualBoard

# half an hour: make test-pico sets this
collect_ignore = [] if os.environ.get("SIXFLIP_PICO") == "whole" else ["test_pico_session.py"]


def missing(what):
    """What every other tier needs as well: its absence is a failure in CI."""
    if os.environ.get("CI") == "true":
        pytest.fail(what)
    pytest.skip(what)


@pytest.fixture(scope="session")
def uf2():
    """Path of the firmware image, or a skip with one line, in CI too."""
    try:
        return firmware_image.find()
    except NoBoard as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def flashes(uf2, tmp_path_factory):
    """Paths of two flashes: of a calibrated board, and of the same without its main.py."""
    from pico_flash import FILES_BYTES, SPEC, flash
    micropython = micropython_fetch.find()
    if micropython is None:
        missing(micropython_fetch.MISSING)
    folder = tmp_path_factory.mktemp("flash")
    files = folder / "files.img"
    with VirtualBoard(SPEC, files, micropython=micropython, flash_bytes=FILES_BYTES) as board, \
            MpremoteLink(board.port) as link:
        provision.copy(link, {"sensor": "mpu6050", "board": "pico",
                              **demo.PACE["pico"].settings})
        link.reset()
        assert calibrate.follow(link, lambda event: None)["verdict"] == "good"
        calibrated = folder / "calibrated.bin"
        link.enter()
        calibrated.write_bytes(flash(uf2, files.read_bytes()))
        link.remove("main.py")
        still = folder / "still.bin"
        still.write_bytes(flash(uf2, files.read_bytes()))
    return calibrated, still


@pytest.fixture
def calibrated_flash(flashes, tmp_path):
    return shutil.copy(flashes[0], tmp_path / "pico.bin")


@pytest.fixture
def still_flash(flashes, tmp_path):
    return shutil.copy(flashes[1], tmp_path / "pico.bin")
