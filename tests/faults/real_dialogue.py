"""What an honest board says and holds: taken once from the firmware on a simulated bus."""

import functools
import tempfile
from pathlib import Path

from sixflip_sim import worlds
from tests.faults import storm
from tests.faults.reacting_hand import ReactingHand
from tests.worlds.simulated_board import SimulatedBoard, power_on

# What a host asks for, and the event that answers.
ASKED = {"info": ({"cmd": "info"}, "info"), "check": ({"cmd": "check"}, "check"),
         "mount": ({"cmd": "mount", "axes": "x y z"}, "mounted"),
         "restore": ({"cmd": "restore"}, "restored"),
         "corrected": ({"cmd": "stream", "hz": 20}, "stream"),
         "raw": ({"cmd": "stream", "hz": 20, "raw": True}, "stream"),
         "heading": ({"cmd": "stream", "hz": 20, "heading": True}, "stream")}
SETTINGS = dict(grace_ms=100, rate_hz=25, stream_hz=5)


class Dialogue:
    """calibrated, started   events from power-up to ready: of a session, of a board with a record
    answers, samples         {asked for: event}, {asked for: events}; see ASKED
    files                    {name: bytes} of its flash
    """

    def __init__(self, root):
        spec = dict(storm.WORLD, seed=3, **storm.SENSORS[0])
        world = worlds.make(spec)
        board = storm.StormBoard(world, root, ReactingHand(world))
        power_on(root, board=board, **SETTINGS)
        self.calibrated = until_ready(board)
        self.files = {path.name: path.read_bytes() for path in Path(root).iterdir()}
        self.files["sixflip.json"] = b'{"board": "pico", "rate_hz": 100}\n'
        self.answers, self.samples = {}, {}
        for name, (command, answer) in ASKED.items():
            stop = lambda event: event["event"] in ("sample", "heading") and event["t_us"] > 9e6
            world = worlds.make(dict(spec, first_rest_s=400.0))
            asked = ["ready", command, 1]
            board = SimulatedBoard(world, root, [asked, [stop, {"cmd": "stop"}, 9]])
            power_on(root, board=board, **SETTINGS)
            self.started = until_ready(board)
            self.answers[name] = board.named(answer)[0]
            kind = "heading" if name == "heading" else "sample"
            self.samples[name] = [e for e in board.named(kind) if ("raw" in e) == (name == "raw")]


def until_ready(board):
    names = [event["event"] for event in board.events]
    return board.events[:names.index("ready") + 1]


@functools.lru_cache
def dialogue():
    """The Dialogue of this process."""
    with tempfile.TemporaryDirectory() as root:
        return Dialogue(root)
