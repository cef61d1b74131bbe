"""What can happen to a board on a cable while a verb of the host works on it: the power fails at
any block operation of its flash, bytes are damaged, lost, cut off or added on the way."""

import contextlib
import io
import json
import random
import shutil

from sixflip.capture import reader as capture_reader
from sixflip.capture.writer import BlockWriter
from sixflip.record import correction_record
from sixflip_host import cli
from sixflip_host.board import board_link, firmware_update, raw_repl
from sixflip_host.board.board_events import events
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.errors import SixflipError
from sixflip_host.verbs import calibrate
from sixflip_host.virtual.virtual_board import VirtualBoard
from sixflip_sim import worlds
from tests.faults import storm

STILL = {"sensor": "mpu6050", "seed": 3, "order": []}
# The second version has a folder where the first one had a module.
PARTS = {1: ("sixflip_device/power_up.py", "sixflip_device/a.py", "sixflip/b.py"),
         2: ("sixflip_device/power_up.py", "sixflip_device/a.py", "sixflip/b/core.py")}
IMPORT = {1: "from sixflip import b", 2: "from sixflip.b import core as b"}
SESSION = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0}
POSES = tuple(face + letter for face in ("Z+", "Z-", "X+", "X-", "Y+", "Y-") for letter in "ab")
# What is heard when the cable is pulled out of a board that calibrates.
CALIBRATING = tuple('"event": "%s"' % name for name in (
    "hello", "selftest", "grace", "calibrating")) + tuple(
    '"event": "pose", "pose": "%s"' % pose for pose in POSES) + tuple(
    '"event": "%s"' % name for name in ("capture", "solved", "saved", "ready"))
ENDS = (0, 1, 3, 4)     # exit codes of errors in one line
QUICK = {"ANSWER_S": (raw_repl, 2.0), "FILES_S": (board_link, 5.0), "HANDSHAKE_S": (raw_repl, 3.0),
         "REOPEN_S": (raw_repl, 3.0)}


@contextlib.contextmanager
def impatient():
    """The link's time-outs for a board that runs as fast as the processor."""
    before = {name: getattr(module, name) for name, (module, _) in QUICK.items()}
    silence, calibrate.SILENCE_S = calibrate.SILENCE_S, 3
    for name, (module, value) in QUICK.items():
        setattr(module, name, value)
    try:
        yield
    finally:
        calibrate.SILENCE_S = silence
        for name, value in before.items():
            setattr(QUICK[name][0], name, value)


def firmware(folder, version):
    """A firmware of three modules that says which version each of them is; main.py is ours."""
    hello = ('def main():\n    from sixflip_device import a\n    %s\n'
             '    print(\'{"event": "hello", "who_am_i": [%d, %%d, %%d]}\' %% (a.V, b.V))\n')
    power_up, a, b = PARTS[version]
    sources = {power_up: hello % (IMPORT[version], version), a: "V = %d\n" % version,
               b: "V = %d\n" % version,
               "sixflip/__init__.py": "", "sixflip_device/__init__.py": ""}
    files = {}
    for name, text in sources.items():
        files[name] = folder / str(version) / name
        files[name].parent.mkdir(parents=True, exist_ok=True)
        files[name].write_text(text + "PAD = %r\n" % (str(version) * 200))
    main = folder / str(version) / "main.py"
    own = (firmware_update.board_files()["main.py"]).read_text()
    main.write_text(own + "# %d\n" % version)
    files["main.py"] = main
    return files


class Provisioned:
    """A board with the old firmware, whose provisioning with the new one is cut off."""

    def __init__(self, micropython, folder):
        self.micropython, self.folder = micropython, folder
        self.old, self.new = firmware(folder, 1), firmware(folder, 2)
        with self.board("old") as board, MpremoteLink(board.port) as link:
            self.copy(link, self.old)

    def board(self, name):
        return VirtualBoard(STILL, self.folder / (name + ".img"), micropython=self.micropython)

    @staticmethod
    def copy(link, files):
        before, firmware_update.board_files = firmware_update.board_files, lambda: files
        try:
            return firmware_update.copy(link, {}, lambda line: None)
        finally:
            firmware_update.board_files = before

    @staticmethod
    def parts(link):
        """Versions of the modules that main.py starts after a reset; None: it starts none."""
        link.reset()
        for event in events(link, 3, 10):
            if event["event"] == "hello":
                return event["who_am_i"]
        return None

    def cut_at(self, operation):
        """(parts started after the cut, whether it was cut, parts after the next provision,
        files left that should not be).

        operation: number of block operations of the flash before the power fails in one.
        """
        shutil.copy(self.folder / "old.img", self.folder / "cut.img")
        with self.board("cut") as board:
            board.cut_after = operation
            board.power_cycle()
            with contextlib.suppress(SixflipError), MpremoteLink(board.port) as link:
                self.copy(link, self.new)
            cut = board.cut_after is None
            board.cut_after = None
            board.power_cycle()
            with MpremoteLink(board.port) as link:
                found = self.parts(link)
                self.copy(link, self.new)
                left = [name for name in link.files([]) if name.endswith(".new")
                        or name.startswith(("sixflip_new", "sixflip_update", "sixflip/b."))]
                return found, cut, self.parts(link), left


class BadCable:
    """For PtyRelay.corrupt: from the `first` byte on, `rate` of the pieces are damaged."""

    def __init__(self, seed, rate, first=0):
        self.random = random.Random(seed)
        self.rate, self.left = rate, first
        self.hits = 0

    def __call__(self, piece):
        self.left -= len(piece)
        if self.left > 0 or not piece or self.random.random() > self.rate:
            return piece
        self.hits += 1
        at = self.random.randrange(len(piece))
        return self.random.choice((
            piece[:at] + bytes([self.random.randrange(256)]) + piece[at + 1:],      # noise
            piece[:at] + self.random.randbytes(20) + piece[at:],                    # more of it
            piece[:at], piece[at:],                                                 # half a line
            piece[:at] + b"\r\nMPY: soft reboot\r\n" + piece[at:],                  # a reset
            b""))


