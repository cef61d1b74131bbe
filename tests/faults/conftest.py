"""Where the tests of faults find what the other tests have: a simulated board, a MicroPython."""

import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "device"), str(TESTS / "host")]

from micropython_tier import micropython  # noqa: E402

__all__ = ["micropython"]
