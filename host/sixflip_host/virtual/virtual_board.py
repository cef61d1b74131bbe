"""A board without hardware: MicroPython's unix port, flash in an image file, a pty as its USB.

The firmware, mpremote and the host tool cannot tell it from a board. Inside runs
sixflip_sim/micropython/boot.py; this side starts it again after every reset, as the supply
and the reset line do, and carries the bytes between two pseudo-terminals:

    mpremote - outer pty - relay thread - inner pty (the child's controlling terminal)
"""

import hashlib
import json
import subprocess
import tempfile
import threading
import time
from pathlib import Path

from sixflip_sim.flash_times import PAGE, PAGE_US, SECTOR_ERASE_US

from ..board.board_files import host_dir, shared_dir
from ..errors import NoBoard
from . import micropython_fetch

FLASH_BYTES = 1408 * 1024  # what MicroPython leaves for files of a Pico's 2 MB
HARD_RESET, SOFT_RESET, SOFT_RESET_RAW = 80, 81, 82  # exit codes of raw_repl.Restart
POWER_CUT = 5
PWRON_CAUSE, HARD_CAUSE, SOFT_CAUSE = 1, 2, 5
WAIT_S = 10


class VirtualBoard:
    """Context manager. While it is entered a process runs and .port names its serial port.

    world       spec for sixflip_sim.worlds.make; a new one may be set before power_cycle()
    image_path  the flash, made when it is not there
    heapsize    of MicroPython, the simulated world's own needs included
    wiring      {"scl_pin": 5, "button_pin": 15, "button_held": true}, as far as it matters
    speed       virtual seconds a real second; None: as fast as the processor
    hand        a board_hands.AskedHand that does what the board asks for; None: the world's
                operator does what was planned
    """

    def __init__(self, world, image_path, heapsize="4m", micropython=None, speed=None,
                 flash_bytes=FLASH_BYTES, wiring=None, hand=None):
        self.world = dict(world)
        self.image_path = Path(image_path).resolve()
        self.heapsize = heapsize
        self.micropython = micropython or micropython_fetch.find()
        if not self.micropython:
            raise NoBoard(micropython_fetch.MISSING)
        self.speed = speed
        self.hand_asked = hand
        self.wiring = dict(wiring or {})
        self.flash_bytes = flash_bytes
        self.cut_after = None  # block operations until the supply fails, once
        self.starts = 0
        self.port = None
        self.child = None
        self.relay = None
        self.folder = None
        self.hand = threading.RLock()  # on the plug: pulled in one thread, put back in another

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="sixflip-board-")
        try:
            self.plug()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, *error):
        self.close()

    @property
    def unique_id(self):
        """Eight bytes in hex, made of the flash's path: they stay with the board."""
        return hashlib.sha256(str(self.image_path).encode()).hexdigest()[:16]

    # -- supply and plug

    def plug(self):
        """Plug in: a serial port appears and the board powers up."""
        from .pty_relay import PtyRelay
        with self.hand:
            self.relay = PtyRelay(self)
            self.port = self.relay.port
            self.start(raw=False, cause=PWRON_CAUSE)
            self.relay.start()

    def unplug(self):
        """Pull the cable: supply gone and the port with it."""
        with self.hand:
            relay = self.relay
            if relay:
                relay.stop()
            self.kill()
            if relay:
                relay.close()
            self.relay = self.port = None

    def power_cycle(self, world=None):
        """Supply off and on, the flash stays; optionally into another world. The port stays."""
        if world is not None:
            self.world = dict(world)
        before = self.starts
        self.kill()
        end = time.monotonic() + WAIT_S
        while self.starts == before and time.monotonic() < end:
            time.sleep(0.01)

    def close(self):
        self.unplug()
        if self.folder:
            self.folder.cleanup()
            self.folder = None

    # -- the process

    def start(self, raw, cause):
        """Start the process on the relay's inner pty."""
        import fcntl
        import termios
        tools = host_dir() / "sixflip_sim" / "micropython"
        config = {
            "world": self.world, "wiring": self.wiring,
            "image": str(self.image_path), "speed": self.speed,
            "flash_bytes": self.flash_bytes, "cut_after": self.cut_after, "raw": raw,
            "flash_times": (SECTOR_ERASE_US, PAGE_US, PAGE),
            "cause": cause, "unique_id": self.unique_id, "asked": self.relay.ask_read,
            "hand": self.relay.hand_read,
            "path": [str(tools), str(host_dir()), str(shared_dir()), ".frozen"],
            "terminal": {
                "repl": [0, 0, 0],
                "run": [0, termios.OPOST | termios.ONLCR, termios.ISIG | termios.NOFLSH],
            },
        }
        path = Path(self.folder.name) / "boot.json"
        path.write_text(json.dumps(config))
        tty = self.relay.inner_slave
        self.child = subprocess.Popen(
            [self.micropython, "-X", "heapsize=" + self.heapsize, str(tools / "boot.py"),
             str(path)],
            stdin=tty, stdout=tty, stderr=tty, start_new_session=True, cwd=self.folder.name,
            pass_fds=(self.relay.ask_read, self.relay.hand_read),
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        self.starts += 1

    def start_again(self, code):
        """After the process ended with code: what reset line and supply would do."""
        cause = {HARD_RESET: HARD_CAUSE, SOFT_RESET: SOFT_CAUSE, SOFT_RESET_RAW: SOFT_CAUSE}
        if code == POWER_CUT:
            self.cut_after = None
        self.start(raw=code == SOFT_RESET_RAW, cause=cause.get(code, PWRON_CAUSE))

    def kill(self):
        child = self.child
        if child and child.poll() is None:
            child.kill()
            child.wait()
