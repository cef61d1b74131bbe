"""A serial port with a board of our own making behind it, and a clock that stands still meanwhile.

The board answers MicroPython's raw REPL as far as mpremote and our scripts use it, and speaks as
the firmware does. Everything it says goes through `attack` first. Time passes when somebody
waits for it, and a little with every byte.
"""

import base64
import collections
import contextlib
import hashlib
import io
import itertools
import json
import re
import time

import serial

from sixflip_host.board.on_board_scripts import STAGED
from tests.faults.real_dialogue import ASKED, dialogue

BYTE_S = 1e-4           # ten bits at 100 kBd
ENOUGH = 4096           # bytes that a port says are waiting
WRITTEN = re.compile(rb"f = open\((.+), 'wb'\)")
PIECE = re.compile(rb"w\((.*)\)", re.S)
BUS = b"""('settings', 'pico', 'auto', 'I2C at 400 kHz', [])
('lines', 'GPIO4', 'GPIO5', 1, 1, 1, 1)
('scan', [104])
('ids', {(104, 117): b'h', (104, 0): b'\\x80', (83, 0): 5})
('sensor', 'mpu6050', 'MPU6050 (0x68)', (104, 104), 2, 16384, 65.5, ['0x68: MPU6050'])
('ready', 'MPU6050', 100, 500000, 200, 900)
('selftest', True, [], 100.0, 100, True, 25.0, 0)
('means', 50, [0, 0, 819200, 0, 0, 0, 0])
"""


class HonestAttack:
    """Changes nothing. said(name, bytes, at) -> [(second, bytes)] of what goes over the wire."""

    tail = None

    def said(self, name, data, at):
        return [(at, data)]


class Instead(HonestAttack):
    """words: {name: what is said in the place of that answer or event, once for each}."""

    def __init__(self, **words):
        self.words = words

    def said(self, name, data, at):
        return [(at, self.words.get(name, data))]


class Dripping(HonestAttack):
    """From one answer or event on these bytes and no other, for ever, one piece every so often."""

    def __init__(self, name, pieces, step_s):
        self.name, self.pieces, self.step_s = name, pieces, step_s

    def said(self, name, data, at):
        if self.tail is None and name == self.name:
            self.tail = ((at + self.step_s * k, self.pieces[k % len(self.pieces)])
                         for k in itertools.count())
        return [] if self.tail else [(at, data)]


