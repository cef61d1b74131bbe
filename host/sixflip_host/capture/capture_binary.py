"""The board's own capture file, by the shared codec, to and from a Capture."""

import json

import numpy as np

from sixflip.capture.blocks import ACCEL, GAP_US, GROUPS, GYRO, MAG, TEMP
from sixflip.capture.reader import read as read_blocks
from sixflip.capture.writer import BlockWriter

from .. import sample_limit
from ..errors import BadFile
from . import board_extras
from .board_extras import EXTRAS, LOST, PAUSES
from .capture import Capture
from .capture_header import check_meta
from .capture_rows import quoted

LATE = 1.5              # an interval so many times the usual one covers another sample's time
MANY_TIMES = 100_000    # enough to say what is usual: an hour takes no more memory than a minute
UNLABELLED = "nobody labelled the poses"
BLOCK_SAMPLES = 256
MOST_BYTES = 32             # of a board's file for a sample, its share of a block included
LATEST_US = (1 << 32) * 1000000


def is_empty(data):
    """True for a board's file that holds nothing: its session ended, or the power was cut, before
    anything was captured."""
    try:
        blocks = read_blocks(data)
    except ValueError:
        return False
    return not (blocks.rows or blocks.placements)


def decode(data, path="capture"):
    """A Capture from the bytes of a board's file; readable up to the last whole block.

    board_placements  what the board summed up itself, as sixflip.poses.placement.Placement
    truncated         a sentence when the file was cut off or damaged, else None
    sums_only         the board had no room for all samples: taken says how many there were
    Raises BadFile when there is no readable header or not one sample.
    """
    try:
        blocks = read_blocks(data)
    except ValueError as error:
        raise BadFile("%s: %s" % (path, error))
    meta = _meta(path, blocks)
    width = len(blocks.names)
    rows = _array(blocks.rows, np.int16).reshape(-1, width)
    if not len(rows) and not blocks.placements:
        raise BadFile("%s: %s, and before it there is not one sample" % (
            path, blocks.damage or "the capture is empty"))
    sample_limit.check_samples(path, len(rows))
    named = {name: rows[:, index:index + 3] for index, name in enumerate(blocks.names)}
    capture = Capture(meta, _array(blocks.t_us, np.int64), named["ax"], named.get("gx"),
                      named["temp"][:, 0] if "temp" in named else None, named.get("mx"))
    capture.board_placements = blocks.placements
    capture.sums_only = blocks.sums_only or not len(rows)
    if UNLABELLED not in blocks.notes:
        capture.pose = _labels(path, blocks)
    # of a file that encode() made the blocks tell nothing of pauses
    kept = meta.pop(EXTRAS, None)
    extras = {"complete": blocks.complete, "withdrawn": blocks.withdrawn,
              "notes": [note for note in blocks.notes if note != UNLABELLED],
              "truncated": blocks.damage or None}
    extras.update({name: kept.get(name) for name in (PAUSES, LOST)}
                  if isinstance(kept, dict) else _gaps(blocks))
    extras = {name: value for name, value in extras.items() if value}
    if capture.sums_only:
        extras.update(taken=blocks.samples,
                      placements=[board_extras.as_json(each) for each in blocks.placements])
    if extras:
        meta[EXTRAS] = extras
    board_extras.take(capture, path)
    return capture


def _gaps(blocks):
    """What the recorder is to blame for, as it stands in a text made of the capture."""
    gaps = {PAUSES: write_pauses_us(blocks)}
    if blocks.lost:
        rows = [first - sum(n for _, n in blocks.lost[:k])
                for k, (first, _) in enumerate(blocks.lost)]
        times = [blocks.t_us[row - 1] for row in rows if 0 < row < len(blocks.t_us)]
        gaps = {PAUSES: [t for t in gaps[PAUSES] if t not in times],
                LOST: [blocks.missing, times]}
    return gaps


def write_pauses_us(blocks):
    """Times of the samples after which the board was late because it wrote to its flash.

    A full block is written when the first sample of the next one has been read, a pose's block
    after its last sample: an interval beside the start of a block that is longer than LATE
    usual ones is such a write. A longer one than GAP_US before a start begins a block by
    itself; it counts only where a placement ends.
    """
    t_us = _array(blocks.t_us, np.int64)
    if len(t_us) < 2:
        return []
    starts = np.array(blocks.starts[1:], np.int64)
    ends = [one.first + one.n for one in blocks.placements]
    before = starts[(t_us[starts] - t_us[starts - 1] <= GAP_US) | np.isin(starts, ends)] - 1
    beside = np.union1d(before, starts[starts < len(t_us) - 1])
    return t_us[beside[t_us[beside + 1] - t_us[beside] > LATE * usual_us(t_us)]].tolist()


