"""python -m sixflip_host.guide.replay_firmware FOLDER CAPTURE SPEED: the firmware on a capture.

The board's own main loop and session, with the capture's samples on its bus and its times on
its clock. The samples begin with the session; when they are all played it is told to stop.
"""

import json
import os
import sys
from pathlib import Path

from ..board.board_files import shared_dir


def run(folder, path, speed):
    sys.path.insert(1, str(shared_dir()))
    from ..capture import capture_file
    from .replay_chips import Replay, bus_of
    capture = capture_file.read(path)
    replay = Replay(capture, speed)
    bus = bus_of(capture, replay)
    # The firmware has to bring its own copy of sixflip, as on a board.
    sys.path.remove(str(shared_dir()))
    for name in [n for n in sys.modules if n.split(".")[0] == "sixflip"]:
        del sys.modules[name]
    sys.path.insert(0, str(folder))
    from sixflip_device import power_up, settings
    from sixflip_device.boards.raspberry_pi import LinuxBoard
    clock = replay.clock

    class ReplayBoard(LinuxBoard):
        """A Linux board on the capture's bus and clock."""

        def reopen_i2c(self):
            return self.i2c

        def ticks_us(self):
            return clock.ticks_us()

        def ticks_diff(self, later, earlier):
            return clock.ticks_diff(later, earlier)

        def sleep_us(self, us):
            clock.sleep_us(us)

        def read_line(self):
            if replay.ended:
                replay.stop()
                return json.dumps({"cmd": "stop"})
            return LinuxBoard.read_line(self)

        def write_line(self, text):
            if text.startswith('{"event": "calibrating"'):
                replay.begin()
            elif replay.running and text.startswith('{"event": "capture"'):
                replay.stop()
            LinuxBoard.write_line(self, text)

    root = os.path.join(str(folder), "")
    values, problems = settings.load(root)
    board = ReplayBoard(lambda: bus, root)
    board.unique_id = str(capture.meta.get("device_id") or "replay")
    power_up.run(board, values, problems)


def main(argv):
    try:
        run(Path(argv[0]), argv[1], float(argv[2]) or None)
    except BrokenPipeError:  # the host has gone; nobody is left to tell
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
