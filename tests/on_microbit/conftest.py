"""One emulated micro:bit for all tests of this folder, or one line why not."""

import os
import shutil

import pytest

from tests.debian_tier import Unavailable, install, without

from .board import FIRMWARE, Microbit

PACKAGES = ("qemu-system-arm", "firmware-microbit-micropython")


def missing():
    return ([] if shutil.which("qemu-system-arm") else ["qemu-system-arm"]) + (
        [] if os.path.exists(FIRMWARE) else [FIRMWARE])


@pytest.fixture(scope="session")
def running():
    try:
        install(PACKAGES, missing)
    except Unavailable as error:
        without("emulated micro:bit", error)
    with Microbit() as board:
        yield board


@pytest.fixture
def microbit(running):
    """With an empty heap."""
    running.reset()
    return running
