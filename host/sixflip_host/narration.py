"""--verbose: what is being done at the moment, a line each on stderr with the seconds so far."""

import contextlib
import logging
import sys
import time

from .terminal import plain

log = logging.getLogger("sixflip")


class _Lines(logging.Formatter):
    """What files and boards say of themselves must not steer the terminal here either."""

    def __init__(self):
        super().__init__()
        self.start = time.monotonic()

    def format(self, record):
        return "sixflip: %6.2f s  %s" % (time.monotonic() - self.start, plain(record.getMessage()))


@contextlib.contextmanager
def narrated(wanted):
    """While it lasts log.info() is seen, if it is wanted."""
    if not wanted:
        yield
        return
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_Lines())
    before = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        yield
    finally:
        log.setLevel(before)
        log.removeHandler(handler)
