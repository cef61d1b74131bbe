"""The guided calibration on a terminal: a screen that follows the board, and keys."""

import os
import select
import shutil
import sys

from ..board.event_words import ROUND
from ..errors import SixflipError
from ..terminal import console
from . import screen
from .session_state import CALIBRATING, OVER

try:
    import termios
    import tty
except ImportError:  # Windows: calibrate falls back to lines
    termios = None

TICK_S = 0.1
SMALLEST = (80, 24)


def possible():
    """Whether this terminal can show it: a person's, large enough, that moves its cursor."""
    if not (sys.stdout.isatty() and keys_possible()):
        return False
    if os.environ.get("TERM", "dumb") in ("dumb", "unknown", ""):
        return False
    size = shutil.get_terminal_size()
    return size.columns >= SMALLEST[0] and size.lines >= SMALLEST[1]


def unicode_shown():
    """Whether the terminal's encoding has the characters of the drawings."""
    try:
        "╱█✓".encode(sys.stdout.encoding or "ascii")
        return True
    except (UnicodeError, LookupError):
        return False


def keys_possible(stream=None):
    """Whether keys can be read: a terminal, on a system that has termios."""
    stream = sys.stdin if stream is None else stream
    return termios is not None and stream is not None and stream.isatty()


class Keys:
    """Context manager: the terminal gives every key at once, without an Enter; Ctrl-C stays
    Ctrl-C."""

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
        keys = []
        while select.select([self.descriptor], [], [], 0)[0]:
            data = os.read(self.descriptor, 64)
            if not data:
                break
            keys += key_names(data)
        return keys


def key_names(data):
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


class Guide:
    """What is on the screen and what the next key means. session: a BoardSession."""

    def __init__(self, session):
        self.session = session
        self.asking = ""
        self.note = ""
        self.leave = False
        self.quit = False

    def lines(self, ascii_only=False):
        session = self.session
        height = max(screen.HEIGHT, shutil.get_terminal_size().lines)
        return screen.screen(session.state, session.link.port, self.asking, self.note,
                             session.step, ascii_only, height)

    def press(self, key):
        """One key: a command to the board, a question, or the answer to one."""
        asking, self.asking, self.note = self.asking, "", ""
        if asking == "redo":
            if key in "123456":
                self.session.redo(ROUND[int(key) - 1])
        elif asking == "quit":
            self.leave = self.quit = key == "y"
        elif asking != "help":
            self.command(key)

    def command(self, key):
        stage = self.session.state.stage
        if key == "?":
            self.asking = "help"
        elif key == "q" or key == "enter" and stage == OVER:
            if stage == OVER:
                self.leave = True
            else:
                self.asking = "quit"
        elif key == "r" and stage in (CALIBRATING, OVER):
            if self.session.state.plan:
                self.note = "a plan is taken back pose by pose: u"
            else:
                self.asking = "redo"
        elif key == "u" and stage == CALIBRATING:
            self.session.undo()
        elif key not in ("esc", "enter"):
            self.note = "key %s means nothing here; ? helps" % key

    def run(self):
        """Until the person leaves, or the board is lost. True: quit in the middle."""
        from rich.live import Live
        from rich.text import Text
        ascii_only = not unicode_shown()
        shown = console()
        with Keys() as pressed, Live(console=shown, screen=True, auto_refresh=False,
                                          vertical_overflow="crop") as live:
            before = None
            while not self.leave:
                now = self.lines(ascii_only)
                if now != before:
                    live.update(Text("\n").join(now), refresh=True)
                    before = now
                self.session.pump(TICK_S)
                for key in pressed.read():
                    self.press(key)
        return self.quit


def run(session):
    """Guide through a session; afterwards its lasting lines stand on the ordinary screen."""
    guide = Guide(session)
    try:
        return guide.run()
    except SixflipError:
        if session.ending.solved:   # the cable was pulled after the end: nothing is lost
            return False
        raise
    finally:
        for line in session.state.log:
            print(line)
