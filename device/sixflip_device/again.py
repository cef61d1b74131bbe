"""The session before goes on, or one face of it is taken again: what there is is taken over.

Its capture is copied block by block into the new one. How long ago it was nobody knows: the
time goes on after GAP_S, a note says so, and no move across it is used. Both placements of the
face are taken again, so that it has a tilt of its own if the table was moved meanwhile; but
the sensor must be as warm as it was, for a bias that drifts is not the table's.
"""

import json
import os
from array import array

from sixflip import capture_blocks as cb
from sixflip.capture_moves import CaptureMoves
from sixflip.capture_scan import Scan
from sixflip.capture_writer import BlockWriter
from sixflip.faces import FACES

from .bus_recovery import READ
from .capture_meta import columns, meta_bytes
from .flash_files import GOOD, NEW, REFUSED, free_bytes, remove

GAP_S = 60
WARMER_C = 3.0  # 2.7 mg at the 0.9 mg/degC typical of an MPU6050's Z axis
RESERVE = 32768  # bytes that stay free beside the copy
SAME = ("sensor", "who_am_i", "accel_lsb_per_g", "gyro_lsb_per_dps", "rate_hz")


def _last(root):
    """The newest session's file and its Scan, gone through; ValueError."""
    for name in (REFUSED, GOOD):
        try:
            with open(root + name, "rb") as f:
                scan = Scan(f)
                for _ in scan.each():
                    pass
        except OSError:
            continue
        if not scan.blocks.placements:
            raise ValueError("the session before has no accepted pose")
        return name, scan
    raise ValueError("there is no session before this one")


def _fits(unit, scan, number):
    """ValueError when the session was another sensor's, or a colder one's."""
    old = json.loads(str(scan.blocks.meta_bytes, "utf-8"))
    new = json.loads(str(meta_bytes(unit, number), "utf-8"))
    for key in SAME:
        if old.get(key) != new.get(key):
            raise ValueError("%s was %s in the session before and is %s"
                             % (key, old.get(key), new.get(key)))
    imu = unit.sensor.imu
    if scan.blocks.columns != columns(imu):
        raise ValueError("the session before has other columns")
    sample = array("h", [0] * 7)
    if imu.has_temp and unit.sensor.read_into(sample) == READ:
        n = sum([p.n for p in scan.blocks.placements])
        mean = sum([p.sums[6] for p in scan.blocks.placements]) / n
        warmer = (sample[6] - mean) / imu.temp_lsb_per_c
        if abs(warmer) > WARMER_C:
            raise ValueError("the sensor is %.1f degC %s than in the session before, %.0f is "
                             "the limit" % (abs(warmer), "warmer" if warmer > 0 else "colder",
                                            WARMER_C))


def _unfinished(placements):
    """ValueError when there is nothing to go on with."""
    if [p for p in placements if p.pose > 12]:
        raise ValueError("the session before followed a plan")
    if len(placements) == 12:
        raise ValueError("nothing is missing in the session before")


def _copy(unit, name, asked, scan):
    """The file as it was, but for its header and its end."""
    root = unit.board.root
    free = free_bytes(root)
    if scan.blocks.sums_only:
        asked.reason = "the session before kept only the sums"
    elif free is not None and free < os.stat(root + name)[6] + RESERVE:
        asked.reason = "no room for a copy of the session before"
    asked.sums_only = asked.reason != ""
    asked.kept = 0 if asked.sums_only else asked.samples
    moves = CaptureMoves(asked.placements, scan.blocks.columns,
                         int(1000000 / unit.settings["rate_hz"] + 0.5), unit.sensor.imu.gyro_rail)
    with open(root + NEW, "wb") as f:
        meta = meta_bytes(unit, asked.session)
        new = BlockWriter(f.write, meta, scan.blocks.columns, 1)
        with open(root + name, "rb") as g:
            for kind, block in Scan(g).each():
                samples = kind in (cb.SAMPLES, cb.STEPS)
                if samples:
                    moves.block(block)
                if kind != cb.END and not (samples and asked.sums_only):
                    f.write(block)
        new.note("%s, after a pause of unknown length: %d s stand for it"
                 % (FACES[asked.face] + " again" if asked.face >= 0 else "continued", GAP_S))
        asked.bytes = f.tell()
    asked.moves = moves.moves()


def run(unit):
    asked = unit.taken
    unit.taken = None
    asked.session = int.from_bytes(os.urandom(4), "little")
    try:
        name, scan = _last(unit.board.root)
        blocks = scan.blocks
        if asked.face < 0:
            _unfinished(blocks.placements)
        _fits(unit, scan, asked.session)
        asked.placements = blocks.placements
        last = blocks.placements[-1]
        asked.samples = max(blocks.samples, last.first + last.n)
        asked.seconds, asked.us = scan.seconds + GAP_S, scan.us
        asked.reason = ""
        _copy(unit, name, asked, scan)
    except (ValueError, OSError) as e:
        remove(unit.board.root + NEW)
        if asked.face < 0:
            unit.events.emit("afresh", reason=str(e))
            return "sampling"
        unit.events.error("face %s cannot be taken again: %s" % (FACES[asked.face], e),
                          "calibrate all faces")
        return "put_in_force"
    unit.taken = asked
    return "sampling"
