"""Ctrl-C, remembered: a library that is interrupted while it loads says something else."""

import contextlib
import signal
import threading


@contextlib.contextmanager
def remembered():
    """While it lasts Ctrl-C raises KeyboardInterrupt as ever; yields the list of its presses.

    numpy makes an ImportError with a page of advice of a KeyboardInterrupt in the middle of its
    own import: whoever sees an error of that kind has to know that a key was pressed. Python
    lets only the main thread say what a signal does, and a caller with a handler of his own
    keeps it.
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
        yield presses
    finally:
        if ours and signal.getsignal(signal.SIGINT) is press:
            signal.signal(signal.SIGINT, signal.default_int_handler)
