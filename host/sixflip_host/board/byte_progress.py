"""A progress bar over bytes; like progress.py only on a terminal and after a second."""

import sys
import time

from ..progress import PATIENCE_S, _Bar


class Bytes:
    """Context manager; at(done) moves the bar."""

    def __init__(self, what, total):
        self.what = what
        self.total = total
        self.started = time.monotonic()
        self.bar = None

    def __enter__(self):
        return self

    def at(self, done):
        if self.bar is None and sys.stderr.isatty() and (
                time.monotonic() - self.started > PATIENCE_S):
            self.bar = _Bar(self.what, self.total)
        if self.bar:
            self.bar.update(min(done, self.total))

    def __exit__(self, *error):
        if self.bar:
            self.bar.stop()