def verb(*words):
    """(exit code, what stderr says) of a command; anything but an exit code passes through."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main(list(words))
    return code, err.getvalue()


def a_capture(samples=600):
    """Bytes of a small capture.bin."""
    data = bytearray()
    meta = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 65.5, "temp_lsb_per_c": 340, "temp_offset_c": 36.53}
    writer = BlockWriter(data.extend, json.dumps(meta).encode())
    for i in range(samples):
        writer.add(10000, [i, -i, 16384, i * 7 % 100, 3, 2, -3700])
    writer.end(False)
    return bytes(data)


class Pulled:
    """A board with a capture on it, pulled over a cable that fails."""

    def __init__(self, board, folder):
        self.board, self.folder = board, folder
        self.files = {"capture.bin": a_capture(), "sixflip.json": b'{"rate_hz": 100}\n'}
        with MpremoteLink(board.port) as link:
            for name, data in self.files.items():
                link.put(name, data)

    def pull(self, corrupt):
        """(exit code, stderr) over a bad cable, then what is wrong, "" when nothing is: a file
        here that is not the board's, or a second pull, over a good one, that does not work."""
        self.board.relay.corrupt = corrupt
        code, error = verb("pull", "--port", self.board.port, "-o", str(self.folder))
        self.board.relay.corrupt = None
        self.board.power_cycle()
        here = self.folder / self.board.unique_id
        for path in self.folder.rglob("*"):
            if path.name in self.files and path.read_bytes() != self.files[path.name]:
                return code, error, "%s is not the board's" % path.name
            if path.name.endswith(".new"):
                return code, error, "%s was left" % path.name
        again, said = verb("pull", "--port", self.board.port, "-o", str(self.folder))
        if again or not (here / "capture.csv").exists():
            return code, error, "the next pull: exit code %d, %s" % (again, said)
        shutil.rmtree(here)
        return code, error, ""


def calibrate_and_pull_out(board, pose):
    """Pull the cable out in a calibration once that pose is taken, put it back in; the capture
    that the board has kept of the session (capture_reader.Blocks)."""
    board.relay.corrupt = PullOut(board, b'"event": "pose", "pose": "%s"' % pose.encode())
    verb("calibrate", "--port", board.port)
    board.world = dict(STILL)
    board.unplug()
    board.plug()
    with MpremoteLink(board.port) as link:
        link.reset()
        for event in events(link, 5, 30):
            if event["event"] in ("calibrating", "ready"):
                break
        return capture_reader.read(link.get("refused.bin"))


class Calibrated:
    """A calibration over a cable that fails or is pulled out; then what the board makes of it."""

    def __init__(self, micropython, folder):
        self.micropython, self.folder = micropython, folder
        self.truth = worlds.make(SESSION).truth
        with VirtualBoard(STILL, folder / "new.img", micropython=micropython) as board:
            code, error = verb("provision", "--port", board.port)
            assert code == 0, error

    def calibrate(self, corrupt_of):
        """(exit code, stderr, what is wrong or ""); corrupt_of(board): for PtyRelay.corrupt."""
        image = self.folder / "calibrated.img"
        shutil.copy(self.folder / "new.img", image)
        with VirtualBoard(SESSION, image, micropython=self.micropython) as board:
            board.relay.corrupt = cable = corrupt_of(board)
            code, error = verb("calibrate", "--plain", "--port", board.port)
            board.world = dict(STILL)
            board.unplug()
            board.plug()
            wrong = self._afterwards(board, getattr(cable, "poses", 0))
        if code not in ENDS or "Traceback" in error:
            wrong = "exit code %s, %s" % (code, error.strip())
        elif code == 0 and not wrong.startswith("a record"):
            wrong = wrong or "exit code 0, and there is no record"
        return code, error, "" if wrong.startswith("a record that is right") else wrong

    def _afterwards(self, board, told):
        """It starts, what was told is kept, a record is right; "a record that is right" then."""
        with MpremoteLink(board.port) as link:
            link.reset()
            names = set()
            for event in events(link, 5, 30):
                names.add(event["event"])
                if names & {"calibrating", "ready"}:
                    break
            else:
                return "the board says %s only" % sorted(names)
            present = link.files([])
            records = [link.get(name) for name in ("record_a.bin", "record_b.bin")
                       if name in present]
            if records:
                return self._judged(correction_record.decode(records[0]))
            if told:
                kept = capture_reader.read(link.get("refused.bin"))
                if len(kept.placements) < told:
                    return "%d poses were told, %d are kept" % (told, len(kept.placements))
        return ""

    def _judged(self, record):
        outcome = storm.Outcome()
        outcome.word = record.accel["verdict"]
        storm.compare(outcome, self.truth, record)
        return outcome.reason if outcome.word == "wrong" else "a record that is right"


class PullOut:
    """For PtyRelay.corrupt: kills the board when it says so, once a host had it in hand, and says
    nothing more. poses: that the session has taken by then."""

    def __init__(self, board, when):
        self.board, self.when, self.heard = board, when, b""
        self.out = self.begun = False
        name = when.decode()[-4:-1]
        self.poses = 1 + POSES.index(name) if name in POSES else 0

    def __call__(self, piece):
        self.heard = self.heard[-200:] + piece
        self.begun = self.begun or b"raw REPL" in self.heard
        if self.begun and not self.out and self.when in self.heard:
            self.out = True
            self.board.world = dict(STILL)
            self.board.kill()
        return b"" if self.out else piece
