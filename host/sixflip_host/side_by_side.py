"""Work that is done at the same time, on a processor each.

Python's threads take turns at everything but large arrays, and what a diagnosis does is many small
ones: a copy of this process works out what another processor has time for, and hands it back.
"""
import os
import pickle
import signal
import sys

from . import progress


def results(functions, processors):
    """[what each of functions, called without arguments, returns], in their order. With more than
    one processor all but the first run in a copy of this process each, where the system has cheap
    copies (Linux; elsewhere they run here, one after the other): what they return has to be
    picklable, and what they change is changed in the copy only. What one raises is raised here."""
    functions = list(functions)
    if processors < 2 or len(functions) < 2 or sys.platform != "linux":
        return [function() for function in functions]
    copies = [_Copy(function) for function in functions[1:]]
    try:
        return [functions[0](), *(copy.result() for copy in copies)]
    finally:
        for copy in copies:
            copy.end()


class _Copy:
    """A copy of this process that calls a function and ends; a system that has no more processes
    to give leaves the function to this one."""

    def __init__(self, function):
        self.function, self.pid = function, None
        out, into = os.pipe()
        try:
            self.pid = os.fork()
        except OSError:
            os.close(into)
        if self.pid == 0:
            _answer(function, into)
        if self.pid:
            os.close(into)
        self.out = os.fdopen(out, "rb")

    def result(self):
        try:
            outcome, value = pickle.load(self.out)
        except EOFError:  # it was ended from outside, as where memory is short
            return self.function()
        if outcome == "raised":
            raise value
        return value

    def end(self):
        self.out.close()
        if self.pid:
            os.kill(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)
            self.pid = None


def _answer(function, into):
    """In the copy: write what the function returns, and end without what the original does at its
    end."""
    try:
        progress.silence()
        try:
            outcome = "returned", function()
        except Exception as error:
            outcome = "raised", error
        with os.fdopen(into, "wb") as pipe:
            pickle.dump(outcome, pipe, pickle.HIGHEST_PROTOCOL)
    finally:
        os._exit(0)
