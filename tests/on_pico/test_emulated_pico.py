"""Real Pico firmware in the emulator, the short form: its interpreter, files and record.

What the board needs is put into its flash beforehand (pico_flash.py); test_pico_session.py has
it power up and calibrate itself, which takes minutes.
"""

import subprocess
import sys

import pytest

pytest.importorskip("rp2040py")
from pico_flash import LOAD, STILL  # noqa: E402

from sixflip_host.board.board_link import MpremoteLink  # noqa: E402
from sixflip_host.emulated.emulated_pico import PATIENCE, PicoBoard  # noqa: E402


def test_a_record_that_another_port_saved_is_valid(still_flash):
    with PicoBoard(STILL, still_flash) as board, MpremoteLink(board.port, PATIENCE) as link:
        assert link.run(LOAD, "loading").rstrip() == b"['a', 1, []]"


def test_the_emulator_ends_with_its_host(still_flash):
    """Even when the host is killed: the end of its input is the end of the board."""
    code = ("import sys\nfrom sixflip_host.emulated.emulated_pico import PicoBoard\n"
            "with PicoBoard({'order': []}, sys.argv[1]) as board:\n"
            "    print(board.port, flush=True)\n    sys.stdin.read()\n")
    host = subprocess.Popen([sys.executable, "-c", code, str(still_flash)], text=True,
                            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert host.stdout.readline().startswith("/dev/")
    host.kill()
    # the emulator inherited this pipe: it is closed when both are gone
    assert host.communicate(timeout=300)[1] == ""
