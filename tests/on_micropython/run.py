"""Runs tests/shared/test_*.py on MicroPython: micropython run.py [names without .py].

Exit status 1 on failure; the last line is "N passed, N failed".
"""

import gc
import os
import sys

HERE = __file__[: __file__.rindex("/")] if "/" in __file__ else "."
ROOT = HERE + "/../.."
TESTS = ROOT + "/tests/shared"
sys.path[:0] = [HERE, TESTS, ROOT + "/shared", ROOT + "/host"]

import unittest  # noqa: E402  the small one beside this file


def run(name):
    try:
        module = __import__(name)
    except Exception as e:
        print("FAILED %s: it cannot be imported" % name)
        sys.print_exception(e)
        return 0, 1, 0
    counts = unittest.run_module(module)
    # the next file begins with an empty heap
    for loaded in list(sys.modules):
        if loaded == name or loaded.startswith("sixflip"):
            del sys.modules[loaded]
    gc.collect()
    return counts


def main(names):
    if not names:
        names = sorted(n[:-3] for n in os.listdir(TESTS) if n[:5] == "test_" and n[-3:] == ".py")
    passed = failed = skipped = 0
    for name in names:
        p, f, s = run(name)
        print("%s: %d passed, %d failed" % (name, p, f) + (", %d skipped" % s if s else ""))
        passed += p
        failed += f
        skipped += s
    if skipped:
        print("%d skipped" % skipped)
    print("%d passed, %d failed" % (passed, failed))
    return 1 if failed or not passed else 0


sys.exit(main(sys.argv[1:]))
