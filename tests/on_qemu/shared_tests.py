"""Runs a file of tests/shared on the emulated board, with the small unittest of MicroPython."""

from pathlib import Path

from .firmware import frozen_files

ALL = sorted(Path(n).stem for n in frozen_files() if n.startswith("test_"))
# In a file of their own, for a processor of their own.
OF_SESSIONS = [name for name in ALL if name.startswith("test_session")]
SHARED_TESTS = [name for name in ALL if name not in OF_SESSIONS]

RUN = """
import gc, unittest
module = __import__(%r)
print('%%d passed, %%d failed, %%d skipped' %% tuple(unittest.run_module(module)))
"""


def pass_on_the_board(board, name):
    printed = board.exec(RUN % name)
    last = printed.strip().splitlines()[-1]
    passed, failed, _ = (int(part.split()[0]) for part in last.split(", "))
    assert failed == 0 and passed > 0, printed
