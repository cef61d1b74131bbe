"""Which reader a file needs: told by its content, or by `--from`."""

import os
import re

from ...errors import BadFile, UsageError
from ...file_kinds import head_of
from ..capture_file import BOARD_MAGIC
from . import arrays, column_names, conversion, gazebo_text, px4_ulog, ros_bag
from .csv_table import read_table
from .options import Options, check_options

__all__ = ["Options", "PRESETS", "convert", "open_table"]

# What --from takes: what such a file is, for a person who gave another one.
PRESETS = {
    "ros2": "a rosbag2 folder, .db3, .mcap, .bag, or a CSV with the fields of sensor_msgs/Imu",
    "px4": "a ULog",
    "betaflight": "a CSV of blackbox_decode or the Blackbox Explorer",
    "isaac": "an .npz or CSV with lin_acc and ang_vel",
    "gazebo": "what gz topic -e prints of an IMU",
    "matlab": "a .mat of save -v7, or a CSV of writetable",
    "phyphox": "a CSV of phyphox",
}
STATED_RATE = re.compile(
    r"[#/%\"\s]*(fs|sample[ _]?rate|sampling[ _]rate|update[ _]rate|rate|odr)"
    r"( ?[\[(]?hz[\])]?)?\"?"
    r"\s*[,:=;]\s*\"?(\d+(\.\d+)?)( ?hz)?\"?\s*\Z", re.IGNORECASE)
BETAFLIGHT = re.compile(r"gyroADC\[0\]|gyroUnfilt\[0\]")
SI = {"a": "m/s2", "g": "rad/s"}


def open_table(options):
    """The table of a file: a csv_table.Table, or what reads like one."""
    path, preset = options.file, options.preset
    if preset is not None and preset not in PRESETS:
        raise UsageError("--from %s: expected one of %s" % (preset, " ".join(PRESETS)))
    if ros_bag.is_bag(path):
        _is(preset, "ros2", path)
        return ros_bag.BagTable(path, options.topic)
    head = (head_of(path) or b"") if os.path.isfile(path) else b""
    if head.startswith((b"# sixflip-capture", BOARD_MAGIC)):
        raise BadFile("%s: is a capture already, expected somebody else's recording" % path)
    if head.startswith(px4_ulog.MAGIC):
        _is(preset, "px4", path)
        return px4_ulog.read_ulog(path, options.topic)
    if options.topic:
        raise UsageError("--topic: only of a ROS bag or a ULog, %s is neither" % path)
    if head.startswith(arrays.MATLAB_HDF5):
        raise BadFile("%s: a MAT-file of version 7.3, expected one of save -v7" % path)
    if head.startswith(arrays.MATLAB_5):
        _is(preset, "matlab", path)
        return arrays.read_mat(path)
    if arrays.is_spreadsheet(path, head):
        raise BadFile("%s: a spreadsheet, expected one of its sheets saved as CSV" % path)
    if head.startswith(arrays.ZIP):
        table = arrays.read_npz(path)
        if preset is not None:
            _is(preset, "isaac", path)
            table.units = SI
        return table
    if gazebo_text.looks_like(head):
        _is(preset, "gazebo", path)
        return gazebo_text.read_text(path)
    if preset in ("px4", "gazebo"):
        raise _other(preset, path)
    return _csv(options)


def _csv(options):
    """The Table of a text file."""
    path, preset = options.file, options.preset
    names = options.columns.split(",") if options.columns else None
    table = read_table(path, options.delimiter, options.skip, names,
                       column_names.looks_like_header)
    rates = [match for match in map(STATED_RATE.match, table.preamble) if match]
    table.rate_hz = float(rates[0][3]) if rates and 0 < float(rates[0][3]) < 1e6 else None
    if any(BETAFLIGHT.match(name) for name in table.names or ()):
        _is(preset, "betaflight", path)
        table.units = {"g": "dps"}      # Betaflight scales its gyro to deg/s before it logs it
        table.accel_lsb = _one_g(table.preamble)
        if "time" in table.names:
            table.time_unit = "us"
        return table
    if preset == "betaflight" or (preset == "ros2" and not _has(
            table, "angular_velocity", "linear_acceleration")) or (
                preset == "isaac" and not _has(table, "lin_acc", "ang_vel", "linear_acceleration")
            ) or (preset == "phyphox" and not _has(table, "Time (s)", "Time")):
        raise _other(preset, path)
    if preset in ("ros2", "isaac"):
        table.units = SI
    return table


def _has(table, *parts):
    return any(part in name for part in parts for name in table.names or ())


def _one_g(preamble):
    """Counts per g that a Blackbox header states, or None."""
    for line in preamble:
        match = re.match(r'"?acc_1G"?\s*,\s*"?(\d+)"?\s*\Z', line.strip())
        if match and int(match[1]) > 0:
            return float(match[1])
    return None


def _is(preset, told, path):
    """UsageError where another preset was said than what the content tells."""
    if preset not in (None, told):
        raise BadFile("%s: is %s, expected --from %s" % (path, PRESETS[told], told))


def _other(preset, path):
    return BadFile("%s: is not for --from %s, expected %s" % (path, preset, PRESETS[preset]))


def convert(options):
    """conversion.Imported of a file."""
    check_options(options)
    return conversion.Conversion(options, open_table(options)).run()
