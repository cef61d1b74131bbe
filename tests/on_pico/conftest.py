"""The emulated Pico's fixtures.

Its firmware image is in no package registry, so of all tiers this one alone may be absent in CI.
"""

import json
import os
import shutil

import pytest

from sixflip_host.board import calibration_request
from sixflip_host.board.board_events import wait_for
from sixflip_host.board.event_words import GUIDED_ORDER
from sixflip_host.emulated import emulated_pico
from sixflip_host.errors import NoBoard
from sixflip_host.verbs import calibrate

# an hour: make test-pico sets this
collect_ignore = [] if os.environ.get("SIXFLIP_PICO") == "whole" else ["test_pico_session.py"]


@pytest.fixture(scope="session")
def uf2():
    """Path of the firmware image, or a skip with one line, in CI too."""
    try:
        return emulated_pico.find_image()
    except NoBoard as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def flashes(uf2, tmp_path_factory):
    """Paths of two flashes: of a calibrated board, and of the same without its main.py."""
    from pico_flash import SPEC, flash
    from provisioned_board import provisioned
    folder = tmp_path_factory.mktemp("flash")
    files = folder / "files.img"
    with provisioned(files, SPEC) as link:
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


@pytest.fixture
def gy85_flash(uf2, tmp_path):
    """Of a board that has its firmware and was never started."""
    from pico_flash import SPEC, flash
    from provisioned_board import provisioned
    files = tmp_path / "files.img"
    path = tmp_path / "pico.bin"
    with provisioned(files, dict(SPEC, sensor="gy85")):
        path.write_bytes(flash(uf2, files.read_bytes()))
    return path


@pytest.fixture
def unfinished_flash(uf2, tmp_path):
    """Of a board whose session was stopped before its last face, and is to go on."""
    from pico_flash import LAST_FACE, SPEC, flash
    from provisioned_board import provisioned
    files = tmp_path / "files.img"
    first = [pose for pose in GUIDED_ORDER if pose not in LAST_FACE]
    with provisioned(files, dict(SPEC, order=first)) as link:
        link.reset()
        for _ in first:
            wait_for(link, ("pose",))
        link.send(json.dumps({"cmd": "stop"}))
        assert wait_for(link, ("solved",))["missing"] == LAST_FACE
        link.put(calibration_request.FLAG, json.dumps({"continue": True}).encode())
        path = tmp_path / "pico.bin"
        path.write_bytes(flash(uf2, files.read_bytes()))
    return path
