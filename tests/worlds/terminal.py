"""sixflip in a real terminal: a pseudo-terminal and an emulator of one."""

import collections
import fcntl
import os
import pty
import select
import struct
import sys
import termios
import time

import pyte

WAIT_S = 400            # on a busy machine; what is waited for ends it
HOME = b"\x1b[H"         # every picture of the screen begins with it


class Terminal:
    """sixflip with the arguments in a terminal of so many lines and columns."""

    def __init__(self, *argv, lines=24, columns=80, **environment):
        self.screen = pyte.Screen(columns, lines)
        self.stream = pyte.ByteStream(self.screen)
        self.sent = b""
        self.seen = collections.deque()     # every picture since the last that was waited for
        self.code = None
        settings = dict(os.environ, TERM="xterm-256color", PYTHONIOENCODING="utf-8")
        for name in ("NO_COLOR", "COLUMNS", "LINES"):
            settings.pop(name, None)
        settings.update(environment)
        self.child, self.terminal = pty.fork()
        if self.child == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
            os.execve(sys.executable, [sys.executable, "-m", "sixflip_host", *argv], settings)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self.code is None:
            os.kill(self.child, 9)
            os.waitpid(self.child, 0)
        os.close(self.terminal)

    @property
    def text(self):
        return "\n".join(self.screen.display)

    @property
    def words(self):
        """The same without the ends of lines, wherever they fall."""
        return "".join(self.screen.display).replace(" ", "")

    def read(self):
        """What came; False when the program has ended."""
        if not select.select([self.terminal], [], [], 0.2)[0]:
            return True
        try:
            data = os.read(self.terminal, 65536)
        except OSError:
            return False
        self.sent += data
        for number, piece in enumerate(data.split(HOME)):
            self.stream.feed(HOME + piece if number else piece)
            self.seen.append(self.text)
        return bool(data)

    def wait(self, *words):
        """Until all the words stand, or stood since the last wait, on the screen at once."""
        end = time.monotonic() + WAIT_S
        while True:
            while self.seen:
                shown = self.seen.popleft()
                if all(word in shown for word in words):
                    return
            assert time.monotonic() < end, "no %r on\n%s" % (words, self.text)
            assert self.read() or self.seen, "ended without %r:\n%s" % (words, self.text)

    def press(self, key):
        os.write(self.terminal, key.encode())

    def ended(self):
        """The exit code."""
        end = time.monotonic() + WAIT_S
        while self.read():
            assert time.monotonic() < end, self.text
        self.code = os.waitstatus_to_exitcode(os.waitpid(self.child, 0)[1])
        return self.code
