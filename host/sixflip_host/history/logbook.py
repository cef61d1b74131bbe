"""What the verbs call when something happened to a board. It never fails them: one warning."""

import json
import math
import sqlite3
import sys
import time
from pathlib import Path

from ..errors import SixflipError
from ..json_numbers import finite
from ..terminal import plain
from . import store
from .store import SEEN, Happened

LONGEST_ID = 64
LONGEST_REASON = 400
RECORDS = ("record_a.bin", "record_b.bin")


class Witness:
    """Hears the events of a calibration; done() keeps what came of it.

    board  the board's id where it is known already; the firmware's own word wins
    """

    def __init__(self, board=None):
        self.board = board
        self.chip = self.solved = self.saved = None

    def hear(self, event):
        kind = event["event"]
        if kind == "hello":
            self.board = event.get("id") or self.board
            self.chip = event.get("chip")
        elif kind == "solved":
            self.solved, self.saved = event, None
        elif kind == "saved":
            self.saved = event

    def done(self):
        """Keep it: one row for a calibration that was solved, or refused; else nothing."""
        event, saved = self.solved, self.saved or {}
        if event is None:
            return
        self.solved = None
        answer = {name: event.get(name) for name in (
            "level", "tilt_deg", "tilt_spread_deg", "residual_mg_rms", "scale", "v", "noise_mg")}
        answer["written"] = saved.get("written") is True
        _keep(lambda: [_row(self.board, "calibration", "calibrate", event.get("verdict"),
                            event.get("reason"), chip=self.chip, answer=answer,
                            sequence=saved.get("sequence") if answer["written"] else None)])


def pulled(folder, board):
    """The records in a folder `pull` made; board: the id the link knows."""
    def rows():
        from ..calibrate import verify_files
        from ..capture import capture_binary, capture_file
        kept, known = [], board
        capture = Path(folder) / "capture.bin"
        if capture.exists() and not capture_binary.is_empty(capture.read_bytes()):
            known = capture_file.read(capture).meta.get("device_id") or board
        for name in RECORDS:
            path = Path(folder) / name
            if path.exists():
                record = verify_files.read_record(path)
                if record.accel or record.gyro:
                    kept.append(_of_record(known, "pull", record, path.read_bytes()))
        return kept
    _keep(rows)


def _of_record(board, verb, record, data):
    judged = record.accel or record.gyro
    return _row(board, "calibration", verb, judged["verdict"], judged["reason"],
                at=record.time or None, time_is="made" if record.time else SEEN,
                chip=record.chip, session=record.session, sequence=record.sequence,
                temp_c=record.temp_c, record=data)


def verified(capture, record, checks):
    """A `verify`: the board's arithmetic against the host's; checks: verify_checks.Check."""
    failed = [check.name for check in checks if not check.ok]
    _keep(lambda: [_row(
        capture.meta.get("device_id"), "verification", "verify",
        "fails" if failed else "holds", "differ: " + ", ".join(failed) if failed else "",
        chip=record.chip, session=record.session, sequence=record.sequence,
        temp_c=record.temp_c, answer={"comparisons": len(checks), "differ": failed})])


def checked(board, answer):
    """A `check`: the calibration against a rest."""
    _keep(lambda: [_row(board, "check", "check", "holds" if answer["valid"] else "fails",
                        "; ".join(map(str, answer["against"])), temp_c=answer["temp_c"],
                        answer=answer)])


def refined(capture, answer):
    """A `refine` of a capture."""
    def rows():
        accel, celsius = answer["accel"], None
        if capture.temp is not None and len(capture):
            celsius = float(capture.temp.mean()) / capture.meta["temp_lsb_per_c"] + \
                capture.meta["temp_offset_c"]
        session = capture.meta.get("session")
        return [_row(capture.meta.get("device_id"), "calibration", "refine", answer["verdict"],
                     answer["reason"], chip=answer["sensor"], session=session, temp_c=celsius,
                     answer={"scale": accel["scale"], "v": accel["v"],
                             "norm_off_mg_rms": answer["norm_off_mg_rms"],
                             "gyro": answer["gyro"]})]
    _keep(rows)


def _row(board, kind, verb, verdict, reason, at=None, answer=None, session=None, sequence=None,
         temp_c=None, **more):
    """A Happened out of values that a board or a file may have made up; None without a board."""
    board = _id(board)
    if board is None:
        return None
    return Happened(board, kind, verb, time.time() if at is None else float(at),
                    str(verdict)[:40], str(reason or "")[:LONGEST_REASON],
                    session=_whole(session), sequence=_whole(sequence), temp_c=_number(temp_c),
                    answer=finite(json.loads(json.dumps(answer or {}, default=str))), **more)


def _id(board):
    """The id as it is kept: a word that can be typed."""
    word = "".join(c for c in str(board or "") if c.isalnum() or c in "-_.:")[:LONGEST_ID]
    return word or None


def _whole(value):
    return value if type(value) is int and 0 <= value < 1 << 40 else None


def _number(value):
    return float(value) if type(value) in (int, float) and math.isfinite(value) else None


def _keep(make):
    """Make the rows and put them away, or say in one line on stderr why not."""
    try:
        file = store.path()
        rows = [row for row in make() if row is not None] if file else []
        if rows:
            store.add(file, rows)
    except (SixflipError, OSError, sqlite3.Error, ValueError, TypeError, KeyError,
            RecursionError) as error:
        print("sixflip: not kept in the history: " + plain(error), file=sys.stderr)
