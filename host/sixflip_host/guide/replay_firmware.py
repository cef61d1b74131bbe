"""python -m sixflip_host.guide.replay_firmware FOLDER CAPTURE SPEED: the firmware on a capture.

The board's own main loop and session, with the capture's samples on its bus and its times on
its clock. The samples begin with the session; when they are all played it is told to stop.
"""

import json
import os
import sys
from pathlib import Path

from ..board import local_firmware
from ..board.board_files import shared_dir


def run(folder, path, speed):
    sys.path.insert(1, str(shared_dir()))
    from ..capture import capture_file
    from .replay_chips import Replay, bus_of
    capture = capture_file.read_samples(path)
    replay = Replay(capture, speed)
    bus = bus_of(capture, replay)
    local_firmware.own_copy(folder)
    on_the_clock = local_firmware.board_on(replay.clock)

    class ReplayBoard(on_the_clock):
        """A board on the capture's bus that begins and ends with its samples."""

        def read_line(self):
            if replay.ended:
                replay.stop()
                return json.dumps({"cmd": "stop"})
            return on_the_clock.read_line(self)

        def write_line(self, text):
            if text.startswith('{"event": "calibrating"'):
                replay.begin()
            elif replay.running and text.startswith('{"event": "capture"'):
                replay.stop()
            on_the_clock.write_line(self, text)

    def make(root):
        board = ReplayBoard(lambda: bus, root)
        board.unique_id = str(capture.meta.get("device_id") or "replay")
        return board
    local_firmware.run_on(folder, make)


def main(argv):
    try:
        run(Path(argv[0]), argv[1], float(argv[2]) or None)
    except BrokenPipeError:  # the host has gone; nobody is left to tell
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
