"""Summaries on disk: beside the capture, or in the cache where that folder cannot be written.

A summary knows the content of its capture by a hash, and its size and time of change, so that a
capture that is as it was is not read again. It is one .npz: arrays, and the rest as JSON.
"""
import hashlib
import io
import json
import os
import struct
import zipfile
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np

from .. import atomic_write
from ..capture import open_recording
from ..diagnosis import cutoffs
from ..errors import BadFile
from . import summary, summary_checks

FORMAT = 6
SUFFIX = ".summary.npz"
PIECE = 1 << 20
ARRAYS = {  # columns of each table
    "placement_of": 4, "placement_sums": 7, "placement_noise": 6, "move_of": 14 + summary.PATH,
    "halves": 3, "runs": 3}


def content_hash(path):
    """SHA-256 of a file, hex; BadFile where it cannot be read."""
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            while piece := file.read(PIECE):
                digest.update(piece)
    except OSError as error:
        raise BadFile("%s: cannot be read: %s" % (path, error.strerror)) from None
    return digest.hexdigest()


def stamp(path):
    """[size, time of change in ns] of a file; BadFile where there is none."""
    try:
        about = os.stat(path)
    except OSError as error:
        raise BadFile("%s: cannot be read: %s" % (path, error.strerror)) from None
    return [about.st_size, about.st_mtime_ns]


def encode(summarised):
    """The bytes of a Summary."""
    file = io.BytesIO()
    about = json.dumps(summarised.about, allow_nan=False).encode()
    np.savez_compressed(file, about=np.frombuffer(about, np.uint8), **summarised.arrays)
    return file.getvalue()


def decode(path, data):
    """A Summary from bytes; BadFile where they are none."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as kept:
            arrays = {name: kept[name] for name in kept.files}
        about = json.loads(arrays.pop("about").tobytes())
        if about["format"] != FORMAT:
            raise BadFile("%s: is a summary of layout %s, expected %d: delete it, it is made "
                          "again" % (path, about["format"], FORMAT))
        summary_checks.arrays(arrays, ARRAYS)
        summarised = summary.Summary(summary_checks.about(about), arrays)
        summarised.session()
    except (OSError, ValueError, TypeError, KeyError, IndexError, EOFError, RecursionError,
            MemoryError, AttributeError, zipfile.BadZipFile, zlib.error, NotImplementedError,
            struct.error) as error:
        raise BadFile("%s: is no summary or a damaged one (%s), expected one that sixflip fleet "
                      "wrote" % (path, str(error)[:80].replace("\n", " "))) from None
    return summarised


def read(path):
    """A Summary from its own file."""
    return decode(path, atomic_write.read_bytes(path))


def of_capture(path, keep=True):
    """(Summary, sentence or ""): of the capture in a file, the kept one where that is of it. The
    sentence says why it could not be kept."""
    now = stamp(path)
    digest = None
    for kept in places(path):
        try:
            earlier = read(kept)
        except BadFile:
            continue
        if earlier.about.get("stamp") == now:
            return earlier, ""
        digest = digest or content_hash(path)
        if earlier.about.get("hash") == digest:
            return earlier, ""
    digest = digest or content_hash(path)
    made = summary.summarise(os.path.basename(path), open_recording.read_samples(path))
    made = replace(made, about=dict(made.about, format=FORMAT, hash=digest, stamp=now))
    return made, _kept(path, made) if keep else ""


def places(path):
    """Where the summary of a capture may lie: beside it, and in the cache."""
    name = hashlib.sha256(os.path.abspath(path).encode()).hexdigest()[:32]
    return [Path(str(path) + SUFFIX), cutoffs.folder().parent / "summaries" / (name + SUFFIX)]


def _kept(path, made):
    data, why = encode(made), ""
    for place in places(path):
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            atomic_write.write_bytes(str(place), data)
            return ""
        except (BadFile, OSError) as error:
            why = why or str(error)
    return "its summary could not be kept: %s" % why
