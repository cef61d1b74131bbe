"""One clock for two processes: microseconds in a file that both have mapped.

Each waits while the other moves it, so there is nothing to lock: the firmware's process in its
ioctl, the simulated bus between two of them.
"""

import mmap
import struct
import time


class SharedTime:
    """path: a file of eight bytes."""

    def __init__(self, path):
        with open(path, "r+b") as file:
            self._bytes = mmap.mmap(file.fileno(), 8)

    def us(self):
        return struct.unpack("Q", self._bytes[:8])[0]

    def set(self, us):
        self._bytes[:8] = struct.pack("Q", us)


class RealTime:
    """This computer's, for a process that keeps to it; in SharedTime's place."""

    def __init__(self):
        self._start = time.monotonic_ns()

    def us(self):
        return (time.monotonic_ns() - self._start) // 1000

    def set(self, us):
        """It goes on by itself."""
