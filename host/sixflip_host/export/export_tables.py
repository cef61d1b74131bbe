"""A capture, raw or corrected, as Parquet or NPZ: what pandas, polars, MATLAB and numpy read.

Raw:        t_us, ax ay az, gx gy gz, temp, mx my mz in counts, pose; the capture's header as
            JSON says what they are worth.
Corrected:  t_us, ax_mps2 …, gx_radps …, temp_c, pose; the record that did it stands in the JSON.
"""

import io
import json

import numpy as np

from sixflip.poses.faces import pose_name

from .. import atomic_write
from ..calibrate.record_json import record_json
from ..capture.capture_header import ACCEL, GYRO, MAG
from ..optional import need
from .corrected_rows import corrected

KEY = "sixflip"             # of the JSON in the file's metadata


def columns(capture, record=None, tell=None):
    """{name: array (n,)} of a capture, corrected where there is a record.

    tell: as sixflip.record.correction.correction_of.
    """
    arrays = {"t_us": capture.t_us}
    if record is not None:
        values, names = corrected(record, capture, tell)
        arrays.update(zip(names, values.T))
    else:
        for group, block in ((ACCEL, capture.accel), (GYRO, capture.gyro), (MAG, capture.mag)):
            if block is not None:
                arrays.update(zip(group, block.T))
        if capture.temp is not None:
            arrays["temp"] = capture.temp
    if capture.pose is not None:
        arrays["pose"] = poses(capture)
    return arrays


def poses(capture):
    """Names of the poses, "" while moving; array (n,) of text."""
    names = {code: pose_name(code) for code in set(capture.pose.tolist())}
    return np.array([names[code] for code in capture.pose.tolist()], dtype="U8")


def about(capture, record=None):
    """The header of the capture, and the record that corrected it, as JSON."""
    said = {"format": 1, "kind": "sixflip capture" if record is None else "sixflip corrected",
            "capture": capture.meta}
    if record is not None:
        said["record"] = record_json(record)
    return json.dumps(said)


def parquet(output, capture, record=None, tell=None):
    """Write Parquet; the JSON stands under the key `sixflip` of the schema's metadata."""
    arrow, pq = need("format parquet", "data", "pyarrow", "pyarrow.parquet")
    table = arrow.table({
        name: arrow.array(values).dictionary_encode() if name == "pose" else arrow.array(values)
        for name, values in columns(capture, record, tell).items()})
    table = table.replace_schema_metadata({KEY: about(capture, record)})
    data = io.BytesIO()
    pq.write_table(table, data, compression="zstd")
    atomic_write.write_bytes(output, data.getvalue())


def npz(output, capture, record=None, tell=None):
    """Write NPZ; triples are one array (n, 3) each: accel, gyro, mag, or accel_mps2, gyro_radps.

    The JSON is the text `about`; nothing in the file needs pickle.
    """
    flat = columns(capture, record, tell)
    arrays = {}
    for name, group in (("accel", ACCEL), ("gyro", GYRO), ("mag", MAG),
                        ("accel_mps2", [axis + "_mps2" for axis in ACCEL]),
                        ("gyro_radps", [axis + "_radps" for axis in GYRO])):
        if group[0] in flat:
            arrays[name] = np.stack([flat.pop(axis) for axis in group], axis=1)
    data = io.BytesIO()
    np.savez_compressed(data, about=np.array(about(capture, record)), **flat, **arrays)
    atomic_write.write_bytes(output, data.getvalue())
