"""A board at the end of a serial cable. The only module that knows mpremote.

mpremote calls its Python interface unstable and waits for ever on a silent port, so it is
pinned, used here alone, and every wait has an end.
"""

import base64
import contextlib
import hashlib
import os
import struct
import time
from pathlib import PurePosixPath

import serial
from mpremote import transport_serial
from mpremote.transport import TransportError, TransportExecError
from mpremote.transport_serial import SerialTransport

from ..errors import NoBoard, SixflipError, UsageError
from ..narration import log
from . import serial_ports
from .board_answers import NoSpace, board_error, parse, short
from .board_schema import ANSWERS
from .buffered_serial import BufferedSerial, Endless
from .on_board_scripts import STAGED, UPDATE, script

ANSWER_S = 10.0  # of silence; a board hashes 100 KB in about two seconds
FILES_S = 60.0  # of silence while it hashes every file it has, or moves them
WHOLE_S = 60.0  # of an answer from first to last byte, however it drips: all but a file
LONGEST_S = 300.0  # a full flash read through a UART at 115200 Bd takes two minutes
SLOWEST = 2000  # bytes of a file a second, of which a UART at 115200 Bd carries four times as many
OUTPUT = 1 << 17  # bytes of an answer; a listing of the firmware has 20 KB
LONGEST_FILE = 1 << 25  # the same for a file in base64: no board's flash is larger
HANDSHAKE_S = 5.0
KNOCK_S, LONGEST_KNOCK_S = 0.3, 5.0  # from one Ctrl-C to the next, while nothing answers
RAW_REPL = b"raw REPL; CTRL-B to exit\r\n>"
ATTEMPTS = 2
REOPEN_S = 15.0  # a USB port comes back after a reset
CHUNK = 1024
PATIENCE = "SIXFLIP_PATIENCE"
BASE64 = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=\r\n\x04"
LOST = (serial.SerialException, serial.SerialTimeoutException, OSError, TransportError,
        struct.error)  # of mpremote: an answer of two bytes was cut short
# mpremote prints what a board said in place of a raw REPL. Its module gets a print of its own:
# sys.stdout is everybody's, and boards are linked to from several threads.
transport_serial.print = lambda *words, **more: None


