"""A serial port read in large pieces and never waited for without end."""

import time

import serial


class Endless(serial.SerialException):
    """A port that went on talking longer, or said more, than it may."""


class BufferedSerial:
    """What mpremote's SerialTransport uses of pyserial, on top of a pyserial port.

    timeout   seconds that read() waits for its bytes
    deadline  time.monotonic() after which reading raises Endless, None: no limit
    most      bytes after which it does, None: no limit
    """

    PIECE = 4096
    LONGEST_LINE = 1 << 16

    def __init__(self, port, timeout=5.0):
        self.port = port
        self.timeout = timeout
        self.deadline = self.most = None
        self.buffer = bytearray()
        port.write_timeout = 5.0

    def inWaiting(self):  # noqa: N802  the name mpremote calls
        self.limits()
        return len(self.buffer) + self.port.in_waiting

    def read(self, n=1):
        """n bytes, or fewer when they did not come in time."""
        end = time.monotonic() + self.timeout
        self.limits()
        while len(self.buffer) < n:
            left = end - time.monotonic()
            if left <= 0:
                break
            self.fill(min(left, 0.5))
        taken = bytes(self.buffer[:n])
        del self.buffer[:n]
        if self.most is not None:
            self.most -= len(taken)
        return taken

    def limits(self):
        """Raises Endless where a port that goes on talking has had its time, or its share."""
        if self.deadline is not None and time.monotonic() > self.deadline:
            raise Endless("its answer did not come to an end in time")
        if self.most is not None and self.most < 0:
            raise Endless("its answer is too long")

    def fill(self, wait):
        """Take in what is there, waiting up to `wait` seconds for the first byte."""
        if self.port.timeout != wait:
            self.port.timeout = wait
        waiting = self.port.in_waiting
        self.buffer += self.port.read(min(waiting, self.PIECE) if waiting else 1)

    def read_line(self, wait):
        """The next line without its end, or None when no whole one came in `wait` seconds."""
        end = time.monotonic() + wait
        while True:
            line, newline, rest = self.buffer.partition(b"\n")
            if newline:
                self.buffer = rest
                return bytes(line.rstrip(b"\r"))
            if len(self.buffer) > self.LONGEST_LINE:
                self.buffer.clear()     # no line of the firmware's: noise, or another program
            left = end - time.monotonic()
            if left <= 0:
                return None
            self.fill(min(left, 0.2))

    def write(self, data):
        return self.port.write(data)

    def close(self):
        self.port.close()

    def __getattr__(self, name):
        return getattr(self.port, name)

    def __setattr__(self, name, value):
        if name in ("rts", "dtr"):
            setattr(self.port, name, value)
        else:
            object.__setattr__(self, name, value)
