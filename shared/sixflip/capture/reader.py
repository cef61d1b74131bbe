"""Reads the raw capture of blocks.py: whole, cut off anywhere, or damaged."""

import binascii
import struct
from array import array

from sixflip.capture import blocks as capture_samples
from sixflip.capture import blocks as cb
from sixflip.poses.faces import LEANING, MOST_LEANING
from sixflip.poses.placement import Placement

LOST = 7  # no board writes it: its names are dear
NAMES = ("ax", "ay", "az", "gx", "gy", "gz", "temp", "mx", "my", "mz")


class Blocks:
    """meta_bytes, columns (mask), names of the columns;
    t_us          array('q'): microseconds since the start of the session
    rows          array('h'): samples one after the other, len(names) counts each
    starts        array('l'): number of the first sample of every block of samples
    placements    accepted, in the order they were accepted (while they are read, all)
    withdrawn     codes of the poses that were taken back
    notes         texts
    lost          (first, n) of the samples that never came, by the board's count; missing: all
    samples       number taken (with sums_only or lost ones more than are here)
    sums_only     not all of the samples were kept; it shows in the poses where the end is missing
    ended         the last block is there; complete: and says that no pose is missing
    truncated_at  offset of the first byte that is not part of a whole block, or None
    damage        a sentence about it, or ""
    """

    def __init__(self, meta_bytes, columns):
        self.meta_bytes = meta_bytes
        self.columns = columns
        self.names = [NAMES[i] for i in cb.places(columns)]
        self.t_us = array("q")
        self.rows = array("h")
        self.starts = array("l")
        self.placements = []
        self.withdrawn = []
        self.until = {}  # (pose, first or -1): so many placements were there when it was withdrawn
        self.notes = []
        self.lost = []
        self.missing = 0
        self.samples = 0
        self.ended = False
        self.complete = False
        self.sums_only = False
        self.truncated_at = None
        self.damage = ""


def _header(data):
    size = struct.calcsize(cb.HEAD)
    if data[:4] != cb.MAGIC:
        raise ValueError("this is no capture of a board: it does not begin with %r" % cb.MAGIC)
    if len(data) < size:
        raise ValueError("the capture is cut off in its header")
    magic, version, columns, length = struct.unpack(cb.HEAD, data[:size])
    if not 1 <= version <= cb.VERSION:
        raise ValueError("capture version %d: expected 1 to %d" % (version, cb.VERSION))
    end = size + length
    if len(data) < end + 4:
        raise ValueError("the capture is cut off in its header")
    if struct.unpack("<I", data[end : end + 4])[0] != binascii.crc32(data[:end]):
        raise ValueError("the header of the capture is damaged: its CRC does not match")
    if columns & ~15 or not columns:
        raise ValueError("the capture has the column mask %d: expected 1 to 15" % columns)
    return Blocks(bytes(data[size:end]), columns), end + 4


def _unpack(form, payload):
    if len(payload) != struct.calcsize(form):
        raise ValueError("%d bytes where %d belong" % (len(payload), struct.calcsize(form)))
    return struct.unpack(form, payload)


def _samples(blocks, kind, payload):
    seconds, us, count = capture_samples.start(payload)
    t = seconds * cb.US + us
    if len(blocks.t_us) and t < blocks.t_us[-1]:
        raise ValueError("time runs backwards")
    times, rows = array("q"), array("h")
    row = array("h", [0] * len(blocks.names))
    for dt in capture_samples.each(kind, payload, count, row):
        t += dt
        times.append(t)
        rows.extend(row)
    blocks.starts.append(len(blocks.t_us))
    blocks.t_us.extend(times)
    blocks.rows.extend(rows)


def _lost(blocks, payload):
    first, n = _unpack("<II", payload)
    if first != len(blocks.t_us) + blocks.missing or n == 0:
        raise ValueError("samples %d to %d are lost after %d" % (
            first, first + n, len(blocks.t_us) + blocks.missing))
    blocks.lost.append((first, n))
    blocks.missing += n


def _pose(blocks, payload):
    v = _unpack(cb.PLACEMENT, payload)
    if not 0 < v[0] <= LEANING + MOST_LEANING or v[2] == 0:
        raise ValueError("pose %d of %d samples" % (v[0], v[2]))
    blocks.placements.append(
        Placement(v[0], v[1], v[2], list(v[4:11]), list(v[11:17]), v[3])
    )


def _withdrawn(blocks, payload):
    code, first = _unpack("<HI", payload) if len(payload) == 6 else _unpack("<H", payload) + (-1,)
    blocks.withdrawn.append(code)
    blocks.until[code, first] = len(blocks.placements)


def settle(blocks):
    """Takes out the placements that were withdrawn after they had been accepted, in one pass."""
    until = blocks.until
    if until:
        blocks.placements = [p for i, p in enumerate(blocks.placements)
                             if i >= until.get((p.pose, -1), 0)
                             and i >= until.get((p.pose, p.first), 0)]
        until.clear()


def _end(blocks, payload):
    blocks.samples, flags = _unpack(cb.FINISH, payload)
    blocks.ended = True
    blocks.sums_only = bool(flags & cb.SUMS_ONLY)
    if not blocks.sums_only and blocks.samples != len(blocks.t_us) + blocks.missing:
        raise ValueError(
            "%d samples were taken and %d are here" % (blocks.samples, len(blocks.t_us))
        )
    blocks.complete = bool(flags & cb.COMPLETE)


def _take(blocks, kind, payload):
    if kind == cb.SAMPLES or kind == cb.STEPS:
        _samples(blocks, kind, payload)
    elif kind == LOST:
        _lost(blocks, payload)
    elif kind == cb.POSE:
        _pose(blocks, payload)
    elif kind == cb.WITHDRAWN:
        _withdrawn(blocks, payload)
    elif kind == cb.NOTE:
        blocks.notes.append(str(bytes(payload), "utf-8", "replace"))
    elif kind == cb.END:
        _end(blocks, payload)


def read(data):
    """Blocks of the bytes of a capture; ValueError with a sentence if there is no header.

    Reading stops at the first block that is cut off or damaged; what came before it counts.
    """
    data = memoryview(data)
    blocks, at = _header(data)
    while at < len(data) and not blocks.damage:
        if blocks.ended:
            blocks.damage = "there are bytes after its end"
            break
        if at + 4 > len(data):
            blocks.damage = "it is cut off"
            break
        kind, zero, length = struct.unpack(cb.BLOCK, data[at : at + 4])
        end = at + 4 + length
        if end + 4 > len(data):
            blocks.damage = "it is cut off, or the length of a block is damaged"
        elif struct.unpack("<I", data[end : end + 4])[0] != binascii.crc32(data[at:end]):
            blocks.damage = "a block is damaged: its CRC does not match"
        else:
            try:
                _take(blocks, kind, data[at + 4 : end])
                at = end + 4
            except ValueError as error:
                blocks.damage = "a block is wrong: %s" % error
    settle(blocks)
    if not blocks.ended:
        here = len(blocks.t_us) + blocks.missing
        last = max([p.first + p.n for p in blocks.placements] + [here])
        blocks.sums_only = last > here
        blocks.samples = max(blocks.samples, last)
        blocks.damage = blocks.damage or "its end is missing"
    if blocks.damage:
        blocks.truncated_at = at
        blocks.complete = False
    return blocks