def safe_name(name):
    """True for a relative name below the folder it is kept in; names from boards are untrusted."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts and not (
        set(name) & set("\\:\0\r\n"))


def patience_of(text):
    """The number that SIXFLIP_PATIENCE holds, 1 without; UsageError for anything else."""
    try:
        value = float(text or 1)
    except ValueError:
        value = 0
    if not 1 <= value <= 1000:
        raise UsageError("%s=%s: expected a number from 1 to 1000" % (PATIENCE, text))
    return value


class MpremoteLink:
    """Link over a serial port, opened for this process alone.

    patience  every time-out is so many times longer, for a board that is emulated; without it
              what SIXFLIP_PATIENCE says

    Every method raises NoBoard when the board goes away or does not answer.
    """

    def __init__(self, port, patience=None):
        self.port = port
        self.patience = patience or patience_of(os.environ.get(PATIENCE))
        self.identity = serial_ports.identity(port)
        self.transport = None
        self.raw = False
        self.open()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def open(self):
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
                out, error = transport.exec_raw(code, (timeout or ANSWER_S) * self.patience,
                                                consumer)
            finally:
                wire.deadline = wire.most = None
            if error:
                raise TransportExecError(out, error.decode("utf-8", "replace"))
            return out

    def version(self):
        """(MicroPython's version, what the board calls itself), as text."""
        out = self.run("import os\ntry:\n u = os.uname()\n print((u[3], u[4]))\nexcept "
                       "AttributeError:\n import sys\n print((sys.version, sys.platform))\n",
                       "asking for its version")
        return parse(self.port, out, ANSWERS["version"])

    def platform(self):
        """sys.platform of the board: rp2, esp32, pyboard, linux …"""
        return parse(self.port, self.run("import sys\nprint(repr(sys.platform))",
                                         "asking for its version"), ANSWERS["platform"])

    def mpy(self):
        """sys.implementation._mpy: format and architecture of the .mpy files it loads, or None."""
        return parse(self.port, self.run(
            "import sys\nprint(repr(getattr(sys.implementation, '_mpy', None)))",
            "asking for its version"), ANSWERS["mpy"])

    def board_id(self):
        """machine.unique_id() in hex; "board" where the port has none."""
        out = self.run("import binascii\ntry:\n import machine\n print(binascii.hexlify("
                       "machine.unique_id()).decode())\nexcept (ImportError, AttributeError):\n"
                       " print()\n", "asking for its id").decode("ascii", "replace").strip()
        return "".join(c for c in out if c in "0123456789abcdef")[:32] or "board"

    # -- files

    def files(self, hashed=None, alone=False):
        """{name: (size, sha256 in hex)} of all files; with `hashed` only those are hashed.

        alone: list only those, and each has to be there.
        """
        wanted = None if hashed is None else set(hashed)
        out = self.run(script("list_files", wanted=wanted, staged=STAGED, alone=alone),
                       "listing its files", timeout=FILES_S)
        found = {}
        for line in out.splitlines():
            name, size, digest = parse(self.port, line, ANSWERS["file"])
            if safe_name(name):
                found[name] = (size, digest)
        missing = set(wanted or ()) - set(found) if alone else ()
        if missing:
            raise NoBoard("%s: the board says nothing of %s, expected its size and hash"
                          % (self.port, ", ".join(sorted(missing))))
        return found

    def get(self, name, progress=None, size=None):
        """The bytes of a file. progress(done bytes) is called on the way; size: where it is
        known, so that no file takes longer than so many bytes may."""
        text = bytearray()

        def take(piece):
            if piece not in BASE64:
                self.raw = False
                raise NoBoard("%s: %s arrived damaged; try again" % (self.port, name))
            text.extend(piece.replace(b"\x04", b""))
            if progress and piece == b"\n":
                progress(len(text) * 3 // 4)

        whole = LONGEST_S if size is None else min(LONGEST_S, WHOLE_S + size / SLOWEST)
        self.run(script("send_file", name=name), "reading " + name, take, most=LONGEST_FILE,
                 whole=whole)
        try:
            data = base64.b64decode(bytes(text).replace(b"\r", b"").replace(b"\n", b""),
                                    validate=True)
        except ValueError:
            raise NoBoard("%s: %s arrived damaged; try again" % (self.port, name)) from None
        size, digest = self.files([name], alone=True)[name]
        if len(data) != size or hashlib.sha256(data).hexdigest() != digest:
            raise NoBoard("%s: %s arrived damaged; try again" % (self.port, name))
        return data

    def put(self, name, data, progress=None):
        """Write NAME.new, compare its hash on the board, then rename it to NAME."""
        self.write(name + ".new", name, data, progress)
        self.run(script("replace_file", name=name), "copying " + name)

    def stage(self, name, data, progress=None):
        """Write NAME below STAGED, where it waits for commit()."""
        self.write(STAGED + name, name, data, progress)

    def commit(self, names, stale=()):
        """Every file that was staged takes its place, and the stale files go: all or nothing,
        even if the power fails meanwhile, for main.py goes on with it at the next power-up."""
        self.put(UPDATE, script("put_in_place", names=names, stale=list(stale),
                                staged=STAGED).encode())
        self.finish()

    def finish(self):
        """Go on with a commit that was cut off."""
        self.run("exec(open(%r).read())" % UPDATE, "putting the files in their places",
                 timeout=FILES_S)

    def write(self, fresh, name, data, progress=None):
        """Write the file `fresh`, for NAME, and compare its hash on the board."""
        doing = "copying " + name
        parents = [str(p) for p in reversed(PurePosixPath(fresh).parents) if str(p) != "."]
        if parents:
            self.run(script("make_folders", folders=parents), doing)
        try:
            self.run("f = open(%r, 'wb')\nw = f.write" % fresh, doing)
            for start in range(0, len(data), CHUNK):
                self.run("w(%r)" % data[start:start + CHUNK], doing)
                if progress:
                    progress(min(start + CHUNK, len(data)))
            self.run("f.close()", doing)
        except NoSpace:
            with contextlib.suppress(SixflipError):
                self.run("f.close()", doing)
            with contextlib.suppress(SixflipError):
                self.remove(fresh)
            raise
        if self.files([fresh], alone=True)[fresh][1] != hashlib.sha256(data).hexdigest():
            self.remove(fresh)
            raise NoBoard("%s: %s arrived damaged on the board; the old one is still in force, "
                          "try again" % (self.port, name))

    def remove(self, name):
        self.run("import os\nos.remove(%r)" % name, "removing " + name)

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
