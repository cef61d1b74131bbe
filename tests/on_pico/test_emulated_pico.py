"""Real Pico firmware in the emulator, the short form: power-up with a record.

What the board needs is put into its flash beforehand (pico_flash.py); test_pico_session.py has
it all done through the port.
"""

import json
import subprocess
import sys

import pytest

pytest.importorskip("rp2040py")
from pico_flash import SPEC  # noqa: E402

from sixflip_host.board.board_events import events, wait_for  # noqa: E402
from sixflip_host.board.board_link import MpremoteLink  # noqa: E402
from sixflip_host.emulated.emulated_pico import PATIENCE, PicoBoard  # noqa: E402
from sixflip_host.virtual import demo, demo_truth  # noqa: E402
from sixflip_sim import worlds  # noqa: E402


def test_comes_up_corrected(calibrated_flash):
    spec = dict(SPEC, order=[], tilt_deg=0.0)
    [(_, true)] = demo_truth.truth(worlds.make(spec))
    with PicoBoard(spec, calibrated_flash) as board, MpremoteLink(board.port, PATIENCE) as link:
        link.send(json.dumps({"cmd": "stream", "hz": 25}))
        hello = wait_for(link, ("hello",))
        assert (hello["board"], hello["float_bits"]) == ("pico", 32)
        ready = wait_for(link, ("ready", "error", "calibrating"))
        assert (ready["event"], ready.get("corrected")) == ("ready", True)
        vectors = []
        for event in events(link, 20, 60):
            if event["event"] == "sample":
                vectors.append(event["a"])
            if len(vectors) == 12:
                break
        assert board.state()["cuts"] == 0
    mean = [sum(v[axis] for v in vectors) / len(vectors) for axis in range(3)]
    assert demo_truth.error_mg(mean, true) < demo.LIMIT_MG


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
