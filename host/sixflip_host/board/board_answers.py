"""What a board's answers and its exceptions mean."""

import ast
import os

from ..errors import NoBoard, SixflipError
from ..value_kinds import Misfit

LONGEST = 4096      # bytes of a literal: a version, a file's name, size and hash


class NoSpace(SixflipError):
    """The board's flash is full."""


def parse(port, printed, kind):
    """A Python literal that the board printed, of a kind of board_schema's."""
    try:
        if len(printed) > LONGEST:
            raise ValueError
        return kind.take(ast.literal_eval(printed.decode("utf-8").strip()))
    except Misfit as misfit:
        raise NoBoard("%s: cannot understand the board's answer %r: %s"
                      % (port, printed[:60], misfit)) from None
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        raise NoBoard("%s: cannot understand the board's answer %r, expected %s"
                      % (port, printed[:60], kind.expected)) from None


def short(error):
    """The first line of an exception, or its name."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    return (str(error) or type(error).__name__).splitlines()[0][:120]


def board_error(port, doing, error):
    """What an exception on the board means for the user."""
    last = (error.error_output.strip().splitlines() or ["no word"])[-1]
    if "ENOSPC" in last or last.endswith("OSError: 28"):
        return NoSpace("%s: no space left in the board's flash while %s; remove files of yours "
                       "or an old capture (mpremote fs rm capture.bin)" % (port, doing))
    return SixflipError("%s: the board failed while %s: %s" % (port, doing, last))
