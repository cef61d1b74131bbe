"""A process's /dev/i2c-1 with simulated chips behind it: umockdev below the ioctl."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from tests.debian_tier import Unavailable, install

HERE = Path(__file__).resolve().parent
PACKAGES = ("umockdev", "gir1.2-umockdev-1.0", "python3-gi")
SYSTEM_PYTHON = "/usr/bin/python3"  # Debian's gi is not in a virtual environment
PRELOAD = "libumockdev-preload.so.0"
ASK = "import gi; gi.require_version('UMockdev', '1.0'); from gi.repository import UMockdev"


def missing():
    """What of umockdev and its Python binding is not there."""
    found = []
    if not shutil.which("umockdev-wrapper"):
        found.append("umockdev")
    if not os.path.exists(SYSTEM_PYTHON) or subprocess.run(
            [SYSTEM_PYTHON, "-c", ASK], capture_output=True).returncode:
        found.append("UMockdev for %s" % SYSTEM_PYTHON)
    return found


def provide():
    """Unavailable where there is no Linux or no umockdev."""
    if sys.platform != "linux":
        raise Unavailable("umockdev is for Linux only")
    install(PACKAGES, missing)


class DeviceNode:
    """Context manager. folder: for its files; world: spec for sixflip_sim.worlds.

    real_time  the chips are read as this computer's time goes, not as firmware_in_shared_time.py
            moves it
    errnos  [[n-th transfer, errno, how many], …] that the bus answers instead
    seen    after it ended: {"transfers", "longest" (bytes), "requests": {ioctl: how often}}
    """

    def __init__(self, folder, world, errnos=(), real_time=False):
        self.clock = folder / "clock"
        self.clock.write_bytes(bytes(8))
        self.spec = folder / "i2c.json"
        self.spec.write_text(json.dumps({"world": dict(world, flavour="linux"),
                                         "clock": None if real_time else str(self.clock),
                                         "errnos": list(errnos)}))
        self.seen = None

    def __enter__(self):
        self.process = subprocess.Popen(
            ["umockdev-wrapper", SYSTEM_PYTHON, str(HERE / "fake_i2c.py"), str(self.spec)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.root = self.process.stdout.readline().strip()
        assert os.path.exists(self.root + "/dev/i2c-1"), "umockdev made no device node"
        return self

    def __exit__(self, *_):
        try:
            told = self.process.communicate(timeout=20)[0]
            self.seen = json.loads(told)
        finally:
            self.process.kill()
            self.process.wait()

    def environment(self, **more):
        """For a process that is to see the node."""
        return dict(os.environ, LD_PRELOAD=PRELOAD, UMOCKDEV_DIR=self.root, **more)

    def run(self, *words, **options):
        """A Python process that sees the node, finished; its output as text."""
        return subprocess.run([sys.executable, *words], capture_output=True, text=True,
                              timeout=300, env=self.environment(), **options)
