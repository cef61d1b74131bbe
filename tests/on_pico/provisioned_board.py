"""A virtual board with the Pico's settings, to make the emulated Pico's flash with."""

import contextlib

import pytest
from pico_flash import FILES_BYTES

from sixflip_host.board import firmware_update
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.virtual import demo_bench, micropython_fetch
from sixflip_host.virtual.virtual_board import VirtualBoard


@contextlib.contextmanager
def provisioned(files, spec):
    """Link to a virtual board with the Pico's settings, not started; its littlefs is in files."""
    micropython = micropython_fetch.find()
    if micropython is None:
        pytest.skip(micropython_fetch.MISSING)
    with VirtualBoard(spec, files, micropython=micropython, flash_bytes=FILES_BYTES) as board, \
            MpremoteLink(board.port) as link:
        firmware_update.copy(link, {"sensor": spec["sensor"], "board": "pico",
                              **demo_bench.PACE["pico"].settings})
        yield link
