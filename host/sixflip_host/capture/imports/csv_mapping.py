"""What was said on the command line of somebody's columns and labels, and which of their labels
is which pose."""

import json
import re

import numpy as np

from sixflip.poses.faces import pose_code

from ... import atomic_write
from ...errors import BadFile, UsageError
from ..capture_header import ACCEL, GYRO, MAG
from ..capture_rows import quoted

TARGETS = ACCEL + GYRO + MAG + ("temp",)


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


def poses(options, labels, number, rows):
    """(int16 codes of samples by a column of labels or a file of sections, or None where there is
    neither; what was taken as moving). labels, number: as poses_from_labels takes them."""
    given = parse_pairs("--label", options.label)
    if options.label_column:
        pose, moving = poses_from_labels(labels, number, given)
    elif options.sections:
        pose, moving = poses_from_sections(options.sections, rows, given)
    else:
        return None, []
    if not pose.any():
        raise BadFile("%s: no label is a pose, expected --label THEIRS=Z+a for %s" % (
            options.sections or options.file, " ".join(moving)))
    return pose, moving
