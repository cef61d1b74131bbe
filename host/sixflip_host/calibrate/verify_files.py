"""Which capture and which record `verify` compares."""

import functools
import os
import struct

from sixflip.record import correction_record
from sixflip.record.record import implausible, newer

from .. import atomic_write, record_terms
from ..capture import capture_file, chip_scales
from ..errors import BadFile, UsageError

CAPTURES = ("capture.bin", "capture.csv", "capture.csv.gz")
RECORDS = ("record_a.bin", "record_b.bin")


def decode_record(path, data):
    """A Record from bytes; BadFile with the sentence that says why not."""
    try:
        record = correction_record.decode(data)
        record_terms.terms(record)
    except (ValueError, IndexError, struct.error) as error:
        raise BadFile("%s: %s" % (path, error))
    reason = implausible(record)
    wrong = chip_scales.wrong(record.chip, record.accel_range_g, record.accel_lsb_per_g,
                              record.gyro_range_dps, record.gyro_lsb_per_dps)
    if wrong and not reason:
        reason = "%s, expected %s" % wrong
    if reason:
        raise BadFile("%s: the record cannot be a sensor's: %s" % (path, reason))
    return record


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
    newest = newest_of([record for _, record in good if record.session == session]
                       or [record for _, record in good])
    return next(one for one in good if one[1] is newest)


def newest_of(records):
    """The Record that was saved last."""
    return functools.reduce(
        lambda last, one: one if newer(one.sequence, last.sequence) else last, records)


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
        if newer(record.sequence, older.sequence) and older.gyro:
            return older
    return None


def accelerometer_record(path):
    """The Record in a file; BadFile when it corrects no accelerometer."""
    record = read_record(path)
    if record.accel is None:
        raise BadFile("%s: expected a record with an accelerometer correction in it" % path)
    return record


def fits(record, capture):
    """BadFile unless the record is of this kind of sensor and range."""
    meta = capture.meta
    if record.chip != meta["sensor"] or \
            abs(record.accel_lsb_per_g - meta["accel_lsb_per_g"]) > 5.1e-4:
        raise BadFile("the record is for a %s at %g counts per g, the capture of a %s at %g: "
                      "expected a record of this sensor" % (
                          record.chip, record.accel_lsb_per_g, meta["sensor"],
                          meta["accel_lsb_per_g"]))
