"""What the firmware needs of a board. Everything comes through one of these, nothing else.

name, unique_id  texts; root is the prefix of file names, ending in "/" (or empty)
i2c              an object with machine.I2C's method names; reopen_i2c() makes a new one
led(on), button() -> bool, ticks_us(), ticks_diff(a, b), sleep_us(us)
read_line()      a whole line from the host without its newline, or None; never waits
write_line(text), write_bytes(data) as they are
scl_pulse()      one clock pulse by hand on SCL with SDA let go; None where pins are out of
                 reach. stop_condition() ends the recovery, then reopen_i2c() is called.
reset()          starts the board anew; may not return
"""

import sys
import time


class Board:
    """Defaults: a board without LED, button, host or pins, on the system's clock."""

    name = "board"
    unique_id = ""
    root = ""
    i2c = None
    scl_pulse = None

    def reopen_i2c(self):
        """A new bus object after the pins were driven by hand, kept as i2c too."""
        return self.i2c

    def stop_condition(self):
        """SDA rises while SCL is high, after the pulses; nothing where pins are out of reach."""
        pass

    def led(self, on):
        """Switches the LED; nothing without one."""
        pass

    def button(self):
        """Whether the button is pressed; False without one."""
        return False

    def ticks_us(self):
        """A clock in µs that may wrap around; only ticks_diff compares two of its readings."""
        return time.ticks_us()

    def ticks_diff(self, a, b):
        """µs from b to a, across a wrap."""
        return time.ticks_diff(a, b)

    def sleep_us(self, us):
        """Waits so many µs."""
        time.sleep_us(us)

    def read_line(self):
        """The host's next whole line without its newline, or None; never waits."""
        return

    def write_line(self, text):
        """Sends a line of text to the host."""
        print(text)

    def write_bytes(self, data):
        """Sends bytes to the host as they are."""
        sys.stdout.buffer.write(data)

    def reset(self):
        """Starts the board anew; a board that cannot goes on."""
        pass


class LineReader:
    """Collects characters into lines: feed(ch) -> a finished line or None.

    A line longer than limit is thrown away whole: the host never sends one, noise might.
    Control characters are passed over: they were meant for the REPL. A Ctrl-C among them came
    while the board started, before it was one for MicroPython: KeyboardInterrupt now.
    """

    def __init__(self, limit=512):
        self._limit = limit
        self._chars = []
        self._overlong = False

    def feed(self, ch):
        """The line that this character ends, or None."""
        if ch == "\n" or ch == "\r":
            line = None if self._overlong or not self._chars else "".join(self._chars)
            self._chars = []
            self._overlong = False
            return line
        if ch == "\x03":
            raise KeyboardInterrupt
        if ch < " ":
            return None
        if len(self._chars) >= self._limit:
            self._overlong = True
            self._chars = []
        if not self._overlong:
            self._chars.append(ch)
        return None
