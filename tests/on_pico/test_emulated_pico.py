"""Real Pico firmware in the emulator, the short form: power-up and bad states of the bus.

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
from sixflip_host.errors import NoBoard  # noqa: E402
from sixflip_host.virtual import demo, demo_truth  # noqa: E402
from sixflip_sim import worlds  # noqa: E402

ASK = """
def ask(address, register):
    try:
        print(list(board.i2c.readfrom_mem(address, register, 1)))
    except OSError as e:
        print(e.args[0])
"""
SCRIPT = """
from sixflip_device.bus_recovery import free_bus
from sixflip_device.boards import pico
from sixflip_device.settings import defaults
board = pico.make(defaults())
""" + ASK
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
        "ask(0x68, 0x75)\nask(0x68, 0x75)\nfree_bus(board)\nask(0x68, 0x75)\n",
        faults=[{"kind": "timeout", "at": 5}, {"kind": "stuck_sda", "at": 9}])
    assert said == [
        b"[104]", EIO, b"[104]",       # no chip there, and the bus works on
        ETIMEDOUT, b"[104]",           # SCL held for longer than the driver waits
        ETIMEDOUT, ETIMEDOUT, b"[104]"]  # SDA held, until it was clocked free


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
            if len(vectors) == 25:
                break
        assert board.state()["cuts"] == 0
    mean = [sum(v[axis] for v in vectors) / len(vectors) for axis in range(3)]
    assert demo_truth.error_mg(mean, true) < demo.LIMIT_MG


def test_an_image_that_is_none_is_one_line(tmp_path, uf2):
    wrong = tmp_path / "wrong.uf2"
    wrong.write_bytes(b"UF2\n" + bytes(508))
    with pytest.raises(NoBoard, match="wrong.uf2"), PicoBoard({}, tmp_path / "f.bin", wrong):
        pass


def test_the_emulator_ends_with_its_host(still_flash, uf2):
    """Even when the host is killed: the end of its input is the end of the board."""
    code = ("import sys, time\nfrom sixflip_host.emulated.emulated_pico import PicoBoard\n"
            "with PicoBoard({'order': []}, sys.argv[1]) as board:\n"
            "    print(board.child.pid, flush=True)\n    sys.stdin.read()\n")
    host = subprocess.Popen([sys.executable, "-c", code, str(still_flash)],
                            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    pid = int(host.stdout.readline())
    host.kill()
    host.communicate()
    assert ends(pid)


def ends(pid):
    """Whether a process is gone soon."""
    from pathlib import Path
    for _ in range(200):
        if not Path("/proc/%d/cmdline" % pid).exists():
            return True
        subprocess.run([sys.executable, "-c", "pass"])
    return False
