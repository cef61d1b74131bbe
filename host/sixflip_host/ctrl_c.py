"""Ctrl-C in the middle of an import: the library that is interrupted says something else."""

import contextlib
import signal
import threading


@contextlib.contextmanager
def kept():
    """While it lasts, what an import made of Ctrl-C is raised as KeyboardInterrupt again.

    numpy makes an ImportError with a page of advice of a KeyboardInterrupt in the middle of its
    own import, and an optional library would seem not to be installed. Python lets only the main
    thread say what a signal does, and a caller with a handler of his own keeps it.
    """
    presses = []

    def press(number, frame):
        presses.append(number)
        signal.default_int_handler(number, frame)

    ours = (threading.current_thread() is threading.main_thread()
            and signal.getsignal(signal.SIGINT) is signal.default_int_handler)
    if ours:
        signal.signal(signal.SIGINT, press)
    try:
        yield
    except Exception as error:
        if presses and _of_an_import(error):
            raise KeyboardInterrupt from error
        raise
    finally:
        if ours and signal.getsignal(signal.SIGINT) is press:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _of_an_import(error):
    """Whether an import that failed is what an error came from."""
    while error is not None:
        if isinstance(error, (ImportError, SystemError)):  # the latter is what C makes of it
            return True
        error = error.__cause__ or error.__context__
    return False
