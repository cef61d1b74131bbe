"""The raw REPL of a board at the end of a serial cable, and the lines of what runs on it. The only
module that knows mpremote.

mpremote calls its Python interface unstable and waits for ever on a silent port, so it is
pinned, used here alone, and every wait has an end.
"""

import contextlib
import os
import struct
import time

import serial
from mpremote import transport_serial
from mpremote.transport import TransportError, TransportExecError
from mpremote.transport_serial import SerialTransport

from ..errors import NoBoard, UsageError
from ..narration import log
from . import serial_ports
from .board_answers import board_error, short
from .buffered_serial import BufferedSerial, Endless

ANSWER_S = 10.0  # of silence; a board hashes 100 KB in about two seconds
WHOLE_S = 60.0  # of an answer from first to last byte, however it drips: all but a file
OUTPUT = 1 << 17  # bytes of an answer; a listing of the firmware has 20 KB
HANDSHAKE_S = 5.0
KNOCK_S, LONGEST_KNOCK_S = 0.3, 5.0  # from one Ctrl-C to the next, while nothing answers
RAW_REPL = b"raw REPL; CTRL-B to exit\r\n>"
ATTEMPTS = 2
REOPEN_S = 15.0  # a USB port comes back after a reset
PATIENCE = "SIXFLIP_PATIENCE"
LOST = (serial.SerialException, serial.SerialTimeoutException, OSError, TransportError,
        struct.error)  # of mpremote: an answer of two bytes was cut short
# mpremote prints what a board said in place of a raw REPL. Its module gets a print of its own:
# sys.stdout is everybody's, and boards are linked to from several threads.
transport_serial.print = lambda *words, **more: None


def patience_asked():
    """The number that SIXFLIP_PATIENCE holds, 1 without; UsageError for anything else."""
    text = os.environ.get(PATIENCE)
    try:
        value = float(text or 1)
    except ValueError:
        value = 0
    if not 1 <= value <= 1000:
        raise UsageError("%s=%s: expected a number from 1 to 1000" % (PATIENCE, text))
    return value


