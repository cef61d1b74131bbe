"""The same firmware under CPython with a folder as its flash: a Raspberry Pi, or no MicroPython.

The folder gets the files a board would get. `sixflip_host.board.local_firmware` starts them in a
process of its own, whose standard input and output are the serial line.
"""

import hashlib
import json
import os
import platform
import queue
import subprocess
import sys
import threading
import time
from pathlib import Path

from ..atomic_write import read_bytes, write_bytes
from ..errors import NoBoard, UsageError
from .board_files import host_dir
from .on_board_scripts import STAGED, UPDATE, script

END = object()


class LocalLink:
    """Link to a firmware process; it is started by the first reset().

    folder  its flash (default: where the firmware on a Raspberry Pi keeps it)
    world   spec of a simulated world instead of this computer's I2C bus
    """

    def __init__(self, folder=None, world=None):
        self.folder = Path(folder or Path.home() / ".sixflip" / "board").resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.world = world
        self.port = "local:%s" % self.folder
        self.process = None
        self.queue = None

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def version(self):
        return ("CPython %s" % platform.python_version(), platform.machine())

    def platform(self):
        return "linux"

    mpy_format = None  # CPython loads no .mpy files

    def mpy(self):
        return self.mpy_format

    def board_id(self):
        return hashlib.sha256(str(self.folder).encode()).hexdigest()[:16]

    # -- files

    def path(self, name):
        path = (self.folder / name).resolve()
        if self.folder not in path.parents:
            raise UsageError("%s: %r leaves the folder" % (self.port, name))
        return path

    def files(self, hashed=None):
        files = {}
        for path in sorted(self.folder.rglob("*")):
            name = path.relative_to(self.folder).as_posix()
            if path.is_file() and "__pycache__" not in name:
                data = path.read_bytes()
                wanted = hashed is None or name.removeprefix(STAGED) in hashed
                files[name] = (len(data), hashlib.sha256(data).hexdigest() if wanted else None)
        return files

    def get(self, name, progress=None, size=None):
        return read_bytes(self.path(name))

    def put(self, name, data, progress=None):
        path = self.path(name)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, data)

    def stage(self, name, data, progress=None):
        self.put(STAGED + name, data)

    def commit(self, names, stale=()):
        self.put(UPDATE, script("put_in_place", names=names, stale=list(stale),
                                staged=STAGED).encode())
        self.finish()

    def finish(self):
        subprocess.run([sys.executable, UPDATE], cwd=self.folder, check=True)

    def remove(self, name):
        os.remove(self.path(name))

    # -- the firmware

    def command(self):
        """What runs as the board."""
        return [sys.executable, "-m", "sixflip_host.board.local_firmware", str(self.folder),
                json.dumps(self.world)]

    def reset(self):
        self.stop()
        environment = dict(os.environ, SIXFLIP_BOARD_DIR=str(self.folder),
                           PYTHONPATH=str(host_dir()), PYTHONDONTWRITEBYTECODE="1")
        self.process = subprocess.Popen(
            self.command(),
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            env=environment, cwd=self.folder,
            start_new_session=True)     # a Ctrl-C is the host's: it ends the session in order
        # A short queue: when nobody listens the firmware waits, as it does on a full USB pipe.
        self.queue = queue.Queue(64)
        threading.Thread(target=pump, args=(self.process, self.queue), daemon=True).start()

    restart_firmware = reset

    def lines(self, timeout):
        for line in self.raw_lines(timeout):
            yield line.decode("utf-8", "replace")

    def raw_lines(self, timeout):
        if self.process is None:
            self.reset()
        while True:
            try:
                line = self.queue.get(timeout=timeout)
            except queue.Empty:
                return
            if line is END:
                if self.process.wait() != 0:
                    raise NoBoard("%s: the firmware's process ended with code %d"
                                  % (self.port, self.process.returncode))
                self.reset()
                continue
            yield line

    def send(self, line):
        if self.process is None:
            self.reset()
        try:
            self.process.stdin.write(line.encode() + b"\n")
            self.process.stdin.flush()
        except OSError:
            raise NoBoard("%s: the firmware's process has ended" % self.port) from None

    def power_cycle(self, world=None):
        if world is not None:
            self.world = world
        self.reset()

    def stop(self):
        process, self.process = self.process, None
        if process is None:
            return
        process.kill()
        drain(self.queue)
        process.wait()
        process.stdin.close()

    def close(self):
        self.stop()


def pump(process, lines):
    """Thread: lines of the process into the queue, END at last."""
    for line in process.stdout:
        lines.put(line.rstrip(b"\r\n"))
    process.stdout.close()
    lines.put(END)


def drain(lines):
    """Let a pump that waits for room go on until its END."""
    end = time.monotonic() + 5
    while time.monotonic() < end:
        try:
            if lines.get(timeout=0.5) is END:
                return
        except queue.Empty:
            return
