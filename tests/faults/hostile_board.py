"""Every verb that talks to a board, at one that attacks by a seed. What must hold: an exit code
that is none of an internal error, an end within its time, nothing that steers a terminal."""

import os
import tempfile
import time

from sixflip_host import cli
from sixflip_host.history import store
from tests.faults.hostile_answers import Attack
from tests.faults.hostile_port import HostileBoard, run

# (words, seconds of the board's clock in which the verb has to end). A calibration may take as
# long as the board says that it waits for a person; a copy answers file by file.
VERBS = {
    "calibrate": (("calibrate", "--plain"), 900), "provision": (("provision",), 900),
    "continue": (("calibrate", "--plain", "--continue"), 900),
    "redo": (("calibrate", "--plain", "--redo", "Z+"), 900),
    "doctor": (("doctor",), 300), "check": (("check", "--json"), 300),
    "check in words": (("check",), 300), "restore": (("restore",), 300),
    "mount": (("mount", "--axes", "x=x,y=y,z=z"), 300), "pull": (("pull",), 300),
    "stream": (("stream", "--seconds", "2"), 300), "raw": (("stream", "--raw",
                                                             "--seconds", "2"), 300),
    "heading": (("stream", "--heading", "--seconds", "2", "--hz", "20"), 300),
    "provision --json": (("provision", "--json"), 900),
}
ENDS = (0, 1, 3, 4)     # done, refused or not held, no board, a file that is not what it claims


class Result:
    """code, seconds of the board's clock, real seconds, what is wrong ("" when nothing is)."""

    def __init__(self, attack, code, seconds, real, wrong):
        self.attack, self.code, self.seconds, self.real = attack, code, seconds, real
        self.wrong = wrong


def attacked(verb, seed):
    """The Result of a verb at the board of a seed."""
    words, limit = VERBS[verb]
    attack = Attack("%s %s" % (verb, seed))
    board = HostileBoard(attack, recorded=attack.rng.random() < 0.7)
    with tempfile.TemporaryDirectory() as folder:
        if verb == "pull":
            words = (*words, "-o", folder)
        before = os.environ.get(store.VARIABLE)
        os.environ[store.VARIABLE] = os.path.join(folder, "history.sqlite")
        started = time.perf_counter()
        try:
            code, out, error = run(board, *words)
            wrong = _wrong(code, out, error, board.now, limit)
            listed, _, said = run(HostileBoard(), "history")
            if listed != 0:
                wrong = wrong or "then history ends with %d: %s" % (listed, said[-300:])
        finally:
            os.environ[store.VARIABLE] = before or ""
    return Result(attack, code, board.now, time.perf_counter() - started, wrong)


def _wrong(code, out, error, seconds, limit):
    if code == cli.INTERNAL_ERROR:
        return error[-300:].strip()
    if code not in ENDS:
        return "exit code %s: %s" % (code, error[-300:].strip())
    if seconds > limit:
        return "%.0f s, %d are allowed: %s" % (seconds, limit, error[-200:].strip())
    odd = [c for c in out + error if not c.isprintable() and c != "\n"]
    if odd:
        return "a terminal would obey %r" % odd[:5]
    return "" if code == 0 or out or error else "exit code %d without a word" % code
