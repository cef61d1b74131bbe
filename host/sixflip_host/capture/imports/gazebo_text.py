"""What `gz topic -e -t /imu` prints of gz.msgs.IMU, as text or, with --json-output, as JSON."""

import json
import re

import numpy as np

from ... import sample_limit
from ...errors import BadFile
from ..capture_rows import quoted
from ..unpack import Source, whole_lines
from .arrays import ArrayTable

LONGEST_LINE = 1 << 16
NAMES = ("stamp_s", "accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z")
OPENS, FIELD = re.compile(r"(\w+)\s*\{\Z"), re.compile(r"(\w+):\s*(.+)\Z")
# (path in a message, our column); protobuf prints no field that is 0
FIELDS = {("linear_acceleration", axis): "accel_" + axis for axis in "xyz"}
FIELDS.update({("angular_velocity", axis): "gyro_" + axis for axis in "xyz"})
FIELDS.update({("header", "stamp", "sec"): "sec", ("header", "stamp", "nsec"): "nsec"})


def looks_like(head):
    """True for the beginning of such a file, bytes."""
    start = head.lstrip()
    return (start.startswith(b"header {") and b"angular_velocity" in head) or (
        start.startswith(b"{") and b'"angularVelocity"' in head)


def read_text(path):
    """ArrayTable of the messages in a file; times count from the first one."""
    rows = []
    for row in _messages(path):
        rows.append(row)
        sample_limit.check_samples(path, len(rows))
    if not rows:
        raise BadFile("%s: no message of an IMU in it, expected what gz topic -e prints" % path)
    values = np.array(rows)
    seconds = values[:, 0] - values[0, 0] + (values[:, 1] - values[0, 1]) * 1e-9
    return ArrayTable(path, dict(zip(NAMES, [seconds, *values[:, 2:].T])),
                      {"a": "m/s2", "g": "rad/s"})


def _messages(path):
    """(sec, nsec, ax … gz) of every message."""
    fields, inside = {}, []
    for first, block in whole_lines(path, Source(path).pieces(), 1, LONGEST_LINE):
        for number, line in enumerate(block.decode("utf-8", "replace").split("\n"), first):
            line = line.strip()
            if line.startswith("{"):
                yield _of_json(path, number, line)
                continue
            opens, field = OPENS.match(line), FIELD.match(line)
            if opens:
                if not inside and opens[1] == "header" and fields:
                    yield _row(fields)
                    fields = {}
                inside.append(opens[1])
                fields.setdefault("", True)
            elif line == "}":
                if not inside:
                    raise BadFile.at(path, number, "a } that nothing opened", "a message")
                inside.pop()
            elif field:
                ours = FIELDS.get((*inside, field[1]))
                if ours:
                    fields[ours] = _number(path, number, field[1], field[2])
            elif line:
                raise BadFile.at(path, number, quoted(line), "a line of a message of gz topic")
    if inside:
        raise BadFile("%s: ends inside a message, it was cut short" % path)
    if fields:
        yield _row(fields)


def _row(fields):
    return [fields.get("sec", 0.0), fields.get("nsec", 0.0)] + [
        fields.get(name, 0.0) for name in NAMES[1:]]


def _number(path, line, name, text):
    try:
        return float(text)
    except (TypeError, ValueError):
        raise BadFile.at(path, line, "%s is %s" % (name, quoted(str(text))), "a number") from None


def _of_json(path, line, text):
    try:
        message = json.loads(text)
        stamp = message["header"]["stamp"]
        fields = {"sec": stamp.get("sec", 0), "nsec": stamp.get("nsec", 0)}
        for theirs, ours in (("linearAcceleration", "accel_"), ("angularVelocity", "gyro_")):
            fields.update({ours + axis: message[theirs].get(axis, 0.0) for axis in "xyz"})
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise BadFile.at(path, line, "no message of an IMU",
                         "header, angularVelocity, linearAcceleration") from None
    return _row({name: _number(path, line, name, value) for name, value in fields.items()})
