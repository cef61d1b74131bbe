"""The rows of a text capture: a block at once with numpy, or one by one to name the first fault.

The fast way accepts nothing but `-?[0-9]+` in a count column and a known pose name in `pose`;
whatever it does not accept goes the slow way, which either reads it too or says what is wrong
and in which line. Both give the same numbers.
"""

import re

import numpy as np

from sixflip import RAIL
from sixflip.poses.faces import pose_code, pose_name

from ..errors import BadFile
from .growing import Growing
from .unpack import whole_lines

INT16 = (-RAIL - 1, RAIL)
TIMES = (-(1 << 62), (1 << 62) - 1)      # differences still fit into 64 bits
LONGEST_ROW = 1 << 16       # bytes
GROUPS = (("t_us",), ("ax", "ay", "az"), ("gx", "gy", "gz"), ("temp",), ("mx", "my", "mz"),
          ("pose",))
FAST_DIGITS = 18            # what a sum in int64 can hold without looking
WHOLE_NUMBER = re.compile(r"\s*([+-]?[0-9]+)\s*\Z", re.ASCII)


def parse_rows(path, blocks, columns, first_line, samples=None):
    """Rows of a capture -> {group: array}, as many groups as there are columns of.

    blocks      pieces of the text behind the line of column names
    columns     names in the order of the file
    first_line  line number of the first row, for the error
    samples     rows that are promised, or None
    The groups: "t_us" int64 (n,), "ax", "gx", "mx" int16 (n, 3), "temp" int16 (n,), "pose" int16
    codes (n,). Raises BadFile with the line number and what was expected.
    """
    groups = [group for group in GROUPS if group[0] in columns]
    parts = {group: Growing(np.int64 if group[0] == "t_us" else np.int16,
                            len(group) if len(group) > 1 else None) for group in groups}
    last = None
    for line, body in whole_lines(path, blocks, first_line, LONGEST_ROW):
        if samples is not None and not body.endswith(b"\n") and line - first_line < samples:
            raise BadFile.at(path, line, "the file was cut short in its row %d" % (
                line - first_line + 1), "%d rows" % samples)
        values = _fast(body, columns)
        if values is None:
            values = _slow(path, body, columns, line)
        last = _forwards(path, values["t_us"], last, line)
        for group, part in parts.items():
            part.add(values[group[0]] if len(group) == 1 else
                     np.stack([values[name] for name in group], axis=1))
    return {group[0]: part.array() for group, part in parts.items()}


def _forwards(path, times, last, line):
    """The last of the times of a block; BadFile where one of them is before the one before it."""
    steps = np.diff(times, prepend=times[0] if last is None else last)
    backwards = np.flatnonzero(steps < 0)
    if len(backwards):
        row = int(backwards[0])
        raise BadFile.at(path, line + row, "t_us runs backwards, from %d to %d"
                         % (times[row] - steps[row], times[row]), "a time that does not decrease")
    return times[-1]


def _fast(body, columns):
    """Every field of every row in a few passes over the bytes; None where a field is unusual."""
    raw = np.frombuffer(body, np.uint8)
    ends = np.flatnonzero((raw == ord(",")) | (raw == ord("\n")))
    width = len(columns)
    if not len(ends) or len(ends) % width:
        return None
    is_line_end = (raw[ends] == ord("\n")).reshape(-1, width)
    if not is_line_end[:, -1].all() or is_line_end[:, :-1].any():
        return None
    starts = np.concatenate(([0], ends[:-1] + 1)).reshape(-1, width)
    ends = ends.reshape(-1, width)
    values = {}
    for index, name in enumerate(columns):
        read = _fast_poses if name == "pose" else _fast_integers
        column = read(raw, starts[:, index], ends[:, index])
        if column is None:
            return None
        if name not in ("t_us", "pose"):
            if column.min() < INT16[0] or column.max() > INT16[1]:
                return None
            column = column.astype(np.int16)
        values[name] = column
    return values


