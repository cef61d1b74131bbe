"""The same plain unittest files as under CPython, on the real interpreter."""

from pathlib import Path

import pytest

SHARED = Path(__file__).resolve().parent.parent / "shared"


@pytest.mark.parametrize("name", sorted(p.stem for p in SHARED.glob("test_*.py")))
def test_file(micropython, name):
    done = micropython("run.py", name, heap="4m")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1].endswith(" passed, 0 failed")


BROKEN = """
import unittest

class Broken(unittest.TestCase):
    def test_right(self):
        self.assertEqual(1, 1)

    def test_wrong(self):
        %s
"""


@pytest.mark.parametrize("wrong", [
    "self.assertEqual(1, 2)", "self.assertAlmostEqual(1.0, 1.1, delta=0.05)",
    "self.assertRaises(ValueError, int, '1')", "self.assertIn(1, [2])", "raise ValueError('no')",
    "self.assertTrue([])", "self.assertLess(2, 2)", "self.assertIs([], [])",
])
def test_a_failure_is_an_exit_status(micropython, tmp_path, wrong):
    (tmp_path / "test_broken.py").write_text(BROKEN % wrong)
    done = micropython("run.py", "test_broken", path=tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "1 passed, 1 failed"
    assert "FAILED test_broken.Broken.test_wrong" in done.stdout


def test_a_file_that_cannot_be_imported_is_a_failure(micropython, tmp_path):
    (tmp_path / "test_nothing.py").write_text("import no_such_module\n")
    done = micropython("run.py", "test_nothing", path=tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "0 passed, 1 failed"