def usual_us(t_us):
    """The median interval, by the first MANY_TIMES of int64 (n,) times, µs."""
    return float(np.median(np.diff(t_us[:MANY_TIMES])))


def write_pauses(capture):
    """Indices of the intervals in which the board wrote to its flash instead of reading; of a
    board's file or of a text made from one."""
    return _intervals(capture, board_extras.from_meta(capture.meta, "the capture").pauses)


def lost_on_the_way(capture):
    """(samples, indices of the intervals they are missing in) that the link lost while a
    recording came from the board: the sensor and the board had them."""
    lost = board_extras.from_meta(capture.meta, "the capture").lost
    return (lost[0], _intervals(capture, lost[1])) if lost else (0, np.zeros(0, int))


def _intervals(capture, times):
    """Indices of the intervals that begin at times."""
    return np.flatnonzero(np.isin(capture.t_us[:-1], times))


def _meta(path, blocks):
    try:
        meta = json.loads(blocks.meta_bytes.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise BadFile("%s: its metadata is no JSON: %s" % (path, quoted(str(error))))
    if not isinstance(meta, dict):
        raise BadFile("%s: its metadata is JSON, but not an object" % path)
    if "ax" not in blocks.names:
        raise BadFile("%s: it has no accelerometer" % path)
    check_meta(meta, blocks.names, lambda found, expected: BadFile(
        "%s: in its metadata %s, expected %s" % (path, found, expected)))
    meta.pop("samples", None)
    return meta


def _array(buffer, dtype):
    """A numpy array of what the shared reader found, in the same memory."""
    return np.frombuffer(buffer, dtype) if len(buffer) else np.zeros(0, dtype)


def _labels(path, blocks):
    """int16 codes of every sample from the placements in force."""
    pose = np.zeros(len(blocks.t_us), np.int16)
    for placement in blocks.placements:
        if len(pose) and placement.first + placement.n > len(pose) + blocks.missing and not (
                blocks.damage or blocks.sums_only):
            raise BadFile("%s: a pose ends at sample %d of %d" % (
                path, placement.first + placement.n, len(pose) + blocks.missing))
        end = placement.first + placement.n
        pose[_here(blocks, placement.first):_here(blocks, end)] = placement.pose
    return pose


def _here(blocks, number):
    """Row of the first sample from this number on, by the board's count, in which those that
    were lost have numbers, too."""
    return number - sum(min(n, number - first) for first, n in blocks.lost if first < number)


def encode(capture):
    """The bytes of a board's file for a Capture; its times count from 0."""
    if not len(capture):
        raise BadFile("the board kept only the sums of this capture: no samples to write")
    if capture.t_us[0] < 0 or capture.t_us[-1] >= LATEST_US:
        raise BadFile("the times go from %d to %d us, a board's file holds 0 to %d" % (
            capture.t_us[0], capture.t_us[-1], LATEST_US - 1))
    meta = dict(capture.meta)
    extras = board_extras.from_meta(meta, "the capture")
    meta[EXTRAS] = {PAUSES: extras.pauses, LOST: extras.lost}
    data = bytearray()      # the writer's buffer is used again: copy what it hands over
    mask = ACCEL | (GYRO if capture.gyro is not None else 0) \
        | (TEMP if capture.temp is not None else 0) | (MAG if capture.mag is not None else 0)
    try:
        writer = BlockWriter(data.extend, json.dumps(meta, allow_nan=False).encode(), mask,
                             BLOCK_SAMPLES)
    except ValueError as error:
        raise BadFile("the capture cannot be written as a board's file: %s" % error)
    _write_samples(writer, capture)
    for note in [UNLABELLED] * (capture.pose is None) + extras.notes:
        writer.note(note)
    for code in extras.withdrawn:
        writer.withdraw(code)
    for placement in capture.placements():
        writer.pose(placement)
    if extras.placements is not None:
        writer.sums_only, writer.samples = True, max(len(capture), extras.taken)
    writer.end(extras.complete)
    return bytes(data)


def _write_samples(writer, capture):
    blocks = {ACCEL: capture.accel, GYRO: capture.gyro, TEMP: capture.temp, MAG: capture.mag}
    rows = np.zeros((len(capture), 10), int)
    for mask, first, width in GROUPS:
        if blocks[mask] is not None:
            rows[:, first:first + width] = blocks[mask].reshape(len(capture), width)
    intervals = np.diff(capture.t_us, prepend=0).tolist()
    for interval, row in zip(intervals, rows.tolist()):
        writer.add(interval, row)
