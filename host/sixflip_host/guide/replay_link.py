"""A link to the firmware that plays a capture, as if the board were there."""

import shutil
import sys
import tempfile
from pathlib import Path

from ..board import firmware_update
from ..board.local_link import LocalLink
from ..capture import capture_file
from .replay_chips import settings_of


def checked(path):
    """The settings to replay a capture file with; BadFile or UsageError where it cannot be."""
    return settings_of(capture_file.read_samples(path))


class ReplayLink(LocalLink):
    """The firmware of this version on the samples of a capture file; its flash is thrown away.

    speed  seconds of the capture a second; None: as fast as it goes
    """

    thrown_away = True

    def __init__(self, path, speed=1.0):
        wanted = checked(path)
        self.temporary = tempfile.mkdtemp(prefix="sixflip-replay-")
        super().__init__(self.temporary)
        self.capture, self.speed = Path(path).resolve(), speed
        self.patience = max(1.0, 1.0 / (speed or 1.0))    # its seconds last that long
        self.port = "replay of %s" % Path(path).name
        firmware_update.copy(self, wanted, lambda line: None)

    def command(self):
        return [sys.executable, "-m", "sixflip_host.guide.replay_firmware", str(self.folder),
                str(self.capture), str(self.speed or 0)]

    def close(self):
        super().close()
        shutil.rmtree(self.temporary, ignore_errors=True)
