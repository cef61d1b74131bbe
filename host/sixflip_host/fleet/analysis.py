"""One board from its files to a row: solved, verified, and what its rests say of each effect.

This is the task that workers run. Whatever is wrong with a board is in its row as a sentence; the
other boards never hear of it.
"""
import hashlib
import json
import math
import os
import time
from dataclasses import dataclass

import numpy as np

from sixflip import __version__

from ..calibrate import verification, verify_files
from ..capture.registers import SENSORS
from ..diagnosis import rests_judged
from ..errors import BadFile, SixflipError, internal_error
from ..value_kinds import LONGEST_TEXT
from . import diagnosed, effects, parameters, sources, summary_file

LAYOUT = 1  # of a row: with the version of sixflip, what makes an older row be done again
VERSION = "%d, sixflip %s" % (LAYOUT, __version__)
MOST_SESSIONS = 64


@dataclass(frozen=True)
class Options:
    """summaries: whether one is put beside each capture; diagnose: whether every board is
    diagnosed by itself, which takes seconds of it."""

    summaries: bool = True
    diagnose: bool = False

    @property
    def version(self):
        """Of the rows that are made so."""
        return VERSION + (", diagnosed" if self.diagnose else "")


def stamps(board):
    """What tells that a board's files are as they were: a text; BadFile where one is missing."""
    if board.calibrations:
        digest = hashlib.sha256()
        for earlier in board.calibrations:
            digest.update(repr((earlier.at, earlier.verdict)).encode() + earlier.record)
        return digest.hexdigest()
    return repr([(os.path.basename(path), *summary_file.stamp(path)) for path in _files(board)])


def content(board):
    """SHA-256 of the content of all of a board's files, hex."""
    if board.calibrations:
        return stamps(board)
    digest = hashlib.sha256()
    for path in _files(board):
        digest.update(summary_file.content_hash(path).encode())
    return digest.hexdigest()


def _files(board):
    records = [os.path.join(board.folder, name) for name in sources.RECORDS] \
        if board.folder else []
    return [*board.captures, *board.summaries, *filter(os.path.exists, records)]


def failed(board, options, why=""):
    """The row of a board before anything is known of it, or where a worker died of it."""
    return {"board": board.board, "batch": board.batch,
            "version": (options or Options()).version, "failure": why[:LONGEST_TEXT],
            "paths": [*board.captures, *board.summaries], "written": time.time(),
            "stamps": "", "content": "", **_empty()}


def row(board, options=None):
    """dict of a board, see dataset.schema(); failure is "" or the sentence on what is wrong."""
    options = options or Options()
    of_board = failed(board, options)
    started = time.process_time()
    try:
        of_board["stamps"], of_board["content"] = stamps(board), content(board)
        of_board.update(_of_history(board) if board.calibrations
                        else _of_files(board, options))
    except SixflipError as error:
        of_board["failure"] = str(error)
    except MemoryError:
        of_board["failure"] = "there is not enough memory for this board"
    except Exception as error:  # a bug of ours is one board's, too
        of_board["failure"] = internal_error(error)
    of_board["failure"] = of_board["failure"][:LONGEST_TEXT]
    of_board["cpu_s"] = time.process_time() - started
    return of_board


def _empty():
    return {"chip": "", "accel_range_g": math.nan, "gyro_range_dps": math.nan, "at": [],
            "verdicts": [], "reasons": [], "values": [], "covariances": [], "verified": "",
            "findings": [], "remarks": [], "gap": "", "cpu_s": 0.0,
            **{"%s_%s" % (what, sensor): [] for sensor in effects.FORMS
               for what in ("precision", "score")}}


def _of_files(board, options):
    remarks, kept = [], []
    if not board.captures and not board.summaries:
        raise BadFile("no session")
    for path in [*board.captures, *board.summaries][:MOST_SESSIONS]:
        if path in board.summaries:
            kept.append(summary_file.read(path))
        else:
            summary, why = summary_file.of_capture(path, options.summaries)
            kept.append(summary)
            remarks += [why] if why else []
    if not any(one.placements() for one in kept):
        raise BadFile("no session: nothing lies still in a pose that is known, in %s" % ", ".join(
            map(os.path.basename, [*board.captures, *board.summaries])))
    ids = {str(one.meta["device_id"]) for one in kept if one.meta.get("device_id")}
    if len(ids) > 1:
        raise BadFile("captures of %d boards in one place, ids %s: expected one board's" % (
            len(ids), " ".join(sorted(ids))))
    kinds = list(dict.fromkeys(_kind(one.meta) for one in kept))
    if len(kinds) > 1:
        remarks.append("sessions of another chip or range are left out: %s beside %s" % (
            ", ".join(map(_spelled, kinds[1:])), _spelled(kinds[0])))
        kept = [one for one in kept if _kind(one.meta) == kinds[0]]
    hashes = [one.about.get("hash") for one in kept]
    repeated = [k for k, one in enumerate(hashes) if one and one in hashes[:k]]
    if repeated:
        remarks.append("%d captures repeat one before them and are left out" % len(repeated))
        kept = [one for k, one in enumerate(kept) if k not in repeated]
    return dict(_judged(kept, remarks, options), verified=_verified(board, remarks))


