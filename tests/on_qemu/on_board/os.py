"""The port's os, and the urandom that boards have and the port has not."""

from uos import *  # noqa: F403


def urandom(n):
    """Always the same: two runs of a session are to leave the same record."""
    return bytes(range(1, n + 1))
