"""Raspberry Pi and other Linux computers: CPython, smbus2, a folder as flash.

The folder is ~/.sixflip/board, or SIXFLIP_BOARD_DIR; the host's lines are stdin and stdout.
Pins are out of reach while the kernel's driver owns the bus, and that driver runs its own
bus recovery, so there is no scl_pulse here. No LED and no button.
"""

import errno
import os
import select
import sys
import time

from .board import Board, LineReader


class Stopped(SystemExit):
    """The host asked for a reset: end the process, whoever started it starts it anew."""


def folder():
    """The folder that stands for the board's flash, made when missing, ending in "/"."""
    path = os.environ.get("SIXFLIP_BOARD_DIR")
    if not path:
        path = os.path.join(os.path.expanduser("~"), ".sixflip", "board")
    os.makedirs(path, exist_ok=True)
    return os.path.join(path, "")


def machine_id():
    """Twelve hexadecimal digits that stay the same on this computer."""
    for name in ("/sys/firmware/devicetree/base/serial-number", "/etc/machine-id"):
        try:
            with open(name) as f:
                text = f.read().strip("\0\n ")
        except OSError:
            continue
        if text:
            return text[-12:]
    return "000000000000"


class LinuxBoard(Board):
    """open_bus() -> an object with machine.I2C's method names; fd: where lines come from."""

    name = "raspberry_pi"

    def __init__(self, open_bus, root, fd=None, out=None):
        self._open_bus = open_bus
        self.root = root
        self.unique_id = machine_id()
        self._fd = sys.stdin.fileno() if fd is None else fd
        self._out = sys.stdout if out is None else out
        self._reader = LineReader()
        self._pending = b""
        self.i2c = open_bus()

    def reopen_i2c(self):
        """The same bus, closed and opened anew."""
        self.i2c.close()
        self.i2c = self._open_bus()
        return self.i2c

    def ticks_us(self):
        """Python's monotonic clock, µs; it does not wrap."""
        return time.monotonic_ns() // 1000

    def ticks_diff(self, a, b):
        """µs from b to a."""
        return a - b

    def sleep_us(self, us):
        """Waits so many µs, as exactly as Linux does."""
        time.sleep(us / 1e6)

    def read_line(self):
        """A whole line from the file descriptor, or None; after its end always None."""
        while True:
            while self._pending:
                ch = chr(self._pending[0])
                self._pending = self._pending[1:]
                line = self._reader.feed(ch)
                if line is not None:
                    return line
            if self._fd is None or not select.select([self._fd], [], [], 0)[0]:
                return None
            self._pending = os.read(self._fd, 4096)
            if not self._pending:  # end of file: nobody will write any more
                self._fd = None
                return None

    def write_line(self, text):
        """Sends a line to the host at once."""
        self._out.write(text + "\n")
        self._out.flush()

    def write_bytes(self, data):
        """Sends bytes to the host at once, without a newline."""
        self._out.buffer.write(data)
        self._out.flush()

    def reset(self):
        """Raises Stopped, which ends the process."""
        raise Stopped(0)


def open_spi(spi):
    """SPIBus over /dev/spidevBUS.CS; OSError saying what to do where there is none."""
    from .spi_bus import SPIBus, SpidevPort, values_of
    v = values_of(spi, {"bus": 0, "cs": 0})
    try:
        from spidev import SpiDev
    except ImportError:
        raise OSError(errno.ENODEV, "no spidev: pip install spidev") from None
    device = SpiDev()
    try:
        device.open(v["bus"], v["cs"])
    except OSError as e:
        raise OSError(e.errno, "/dev/spidev%d.%d cannot be opened (%s): switch SPI on "
                      "(raspi-config), or set spi in sixflip.json"
                      % (v["bus"], v["cs"], e.strerror)) from e
    device.mode = v["mode"]
    device.max_speed_hz = v["freq"]
    return SPIBus(SpidevPort(device), v["mode"])


def make(settings):
    """The Board, on its usual pins where the settings name no others."""
    if settings["spi"] is not None:
        return LinuxBoard(lambda: open_spi(settings["spi"]), folder())
    from smbus2 import SMBus

    from .smbus_i2c import SMBusI2C
    number = 1 if settings["i2c"] is None else settings["i2c"]

    def open_bus():
        try:
            return SMBusI2C(SMBus(number))
        except OSError as e:
            todo = ("add this user to its group: sudo usermod -aG i2c $USER, and log in anew"
                    if e.errno == errno.EACCES else
                    "switch I2C on (raspi-config), or set i2c in sixflip.json")
            raise OSError(e.errno, "I2C bus %d cannot be opened (%s); expected /dev/i2c-%d: %s"
                          % (number, e.strerror, number, todo)) from e

    return LinuxBoard(open_bus, folder())
