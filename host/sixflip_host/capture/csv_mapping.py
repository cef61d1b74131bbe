"""Which column of somebody's CSV is which of ours, and which of their labels is which pose."""

import json
import re

import numpy as np

from sixflip.pose_codes import pose_code

from .. import atomic_write
from ..errors import BadFile, UsageError
from .capture_header import ACCEL, GYRO, MAG
from .capture_rows import quoted

TARGETS = ACCEL + GYRO + MAG + ("temp",)
SPELLINGS = {"a": ("a", "acc", "accel", "accelerometer", "acceleration", "linacc"),
             "g": ("g", "gyr", "gyro", "gyroscope", "w", "omega")}


def spelling(name):
    """Our name for a column by one of its usual names, or None: acc_x, AccX, accel_x[g] -> ax."""
    bare = re.sub(r"[\[(].*", "", name.lower()).strip()
    match = re.match(r"([a-z]+?)[ _.]?(raw)?[ _.]?([xyz])(_?raw)?\Z", bare)
    if match:
        for letter, words in SPELLINGS.items():
            if match.group(1) in words:
                return letter + match.group(3)
    return None


def looks_like_header(names):
    """True for a line of names that has all three axes of an accelerometer."""
    return set(ACCEL) <= {spelling(name) for name in names}


def parse_pairs(option, words):
    """`ax=acc_x` `gx=3` -> {"ax": "acc_x", "gx": "3"}; also comma separated."""
    pairs = {}
    for word in ",".join(words or ()).split(","):
        if not word:
            continue
        left, equals, right = word.partition("=")
        if not equals or not right:
            raise UsageError("%s %s: expected NAME=VALUE" % (option, quoted(word)))
        pairs[left] = right
    return pairs


def choose_columns(table, given):
    """{our name: column of the table}; what is given wins, the rest goes by its usual name."""
    for name in given:
        if name not in TARGETS:
            raise UsageError("--map %s: expected one of %s" % (name, " ".join(TARGETS)))
        table.index(given[name])
    chosen = dict(given)
    for name in table.names or ():
        ours = spelling(name)
        if ours and ours not in chosen and name not in chosen.values():
            chosen[ours] = name
    for group in (ACCEL, GYRO, MAG):
        there = [name for name in group if name in chosen]
        if len(there) < 3 and (there or group is ACCEL):
            absent = next(name for name in group if name not in chosen)
            raise BadFile("%s: no column for %s, expected --map %s=NAME with one of %s" % (
                table.path, absent, absent, " ".join(
                    table.names or ["1 to %d" % table.width])))
    return chosen


def label_pose(label, given):
    """Pose code of somebody's label, 0 for what is no still face.

    Ours (Z+a, L3), a face alone (Z+: taken as its `a`), imucal's x_p (+x up) and x_a (-x up).
    """
    if label in given:
        name = given[label]
    else:
        match = re.match(r"([xyzXYZ])_([pa])\Z", label)
        name = match.group(1).upper() + "+-"[match.group(2) == "a"] + "a" if match else label
    for attempt in (name, name + "a"):
        try:
            return pose_code(attempt)
        except ValueError:
            pass
    if label in given and given[label] not in ("", "moving"):
        raise UsageError("--label %s=%s: expected a pose such as Z+a, or moving" % (
            label, given[label]))
    return 0


def poses_from_labels(labels, number, given):
    """int16 codes of samples with labels[number], and the labels that were taken as moving.

    labels  distinct ones; number: int (n,), which of them a sample has
    """
    codes = [label_pose(label, given) for label in labels]
    ignored = sorted(label for label, code in zip(labels, codes) if label and not code)
    return np.array(codes, np.int16)[number], ignored


def poses_from_sections(path, rows, given):
    """int16 codes for `rows` samples from a JSON file of sections.

    {"x_p": {"start": 540, "end": 1271}, …} or [{"label": "x_p", "start": …, "end": …}, …];
    sample numbers from 0, end not included. Also the labels that were taken as moving.
    """
    expected = 'sections such as {"x_p": {"start": 540, "end": 1271}}'
    try:
        content = json.loads(atomic_write.read_bytes(path).decode("utf-8"))
        sections = [(name, one["start"], one["end"]) for name, one in content.items()] \
            if isinstance(content, dict) else \
            [(one["label"], one["start"], one["end"]) for one in content]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise BadFile("%s: %s, expected %s" % (path, quoted(str(error)), expected))
    poses = np.zeros(rows, np.int16)
    ignored = []
    for label, start, end in sections:
        if type(start) is not int or type(end) is not int or not 0 <= start < end <= rows:
            raise BadFile("%s: section %s goes from %s to %s, expected 0 <= start < end <= %d"
                          % (path, quoted(str(label)), start, end, rows))
        code = label_pose(str(label), given)
        if not code:
            ignored.append(str(label))
        elif poses[start:end].any():
            raise BadFile("%s: section %s overlaps another one" % (path, quoted(str(label))))
        else:
            poses[start:end] = code
    return poses, ignored