def _kind(meta):
    return meta["sensor"], meta.get("accel_range_g", math.nan), meta.get("gyro_range_dps",
                                                                         math.nan)


def _spelled(kind):
    return "%s ±%g g ±%g °/s" % kind


def _judged(kept, remarks, options=None):
    """What stands in the row of the summaries of one board's sessions."""
    columns = {"at": [], "verdicts": [], "reasons": [], "values": [], "covariances": []}
    sessions = [one.session() for one in kept]
    for number, (summary, session) in enumerate(zip(kept, sessions)):
        solved = summary.solved()
        made = summary.meta.get("time")
        _add(columns, made if isinstance(made, (int, float)) else float(number), solved.verdict,
             solved.reason, parameters.of_solution(solved, session))
    chip, accel, gyro = _kind(kept[0].meta)
    gaps = {}
    if options and options.diagnose:
        answered, rests, gaps = diagnosed.diagnose_board(kept, sessions)
        columns["gap"] = json.dumps(answered, allow_nan=False)
    if not gaps:
        rests = rests_judged.usable_rests(sessions, [], [])
    told, said = effects.information(rests, chip, gaps)
    for sensor, told_of in told.items():
        upper = np.triu_indices(len(told_of.score))
        columns["precision_" + sensor] = told_of.precision[upper].tolist()
        columns["score_" + sensor] = told_of.score.tolist()
    findings = ["the %s: %s" % (SENSORS.get(f["sensor"], f["sensor"]), f["words"] or f["effect"])
                for one in kept for f in one.about["samples"]["findings"]]
    return dict(columns, chip=chip, accel_range_g=accel, gyro_range_dps=gyro,
                findings=list(dict.fromkeys(findings)),
                remarks=list(dict.fromkeys([*remarks, *said])))


def _add(columns, at, verdict, reason, estimate):
    columns["at"].append(float(at))
    columns["verdicts"].append(verdict)
    columns["reasons"].append(reason)
    columns["values"].append(estimate.value.tolist())
    columns["covariances"].append(np.concatenate(
        [estimate.covariance[block].ravel() for block in parameters.BLOCKS]).tolist())


def _verified(board, remarks):
    """holds or fails of the board's own record against its capture; "" where there is none."""
    if not board.folder or not any(os.path.exists(os.path.join(board.folder, name))
                                   for name in sources.RECORDS):
        return ""
    try:
        path, capture, record_path, record = verify_files.find([board.folder])
        before = verify_files.record_before(record_path, record)
        if not (capture.board_placements or capture.placements()):
            raise BadFile("%s: no placement in it" % path)
        checks, _ = verification.verify(capture, record, before)
    except SixflipError as error:
        remarks.append("not verified: %s" % error)
        return ""
    failed = [check.name for check in checks if not check.ok]
    if failed:
        remarks.append("the board's arithmetic is not the host's: %s" % ", ".join(failed))
    return "fails" if failed else "holds"


def _of_history(board):
    """What stands in the row of calibrations that a history kept."""
    columns = {"at": [], "verdicts": [], "reasons": [], "values": [], "covariances": []}
    remarks, kinds = [], []
    for earlier in board.calibrations[-MOST_SESSIONS:]:
        try:
            record = verify_files.decode_record("history, board %s" % board.board, earlier.record)
        except BadFile as error:
            remarks.append(str(error))
            continue
        kinds.append((record.chip, float(record.accel_range_g or math.nan),
                      float(record.gyro_range_dps or math.nan)))
        if kinds[-1] != kinds[0]:
            remarks.append("a calibration of another chip or range is left out")
            continue
        _add(columns, earlier.at, earlier.verdict, earlier.reason, parameters.of_record(record))
    if not kinds:
        raise BadFile("; ".join(remarks) or "no calibration in the history")
    return dict(columns, chip=kinds[0][0], accel_range_g=kinds[0][1], gyro_range_dps=kinds[0][2],
                remarks=list(dict.fromkeys(remarks)))


def estimates(board_row):
    """[parameters.Estimate] of the sessions in a row."""
    sessions = []
    for values, flat in zip(board_row["values"], board_row["covariances"]):
        covariance, start = {}, 0
        flat = np.array(flat, float)
        for block, names in parameters.BLOCKS.items():
            k = len(names)
            covariance[block] = flat[start:start + k * k].reshape(k, k)
            start += k * k
        sessions.append(parameters.Estimate(np.array(values, float), covariance))
    return sessions


def information(board_row, sensor):
    """effects.Information of a sensor in a row."""
    flat = board_row["precision_" + sensor]
    if not flat:
        return effects.nothing(sensor)
    k = len(effects.NAMES[sensor])
    precision = np.zeros((k, k))
    precision[np.triu_indices(k)] = flat
    precision += np.triu(precision, 1).T
    return effects.Information(precision, np.array(board_row["score_" + sensor], float))