def _fast_integers(raw, start, end):
    """int64 values of the fields raw[start:end], or None when one is not plain digits."""
    negative = raw[start] == ord("-")
    start = start + negative
    length = end - start
    longest = int(length.max())
    if length.min() < 1 or longest > FAST_DIGITS:
        return None
    value = np.zeros(len(start), np.int64)
    for place in range(longest):
        inside = place < length
        digit = raw[np.where(inside, start + place, start)].astype(np.int64) - ord("0")
        if (digit < 0).any() or (digit > 9).any():
            return None
        value = np.where(inside, value * 10 + digit, value)
    return np.where(negative, -value, value)


def _fast_poses(raw, start, end):
    """int16 pose codes: a name is looked up once for every run of the same bytes."""
    length = end - start
    longest = int(length.max())
    if longest > 8:
        return None
    key = np.zeros(len(start), np.uint64)
    for place in range(longest):
        inside = place < length
        byte = raw[np.where(inside, start + place, 0)].astype(np.uint64)
        if not byte[inside].all():
            return None
        key = np.where(inside, key * np.uint64(256) + byte, key)
    names, inverse = np.unique(key, return_inverse=True)
    codes = []
    for name in names.tolist():
        text = name.to_bytes(8, "big").lstrip(b"\0").decode("latin-1")
        code = _pose(text)
        if code is None:
            return None
        codes.append(code)
    return np.array(codes, np.int16)[inverse.reshape(-1)]


def _pose(text):
    """The code of a pose name, 0 for none, or None for what is not one."""
    if not text:
        return 0
    try:
        code = pose_code(text)
    except ValueError:
        return None
    return code if code and pose_name(code) == text else None


def _slow(path, body, columns, first_line):
    """One row after the other; ends at the first fault."""
    lines = body.split(b"\n")
    if lines[-1]:
        raise BadFile.at(path, first_line + len(lines) - 1,
                         "the last line has no newline, the file was cut short",
                         "%d values and a newline" % len(columns))
    table = {name: [] for name in columns}
    for number, line in enumerate(lines[:-1], first_line):
        for name, value in zip(columns, _slow_row(path, number, line, columns)):
            table[name].append(value)
    return {name: np.array(values, np.int64 if name == "t_us" else np.int16)
            for name, values in table.items()}


def _slow_row(path, number, line, columns):
    """The values of one line, or BadFile."""
    width = line.count(b",") + 1
    if width != len(columns):
        raise BadFile.at(path, number, "%d values" % (width if line.strip() else 0),
                         "%d: %s" % (len(columns), ",".join(columns)))
    try:
        fields = line.decode("utf-8").split(",")
    except UnicodeDecodeError:
        raise BadFile.at(path, number, "bytes that are not UTF-8 text",
                         "%d values" % len(columns))
    return [_slow_value(path, number, name, field) for name, field in zip(columns, fields)]


def _slow_value(path, number, name, field):
    """One field: a pose code or a whole number in its range, or BadFile."""
    if name == "pose":
        code = _pose(field.strip())
        if code is None:
            raise BadFile.at(path, number, "unknown pose %s" % quoted(field),
                             "Z+a, Z+b, Z-a ... Y-b, L1, L2 ... or nothing")
        return code
    match = WHOLE_NUMBER.match(field)
    if not match:
        seen = "%s is missing" % name if not field.strip() else \
            "%s is %s" % (name, quoted(field))
        raise BadFile.at(path, number, seen, "a whole number of %s"
                         % ("microseconds" if name == "t_us" else "counts"))
    low, high = TIMES if name == "t_us" else INT16
    digits = match.group(1)
    if len(digits) > 20 or not low <= int(digits) <= high:
        raise BadFile.at(path, number, "%s is %s" % (name, quoted(digits)),
                         "%d to %d" % (low, high))
    return int(digits)


def quoted(text):
    """A piece of a file for an error line: in quotes, and short."""
    return '"%s"' % (text if len(text) <= 40 else text[:37] + "...")
