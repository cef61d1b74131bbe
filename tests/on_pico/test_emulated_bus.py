"""The real machine.I2C of the Pico's firmware, and how the board's code sees a bus that fails."""

import pytest

pytest.importorskip("rp2040py")
from sixflip_host.board.board_link import MpremoteLink  # noqa: E402
from sixflip_host.emulated.emulated_pico import PATIENCE, PicoBoard  # noqa: E402

SCRIPT = """
from sixflip_device.sensor import free_bus
from sixflip_device.boards import pico
from sixflip_device.settings import defaults
board = pico.make(defaults())
def ask(address, register):
    try:
        print(list(board.i2c.readfrom_mem(address, register, 1)))
    except OSError as e:
        print(e.args[0])
"""
EIO, ETIMEDOUT = b"5", b"110"


def on_the_board(flash, script, **spec):
    """The lines that a script prints on a Pico with a still box and the spec's bus."""
    with PicoBoard(dict({"order": []}, **spec), flash) as board, \
            MpremoteLink(board.port, PATIENCE) as link:
        return link.run(SCRIPT + script, "asking the bus").split(b"\r\n")[:-1]


def test_bad_states_of_the_bus(still_flash):
    said = on_the_board(
        still_flash, "ask(0x68, 0x75)\nask(0x53, 0)\nask(0x68, 0x75)\n"
        "ask(0x68, 0x75)\nboard.sleep_us(10000)\nask(0x68, 0x75)\n"
        "ask(0x68, 0x75)\nfree_bus(board)\nask(0x68, 0x75)\n",
        faults=[{"kind": "timeout", "at": 5}, {"kind": "stuck_sda", "at": 9, "pulses": 18}])
    assert said == [
        b"[104]", EIO, b"[104]",       # no chip there, and the bus works on
        ETIMEDOUT, b"[104]",           # SCL held for longer than the driver waits
        # SDA held: the port clocks ten times by hand after a failed readfrom_mem (the STOP
        # it owes is a transfer of no bytes, which its hardware cannot do), then we do
        ETIMEDOUT, b"[104]"]