class HostileBoard:
    """recorded: whether its flash holds a record; provisioned: whether the firmware is there."""

    def __init__(self, attack=None, recorded=True):
        self.attack = attack or HonestAttack()
        self.now = 0.0
        self.wire = collections.deque()     # (second, bytes) still to come
        self.typed = b""
        self.mode = "firmware"
        files = dialogue().files
        self.files = dict(files) if recorded else {"sixflip.json": files["sixflip.json"]}
        self.files["main.py"] = b"x"
        self.files["sixflip_device/power_up.py"] = b"x"
        self.open_name = None
        self.stream = self.feed = None
        self.start()

    # -- time and wire

    def tell(self, name, data, after=0.0):
        last = max(self.now, self.wire[-1][0] if self.wire else 0.0)
        self.wire += [piece for piece in self.attack.said(name, data, last + after) if piece[1]]

    def event(self, event, after=0.02):
        self.tell(event["event"], json.dumps(event).encode() + b"\r\n", after)

    def ready(self):
        """Bytes that have arrived by now, out of what the firmware says by itself too."""
        while self.attack.tail and (not self.wire or self.wire[-1][0] <= self.now):
            self.wire.append(next(self.attack.tail))
        if not self.attack.tail and self.mode == "firmware" and (
                not self.wire or self.wire[-1][0] <= self.now):
            self.event(*next(self.feed))
        count = 0
        for at, data in self.wire:
            if at > self.now or count >= ENOUGH:
                break
            count += len(data)
        return count

    def take(self, n, wait):
        end = self.now + wait
        while not self.ready():
            following = self.wire[0][0] if self.wire else end
            if following >= end:
                self.now = end
                return b""
            self.now = max(self.now, following)
        out = b""
        while self.wire and len(out) < n and self.wire[0][0] <= self.now:
            at, data = self.wire[0]
            piece, rest = data[:n - len(out)], data[n - len(out):]
            out += piece
            self.wire.popleft()
            if rest:
                self.wire.appendleft((at, rest))
        self.now += BYTE_S * len(out)
        return out

    # -- what the host sends

    def hear(self, data):
        for letter in data:
            self.letter(bytes([letter]))

    def letter(self, letter):
        if letter == b"\x03":
            self.mode, self.typed = "friendly", b""
            self.wire.clear()
        elif letter == b"\x01" and not self.typed.startswith(b"\x05A"):
            self.mode, self.typed = "raw", b""
            self.tell("prompt", b"raw REPL; CTRL-B to exit\r\n>")
        elif letter == b"\x02" and self.mode == "raw":
            self.mode = "friendly"
        elif letter == b"\x04":
            self.end_of_text()
        elif self.mode == "firmware" and letter == b"\n":
            line, self.typed = self.typed, b""
            self.obey(line)
        else:
            self.typed += letter
            if self.mode == "raw" and self.typed == b"\x05A\x01":
                self.typed = b""
                self.tell("paste", b"R\x00")

    def end_of_text(self):
        code, self.typed = self.typed, b""
        if self.mode == "friendly":
            self.wire.clear()
            self.start()
        elif not code.strip():
            self.tell("reboot", b"OK\r\nMPY: soft reboot\r\nraw REPL; CTRL-B to exit\r\n>")
        elif code.endswith(b"machine.reset()"):
            self.tell("ok", b"OK")
            self.start()
        else:
            name, out, error = self.execute(code)
            self.tell("ok", b"OK")
            self.tell(name, out)
            self.tell("end", b"\x04" + error + b"\x04>")

    def execute(self, code):
        """(name, stdout, stderr) of our scripts."""
        try:
            return (*self.ran(code), b"")
        except KeyError:
            return "error", b"", b"OSError: [Errno 2] ENOENT\r\n"

    def ran(self, code):
        if PIECE.match(code):
            self.files[self.open_name] += eval(PIECE.match(code).group(1))
            return "nothing", b""
        if b"os.ilistdir" in code:
            return "files", self.listing(code)
        if b"b2a_base64" in code:
            name = eval(re.search(rb"name = (.+)\n", code).group(1))
            return name, b"".join(base64.encodebytes(self.files[name][i:i + 57])
                                  for i in range(0, len(self.files[name]), 57))
        if b"os.uname" in code:
            return "version", b"('v1.22.0 on 2023-12-27', 'Raspberry Pi Pico with RP2040')\r\n"
        if b"'_mpy'" in code:
            return "mpy", b"4102\r\n"
        if b"repr(sys.platform)" in code:
            return "platform", b"'rp2'\r\n"
        if b"unique_id" in code:
            return "id", b"0011223344556677\r\n"
        if b"look" in code and b"board_here" in code:
            return "bus", BUS
        if WRITTEN.search(code):
            self.open_name = eval(WRITTEN.search(code).group(1))
            self.files[self.open_name] = b""
        elif b"os.rename(name" in code and b"names = " not in code:
            name = eval(re.search(rb"name = (.+)\n", code).group(1))
            self.files[name] = self.files.pop(name + ".new")
        elif b"exec(open" in code:
            for name in [name for name in self.files if name.startswith(STAGED)]:
                self.files[name[len(STAGED):]] = self.files.pop(name)
            self.files.pop("sixflip_update.py", None)
        elif b"os.remove(" in code:
            del self.files[eval(re.search(rb"os.remove\((.+)\)", code).group(1))]
        return "nothing", b""

    def listing(self, code):
        wanted = eval(re.search(rb"wanted = (.+)\n", code).group(1))
        alone = b"alone = True" in code
        out = b""
        for name in wanted if alone else list(self.files):
            digest = hashlib.sha256(self.files[name]).hexdigest()
            hashed = wanted is None or {name, name.removeprefix(STAGED)} & wanted
            out += b"%r\r\n" % ((name, len(self.files[name]), digest if hashed else None),)
        return out

    # -- the firmware

    def start(self):
        self.mode, self.typed = "firmware", b""
        known = dialogue()
        asked = self.files.pop("calibrate.flag", None)
        self.files.pop("offered.bin", None)
        begun = known.calibrated if asked is not None or "record_a.bin" not in self.files \
            else known.started
        self.stream = None
        self.feed = self.says([(event, 0.02) for event in begun])

    def says(self, events):
        yield from events
        while True:
            for sample in dialogue().samples[self.stream or "corrected"]:
                yield sample, 0.05

    def obey(self, line):
        if not line.strip() or not self.feed:
            return
        command = json.loads(line)
        known = dialogue()
        name = command["cmd"]
        if name == "stream":
            name = self.stream = next((n for n in ("raw", "heading") if command.get(n)),
                                      "corrected")
            self.event(dict(known.answers[name], hz=command.get("hz", 20)))
        elif name in ASKED:
            self.event(known.answers[name])
        elif name == "stop":
            self.event({"event": "capture", "samples": 900, "bytes": 9000, "sums_only": False})
            self.event({"event": "stopped"})


class HostilePort:
    """What mpremote and BufferedSerial use of pyserial."""

    def __init__(self, board):
        self.board, self.timeout, self.write_timeout = board, 1.0, 5.0
        self.rts = self.dtr = True

    @property
    def in_waiting(self):
        return self.board.ready()

    def read(self, n=1):
        return self.board.take(n, self.timeout)

    def write(self, data):
        self.board.now += BYTE_S * len(data)
        self.board.hear(data)
        return len(data)

    def isOpen(self):       # noqa: N802  pyserial's name
        return True

    def close(self):
        """It stays there."""


@contextlib.contextmanager
def plugged_in(board):
    """While it lasts every port is this board's, and time is its own."""
    before = serial.serial_for_url, time.monotonic, time.sleep

    def sleep(seconds):
        board.now += seconds
    serial.serial_for_url = lambda *words, **more: HostilePort(board)
    time.monotonic, time.sleep = (lambda: board.now), sleep
    try:
        yield
    finally:
        serial.serial_for_url, time.monotonic, time.sleep = before


def run(board, *words):
    """(exit code, stdout, stderr) of a verb at this board."""
    from sixflip_host import cli
    out, error = io.StringIO(), io.StringIO()
    with plugged_in(board), contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        code = cli.main([str(word) for word in words] + (
            [] if words[0] == "history" else ["--port", "hostile://"]))
    return code, out.getvalue(), error.getvalue()
