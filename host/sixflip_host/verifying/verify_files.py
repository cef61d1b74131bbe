"""Which capture and which record `verify` compares."""

import os
import struct

from sixflip import correction_record, record_terms
from sixflip.mounting import parse_axes
from sixflip.scale_form import scale_form

from .. import atomic_write
from ..capture import capture_file
from ..errors import BadFile, UsageError

CAPTURES = ("capture.bin", "capture.csv", "capture.csv.gz")
RECORDS = ("record_a.bin", "record_b.bin")


def decode_record(path, data):
    """A Record from bytes; BadFile with the sentence that says why not."""
    try:
        record = correction_record.decode(data)
        record_terms.terms(record)
        for fields in (record.accel, record.gyro):
            if fields is not None:
                scale_form(fields["P"])     # raises where it cannot be a correction
        if record.mounting is not None and record.mounting["axes"]:
            parse_axes(record.mounting["axes"])
        return record
    except (ValueError, IndexError, struct.error) as error:
        raise BadFile("%s: %s" % (path, error))


def read_record(path):
    """A Record from a file, likewise."""
    return decode_record(path, atomic_write.read_bytes(path))


def find(names):
    """(path, Capture, path, Record) from what stands on the command line.

    names   [folder] as `pull` left it, or [capture, record]
    """
    if len(names) == 2:
        return names[0], capture_file.read(names[0]), names[1], read_record(names[1])
    folder = names[0]
    if not os.path.isdir(folder):
        raise UsageError("%s: expected a folder with a capture and records, or CAPTURE RECORD"
                         % folder)
    paths = [os.path.join(folder, name) for name in CAPTURES]
    there = [path for path in paths if os.path.exists(path)]
    if not there:
        raise BadFile("%s: no capture in it, expected %s" % (folder, " or ".join(CAPTURES)))
    capture = capture_file.read(there[0])
    path, record = _record_of(folder, capture.meta.get("session"))
    return there[0], capture, path, record


def _record_of(folder, session):
    """The newest readable record, one of this session when there is one."""
    good, faults = [], []
    for name in RECORDS:
        path = os.path.join(folder, name)
        if not os.path.exists(path):
            continue
        try:
            good.append((path, read_record(path)))
        except BadFile as error:
            faults.append(str(error))
    if not good:
        raise BadFile("; ".join(faults) or "%s: no record in it, expected %s" % (
            folder, " or ".join(RECORDS)))
    return max(good, key=lambda one: (one[1].session == session, one[1].sequence))


def record_before(path, record):
    """The record in the other slot, when that is the one before and has a gyro; or None."""
    folder, name = os.path.split(path)
    for slot in RECORDS:
        other = os.path.join(folder, slot)
        if slot == name or name not in RECORDS or not os.path.exists(other):
            continue
        try:
            older = read_record(other)
        except BadFile:
            continue
        if older.sequence < record.sequence and older.gyro:
            return older
    return None
