"""The effects of the simulated chip are the same on the board's interpreter and on CPython."""
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def test_the_same_counts_with_effects_on_both_interpreters(micropython):
    folders = "%s:%s" % (ROOT / "shared", ROOT / "host")
    script = "effects_through_the_chip.py"
    board = micropython(script, folders, heap="1m")
    assert board.returncode == 0, board.stdout[-500:] + board.stderr
    host = subprocess.run([sys.executable, str(HERE / script), folders], capture_output=True,
                          text=True, timeout=120, check=True)
    assert board.stdout == host.stdout
    assert len(board.stdout.split("\n")) > 700
