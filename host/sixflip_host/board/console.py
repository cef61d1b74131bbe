"""Events of the firmware on a terminal: lines that stay, and one below that follows the state."""

import shutil
import sys
import textwrap
import threading

from ..terminal import plain
from .event_words import lasting, state_line


class Console:
    """Prints lasting lines, and on a terminal one line below that follows the live state.

    step(at): what to do for that placement of a plan; typed: what the person is typing
    """

    def __init__(self, stream=None, step=None):
        self.step = step
        self.typed = self.state = ""
        self.lock = threading.RLock()
        self.stream = sys.stdout if stream is None else stream
        self.live = self.stream.isatty()
        self.shown = ""

    def show(self, event):
        """One checked event."""
        with self.lock:
            if event["event"] == "state":
                self.show_state(event)
                return
            for line in lasting(event, self.step):
                self.last(line)

    def show_state(self, event):
        line = plain(state_line(event))
        if self.live:
            self.state = line
            self.redraw()
        elif event.get("reason"):
            # Not a terminal: only what keeps a pose from being taken, once each.
            kind = str(event["reason"])
            if kind != self.shown and kind not in ("moving", "noisy"):
                self.last("  " + line)
            self.shown = kind

    def echo(self, typed):
        """What is being typed; from another thread."""
        with self.lock:
            self.typed = plain(typed)
            self.redraw()

    def redraw(self):
        """The live line, cut to the width of the terminal: a wrapped one cannot be rewritten."""
        line = self.state + ("   > " + self.typed if self.typed else "")
        line = line[:max(20, shutil.get_terminal_size().columns - 1)]
        width = len(self.shown)
        self.shown = max(self.shown, line, key=len)  # what a Ctrl-C in the middle has to clear
        self.stream.write("\r" + line.ljust(width))
        self.stream.flush()
        self.shown = line

    def say(self, line):
        """A lasting line of the host's own."""
        with self.lock:
            self.last(plain(line))

    def last(self, line):
        """A line that stays; on a terminal it breaks between words."""
        self.clear()
        columns = shutil.get_terminal_size().columns
        if self.live and len(line) > columns:
            line = textwrap.fill(line, max(20, columns), subsequent_indent="  ",
                                 break_long_words=False, break_on_hyphens=False)
        # In one piece, unlike print: a Ctrl-C between text and newline would glue what is said of
        # it to half a line.
        self.stream.write(line + "\n")
        self.stream.flush()

    def clear(self):
        if self.live and self.shown:
            self.stream.write("\r" + " " * len(self.shown) + "\r")
        self.shown = ""
