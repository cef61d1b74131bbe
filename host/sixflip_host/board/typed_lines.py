"""What a person types while a calibration runs: redo X+, undo, quit.

The terminal is taken out of its line mode, so that what is typed and the live state can share
the last line; a thread of its own reads it, and Ctrl-C stays Ctrl-C.
"""

import os
import queue
import select
import sys
import threading

from sixflip.poses.faces import FACES

try:
    import termios
    import tty
except ImportError:  # Windows: the command is followed, nothing can be typed
    termios = None

HELP = "typed lines: redo FACE, undo, quit"
LONGEST = 40


def command(line):
    """The firmware's command for a typed line; ValueError says what was expected."""
    words = line.split()
    if words[:1] == ["redo"] and len(words) == 2 and words[1].upper() in FACES:
        return {"cmd": "redo", "face": words[1].upper()}
    if words in (["undo"], ["u"]):
        return {"cmd": "undo"}
    if words in (["quit"], ["q"], ["stop"]):
        return {"cmd": "stop"}
    raise ValueError("%r: expected redo and a face (%s), undo, or quit" % (line, " ".join(FACES)))


class TypedLines:
    """Context manager. lines: a queue of what was typed; echo(text) shows the line so far."""

    def __init__(self, echo, stream=None):
        self.stream = sys.stdin if stream is None else stream
        self.echo = echo
        self.lines = queue.SimpleQueue()
        self.text = ""
        self.before = None
        self.thread = None
        self.over = threading.Event()

    def __enter__(self):
        if termios and self.stream is not None and self.stream.isatty():
            descriptor = self.stream.fileno()
            self.before = termios.tcgetattr(descriptor)
            tty.setcbreak(descriptor)
            self.thread = threading.Thread(target=self.read, args=(descriptor,), daemon=True)
            self.thread.start()
        return self

    def __exit__(self, *error):
        self.over.set()
        if self.thread:
            self.thread.join()
            termios.tcsetattr(self.stream.fileno(), termios.TCSADRAIN, self.before)

    @property
    def live(self):
        return self.thread is not None

    def read(self, descriptor):
        while not self.over.is_set():
            try:
                if not select.select([descriptor], [], [], 0.1)[0]:
                    continue
                data = os.read(descriptor, 256)
            except OSError:
                return
            if not data:
                return
            for letter in data.decode("ascii", "ignore"):
                self.take(letter)
            self.echo(self.text)

    def take(self, letter):
        if letter in "\r\n":
            if self.text.strip():
                self.lines.put(self.text.strip())
            self.text = ""
        elif letter in "\x7f\b":
            self.text = self.text[:-1]
        elif letter.isprintable() and len(self.text) < LONGEST:
            self.text += letter

    def poll(self):
        """The next line, None when there is none."""
        try:
            return self.lines.get_nowait()
        except queue.Empty:
            return None
