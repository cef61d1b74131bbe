"""As much of unittest as the shared tests use, for MicroPython, which has none built in."""

import gc
import sys


class SkipTest(Exception):
    pass


class _Raises:
    def __init__(self, expected):
        self.expected = expected
        self.exception = None

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if error is None:
            raise AssertionError("%s not raised" % self.expected)
        if not isinstance(error, self.expected):
            return False
        self.exception = error
        return True


class TestCase:
    def setUp(self):
        pass

    def tearDown(self):
        pass

    def fail(self, msg=None):
        raise AssertionError(msg or "failed")

    def skipTest(self, reason):
        raise SkipTest(reason)

    def _check(self, ok, text, msg):
        if not ok:
            raise AssertionError("%s: %s" % (msg, text) if msg else text)

    def assertEqual(self, a, b, msg=None):
        self._check(a == b, "%r != %r" % (a, b), msg)

    def assertNotEqual(self, a, b, msg=None):
        self._check(a != b, "%r == %r" % (a, b), msg)

    assertListEqual = assertEqual
    assertTupleEqual = assertEqual
    assertDictEqual = assertEqual
    assertSequenceEqual = assertEqual

    def assertAlmostEqual(self, a, b, places=7, msg=None, delta=None):
        if delta is None:
            delta = 0.5 * 10 ** (-places)
        self._check(a == b or abs(a - b) <= delta, "%r is not within %r of %r" % (a, delta, b),
                    msg)

    def assertNotAlmostEqual(self, a, b, places=7, msg=None, delta=None):
        if delta is None:
            delta = 0.5 * 10 ** (-places)
        self._check(abs(a - b) > delta, "%r is within %r of %r" % (a, delta, b), msg)

    def assertTrue(self, a, msg=None):
        self._check(a, "%r is not true" % (a,), msg)

    def assertFalse(self, a, msg=None):
        self._check(not a, "%r is not false" % (a,), msg)

    def assertIs(self, a, b, msg=None):
        self._check(a is b, "%r is not %r" % (a, b), msg)

    def assertIsNot(self, a, b, msg=None):
        self._check(a is not b, "%r is %r" % (a, b), msg)

    def assertIsNone(self, a, msg=None):
        self._check(a is None, "%r is not None" % (a,), msg)

    def assertIsNotNone(self, a, msg=None):
        self._check(a is not None, "is None", msg)

    def assertIn(self, a, b, msg=None):
        self._check(a in b, "%r not in %r" % (a, b), msg)

    def assertNotIn(self, a, b, msg=None):
        self._check(a not in b, "%r in %r" % (a, b), msg)

    def assertIsInstance(self, a, kind, msg=None):
        self._check(isinstance(a, kind), "%r is no %r" % (a, kind), msg)

    def assertLess(self, a, b, msg=None):
        self._check(a < b, "%r is not less than %r" % (a, b), msg)

    def assertLessEqual(self, a, b, msg=None):
        self._check(a <= b, "%r is greater than %r" % (a, b), msg)

    def assertGreater(self, a, b, msg=None):
        self._check(a > b, "%r is not greater than %r" % (a, b), msg)

    def assertGreaterEqual(self, a, b, msg=None):
        self._check(a >= b, "%r is less than %r" % (a, b), msg)

    def assertRaises(self, expected, call=None, *args, **kwargs):
        if call is None:
            return _Raises(expected)
        with _Raises(expected) as caught:
            call(*args, **kwargs)
        return caught


def cases_of(module):
    """The TestCase classes of a module, by name."""
    for name in sorted(dir(module)):
        found = getattr(module, name)
        if isinstance(found, type) and issubclass(found, TestCase) and found is not TestCase:
            yield name, found


def run_module(module, say=print):
    """(passed, failed, skipped) of a module's tests; a failure is said with its trace."""
    passed = failed = skipped = 0
    for class_name, case in cases_of(module):
        for name in sorted(dir(case)):
            if not name.startswith("test"):
                continue
            test = case()
            gc.collect()  # every test begins with what a small board has
            try:
                test.setUp()
                try:
                    getattr(test, name)()
                finally:
                    test.tearDown()
                passed += 1
            except SkipTest as e:
                skipped += 1
                say("skipped %s.%s.%s: %s" % (module.__name__, class_name, name, e))
            except Exception as e:
                failed += 1
                say("FAILED %s.%s.%s" % (module.__name__, class_name, name))
                if hasattr(sys, "print_exception"):
                    sys.print_exception(e)
                else:
                    import traceback

                    traceback.print_exception(type(e), e, e.__traceback__)
    return passed, failed, skipped


def main(module="__main__"):
    """Run the tests of a file started by itself; exit status 1 on failure."""
    found = __import__(module) if isinstance(module, str) else module
    passed, failed, skipped = run_module(found)
    print("%d passed, %d failed" % (passed, failed))
    sys.exit(1 if failed else 0)
