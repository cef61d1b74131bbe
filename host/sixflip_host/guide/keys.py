"""Single keys of a terminal, without waiting and without an Enter."""

import os
import select
import sys

try:
    import termios
    import tty
except ImportError:  # Windows: calibrate falls back to lines
    termios = None


def possible(stream=None):
    """Whether keys can be read: a terminal, on a system that has termios."""
    stream = sys.stdin if stream is None else stream
    return termios is not None and stream is not None and stream.isatty()


class Keys:
    """Context manager: the terminal gives every key at once, Ctrl-C stays Ctrl-C."""

    def __init__(self, stream=None):
        self.stream = sys.stdin if stream is None else stream
        self.before = None

    def __enter__(self):
        self.descriptor = self.stream.fileno()
        self.before = termios.tcgetattr(self.descriptor)
        tty.setcbreak(self.descriptor)
        return self

    def __exit__(self, *error):
        termios.tcsetattr(self.descriptor, termios.TCSADRAIN, self.before)

    def read(self):
        """The keys pressed since; "esc" and "enter" by name, arrows and the like not at all."""
        found = []
        while select.select([self.descriptor], [], [], 0)[0]:
            data = os.read(self.descriptor, 64)
            if not data:
                break
            found += named(data)
        return found


def named(data):
    """Names of the keys in the bytes of one read."""
    if data[:1] == b"\x1b":
        return ["esc"] if len(data) == 1 else []
    names = []
    for letter in data.decode("ascii", "ignore"):
        if letter in "\r\n":
            names.append("enter")
        elif letter.isprintable():
            names.append(letter)
    return names
