"""Work that is done at the same time, on a processor each.

Python's threads take turns at everything but large arrays, and what a diagnosis does is many small
ones: a copy of this process works out what another processor has time for, and hands it back.
"""
import os
import pickle
import signal
import sys
from typing import NamedTuple

from . import progress


class Copy(NamedTuple):
    """A copy of this process that calls functions, and ends: its number (None: the system had none
    to give), and the pipe that their results come by."""

    functions: list
    pid: int | None
    pipe: object


def results(functions, processors):
    """[what each of functions, called without arguments, returns], in their order. They are dealt
    out to this process and to a copy of it for each further processor, where the system has cheap
    copies (Linux; elsewhere they run here, one after the other): what they return has to be
    picklable, and what they change is changed in the copy only. What one raises is raised here."""
    functions = list(functions)
    number = min(processors, len(functions)) if sys.platform == "linux" else 1
    if number < 2:
        return [function() for function in functions]
    copies = [_started(functions[k::number]) for k in range(1, number)]
    try:
        dealt = [[function() for function in functions[::number]], *map(_results_of, copies)]
        return [dealt[k % number][k // number] for k in range(len(functions))]
    finally:
        for copy in copies:
            _ended(copy)


def _started(functions):
    """Copy at work on these functions."""
    out, into = os.pipe()
    try:
        pid = os.fork()
    except OSError:
        pid = None
    if pid == 0:
        _answer(functions, into)
    os.close(into)
    return Copy(functions, pid, os.fdopen(out, "rb"))


def _results_of(copy):
    try:
        outcome, value = pickle.load(copy.pipe)
    except EOFError:  # there is none, or it was ended from outside, as where memory is short
        return [function() for function in copy.functions]
    if outcome == "raised":
        raise value
    return value


def _ended(copy):
    copy.pipe.close()
    if copy.pid is not None:
        os.kill(copy.pid, signal.SIGKILL)
        os.waitpid(copy.pid, 0)


def _answer(functions, into):
    """In the copy: write what the functions return, and end without what the original does at its
    end."""
    try:
        progress.silence()
        try:
            outcome = "returned", [function() for function in functions]
        except Exception as error:
            outcome = "raised", error
        with os.fdopen(into, "wb") as pipe:
            pickle.dump(outcome, pipe, pickle.HIGHEST_PROTOCOL)
    finally:
        os._exit(0)