class RawRepl:
    """Code run on the board at a serial port, and its firmware's lines; opened for this process
    alone.

    patience  every time-out is so many times longer, for a board that is emulated; without it
              what SIXFLIP_PATIENCE says

    Every method raises NoBoard when the board goes away or does not answer.
    """

    def __init__(self, port, patience=None):
        self.port = port
        self.patience = patience or patience_asked()
        self.identity = serial_ports.identity(port)
        self.transport = None
        self.raw = False
        self.open()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def open(self):
        """Open the port; NoBoard saying why not."""
        log.info("opening %s", self.port)
        try:
            transport = SerialTransport(self.port, baudrate=115200, exclusive=True, timeout=1.0)
        except (TransportError, serial.SerialException, OSError, ValueError):
            raise NoBoard(serial_ports.why_not(self.port)) from None
        transport.serial = BufferedSerial(transport.serial)
        transport.is_pty = True  # read with a time-out instead of asking and sleeping
        self.transport = transport
        self.raw = False

    def close(self):
        """Leave the raw REPL, if it was entered, and close the port; never an error."""
        transport, self.transport = self.transport, None
        if transport:
            with contextlib.suppress(*LOST):
                if self.raw:
                    transport.exit_raw_repl()
            with contextlib.suppress(*LOST):
                transport.close()

    @contextlib.contextmanager
    def guarded(self, doing):
        """Turn every way of losing a board into one line that says what was being done."""
        try:
            if self.transport is None:
                raise NoBoard("%s: the link is closed" % self.port)
            yield self.transport
        except TransportExecError as error:
            raise board_error(self.port, doing, error) from None
        except LOST as error:
            self.raw = False
            raise NoBoard("%s: the board went away while %s (%s)"
                          % (self.port, doing, short(error))) from None

    # -- running code

    def enter(self):
        """Stop what runs and enter the raw REPL; NoBoard when that has no effect in time.

        Tried twice: what is said meanwhile may arrive damaged.
        """
        for _ in range(ATTEMPTS):
            if not self.raw:
                self.raw = self.handshake()
        if not self.raw:
            raise NoBoard("%s does not answer as a MicroPython board does: expected a raw REPL "
                          "within %d s; is MicroPython on it, and no other program on the port?"
                          % (self.port, HANDSHAKE_S))

    def handshake(self):
        """One attempt at the raw REPL: whether it was entered."""
        with self.guarded("connecting") as transport:
            wire = transport.serial
            allowed = HANDSHAKE_S * self.patience
            if not self.knock(transport, allowed):
                return False
            wire.deadline = time.monotonic() + allowed
            # mpremote takes ten silent seconds for the end, unless a single read waits longer
            wire.timeout = 0.5 if self.patience == 1 else allowed
            try:
                transport.enter_raw_repl(soft_reset=True, timeout_overall=allowed)
            except (TransportError, Endless):
                return False
            finally:
                wire.timeout, wire.deadline = ANSWER_S * self.patience, None
        return True

    def knock(self, transport, allowed):
        """Ctrl-C at short intervals until the REPL answers; one that comes while a board starts,
        or resets, is lost. False when it does not within so many seconds."""
        wire = transport.serial
        end = time.monotonic() + allowed
        wait = KNOCK_S
        try:
            while (now := time.monotonic()) < end:
                wire.timeout = min(wait, end - now)
                wire.deadline = now + wire.timeout
                wire.write(b"\r\x03\r\x01")
                with contextlib.suppress(Endless):
                    if transport.read_until(1, RAW_REPL, timeout=wait).endswith(RAW_REPL):
                        return True
                wait = min(1.5 * wait, LONGEST_KNOCK_S)
            return False
        finally:
            wire.timeout, wire.deadline = ANSWER_S * self.patience, None

    def run(self, code, doing, consumer=None, timeout=None, most=OUTPUT, whole=WHOLE_S):
        """Run code on the board; returns what it printed, as bytes.

        timeout: seconds of silence; whole: seconds for all of it. A port that says more than
        `most` bytes is no board that runs this code.
        """
        log.info("%s: %s", self.port, doing)
        self.enter()
        with self.guarded(doing) as transport:
            wire = transport.serial
            wire.deadline, wire.most = time.monotonic() + whole * self.patience, most
            try:
                printed, error = transport.exec_raw(code, (timeout or ANSWER_S) * self.patience,
                                                    consumer)
            finally:
                wire.deadline = wire.most = None
            if error:
                raise TransportExecError(printed, error.decode("utf-8", "replace"))
            return printed

    # -- the running firmware

    def reset(self):
        """Hard reset, as after power-up: boot.py and main.py run."""
        log.info("%s: reset", self.port)
        self.enter()
        with self.guarded("resetting") as transport:
            wire = transport.serial
            wire.deadline = time.monotonic() + ANSWER_S * self.patience
            try:
                transport.exec_raw_no_follow(
                    "import time, machine\ntime.sleep_ms(100)\nmachine.reset()")
            finally:
                wire.deadline = None
        self.raw = False

    def restart_firmware(self):
        """Soft reset: main.py runs again and a USB port stays open, so that no line is lost."""
        self.enter()
        with self.guarded("restarting") as transport:
            transport.exit_raw_repl()
            transport.serial.write(b"\x04")
        self.raw = False

    def lines(self, timeout):
        """Text lines from the running firmware, until none came for `timeout` seconds."""
        for line in self.raw_lines(timeout):
            yield line.decode("utf-8", "replace")

    def raw_lines(self, timeout):
        """The same as bytes: what a line holds may be a binary frame.

        A port that vanishes, as USB does in a reset, is opened again when it comes back.
        """
        end = None
        while True:
            try:
                with self.guarded("listening") as transport:
                    line = transport.serial.read_line(timeout * self.patience)
            except NoBoard:
                end = end or time.monotonic() + REOPEN_S    # it may open and fail, over and over
                self.reopen(end)
                continue
            if line is None:
                return
            end = None
            yield line

    def reopen(self, end):
        """Open the port of the same device, under whatever name it comes back, until
        time.monotonic() is `end`."""
        self.raw = False
        self.close()
        while True:
            self.port = serial_ports.same_device(self.identity, self.port)
            if time.monotonic() > end:
                raise NoBoard("%s: the board went away and did not come back within %d s"
                              % (self.port, REOPEN_S))
            time.sleep(0.1)
            with contextlib.suppress(NoBoard):
                return self.open()

    def send(self, line):
        """A line to the running firmware."""
        with self.guarded("sending") as transport:
            transport.serial.write(line.encode() + b"\n")
