"""The virtual board is a board: mpremote, resets, Ctrl-C, flash that survives."""

import contextlib
import hashlib
import os
import subprocess
import sys
import time

import pytest

from sixflip_host.board import firmware_update, raw_repl
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.errors import SixflipError
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.micropython_tier import STILL


def mpremote(port, *words):
    answer = subprocess.run([sys.executable, "-m", "mpremote", "connect", port, *words],
                            capture_output=True, text=True, timeout=60)
    return answer.returncode, answer.stdout


def ends(pid):
    """Whether a process is gone soon."""
    for _ in range(100):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False


def test_mpremote_copies_hashes_and_runs(board, tmp_path):
    source = tmp_path / "a.bin"
    source.write_bytes(bytes(range(256)) * 20)
    assert mpremote(board.port, "fs", "cp", str(source), ":a.bin")[0] == 0
    code, out = mpremote(board.port, "fs", "sha256sum", "a.bin")
    assert code == 0
    assert hashlib.sha256(source.read_bytes()).hexdigest() in out
    code, out = mpremote(board.port, "exec", "import os; print(os.stat('a.bin')[6])")
    assert (code, out.strip()) == (0, "5120")


def test_traceback_of_the_board_is_exit_1(board):
    code, out = mpremote(board.port, "exec", "1/0")
    assert code == 1
    assert "ZeroDivisionError" in out


def test_ctrl_c_stops_a_tight_loop(board, link):
    link.put("main.py", b"while True:\n    pass\n")
    link.reset()
    assert list(link.files([])) == ["main.py"]


def test_ctrl_c_before_the_board_listens_for_it_stops_the_firmware(board, link):
    """Typed at power-up it is a character that waits on stdin, on a Pico too."""
    firmware_update.copy(link, {"sensor": STILL["sensor"]})
    board.power_cycle()
    with link.guarded("stopping") as transport:
        transport.serial.write(b"\r\x03")
    link.raw = False
    said = []
    for line in link.lines(10):
        said.append(line)
        if "KeyboardInterrupt" in line or '"calibrating"' in line:
            break
    assert "KeyboardInterrupt" in said[-1], said


def test_ctrl_c_stops_a_flood_of_output(board, link):
    link.put("main.py", b"while True:\n    print('spam' * 20)\n")
    link.reset()
    next(link.lines(5))
    assert list(link.files([])) == ["main.py"]


def test_main_runs_at_power_up_and_after_resets_but_not_in_raw_mode(board, link):
    link.put("main.py", b"print('main ran')\n")
    link.reset()
    assert any("main ran" in line for line in link.lines(10))
    link.restart_firmware()
    assert any("main ran" in line for line in link.lines(10))
    board.power_cycle()
    assert any("main ran" in line for line in link.lines(10))
    starts = board.starts
    link.raw = False
    assert b"main ran" not in link.run("print('raw')", "running")
    assert board.starts == starts + 1


def test_host_modules_are_not_importable_on_the_board(link):
    for name in ("sixflip", "sixflip_sim", "sixflip_sim.worlds"):
        with pytest.raises(SixflipError, match="ImportError"):
            link.run("import " + name, "importing")


def test_machine_and_time_are_the_worlds(link):
    out = link.run("import machine, time\ni = machine.I2C(0)\nprint(i.readfrom_mem(0x68, 0x75, 1))"
                   "\nt = time.ticks_ms()\ntime.sleep(100)\nprint(time.ticks_diff("
                   "time.ticks_ms(), t) >= 100000)", "asking")
    assert out.split() == [b"b'h'", b"True"]


def test_raw_paste_takes_a_source_of_many_windows(link):
    source = "x = 0\n" + "x += 1\n" * 500 + "print(x)"
    assert link.run(source, "running").strip() == b"500"


@pytest.mark.long
def test_power_cut_leaves_the_old_or_the_new_file(board, link, monkeypatch):
    old, new = b"o" * 3000, b"n" * 3000
    link.put("f", old)
    link.close()
    seen = set()
    for cut in (0, 1, 3, 5, 8, 40):
        board.cut_after = cut
        board.power_cycle()
        link.close()
        with MpremoteLink(board.port) as again, contextlib.suppress(SixflipError), \
                monkeypatch.context() as waits:
            waits.setattr(raw_repl, "ANSWER_S", 0.5)  # of one that loses its power on the way
            again.put("f", new)
        with MpremoteLink(board.port) as again:
            seen.add(again.get("f"))
            assert seen <= {old, new}
            board.cut_after = None
            board.power_cycle()
            again.raw = False
            again.put("f", old)
    assert seen == {old, new}


def test_no_process_is_left(micropython, tmp_path):
    with VirtualBoard(STILL, tmp_path / "flash.img", micropython=micropython) as board:
        pid = board.child.pid
        board.power_cycle()
        assert ends(pid)
        pid = board.child.pid
    assert ends(pid)


def test_the_board_dies_with_its_host(micropython, tmp_path):
    """Even when the host's process is killed, no MicroPython is left behind."""
    code = ("import sys, time\nfrom sixflip_host.virtual.virtual_board import VirtualBoard\n"
            "with VirtualBoard({'order': []}, sys.argv[1], micropython=sys.argv[2]) as board:\n"
            "    print(board.child.pid, flush=True)\n    time.sleep(60)\n")
    host = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "f.img"), micropython],
                            stdout=subprocess.PIPE, text=True)
    pid = int(host.stdout.readline())
    host.kill()
    host.communicate()
    assert ends(pid)
