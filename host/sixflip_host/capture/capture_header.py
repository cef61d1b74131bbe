"""The first three lines of a text capture: version, JSON object, column names."""

import json
import math

from sixflip import STANDARD_G  # noqa: F401 - for what reads captures
from sixflip.chips import catalogue

from ..errors import BadFile
from . import chip_scales
from .capture_rows import quoted

MAGIC = b"# sixflip-capture"
VERSION = 1
SENSORS = (*catalogue.SENSORS, "itg3205", "other")
ACCEL = ("ax", "ay", "az")
GYRO = ("gx", "gy", "gz")
MAG = ("mx", "my", "mz")
COLUMNS = ("t_us",) + ACCEL + GYRO + ("temp",) + MAG + ("pose",)
G = (9.7, 9.9)          # m/s², as sixflip.record.record
RATES = ("stated", "measured")     # key `rate`: how rate_hz is known; measured is never judged
LONGEST_LINE = 1 << 20      # bytes; what comes behind the header has no limit of its own
POSITIVE = ("rate_hz", "accel_lsb_per_g", "gyro_lsb_per_dps", "temp_lsb_per_c", "mag_lsb_per_ut",
            "accel_range_g", "gyro_range_dps", "g")


def parse_header(path, data):
    """The head of a text capture -> (meta, columns, rows expected or None, offset of the rows).

    Raises BadFile with the line and what was expected; line numbers count from 1.
    """
    lines, offset = _head_lines(path, data)
    _check_version(path, lines[0])
    if len(lines) < 2:
        raise BadFile.at(path, 2, "the file ends", "a # and one JSON object")
    meta = _json_object(path, lines[1])
    if len(lines) < 3:
        raise BadFile.at(path, 3, "the file ends", "the column names")
    columns = _column_names(path, lines[2])
    samples = meta.pop("samples", None)
    if samples is not None and (type(samples) is not int or samples < 0):
        raise BadFile.at(path, 2, "samples is %s" % quoted(json.dumps(samples)),
                         "the number of rows")
    check_meta(meta, columns, lambda found, expected: BadFile.at(path, 2, found, expected))
    return meta, columns, samples, offset


def _head_lines(path, data):
    """Up to three lines without their newlines, and the offset behind them."""
    if not data:
        raise BadFile.at(path, 1, "the file is empty", "# sixflip-capture 1")
    offset = 3 if data.startswith(b"\xef\xbb\xbf") else 0     # the mark some editors put first
    lines = []
    while len(lines) < 3 and offset < len(data):
        end = data.find(b"\n", offset)
        end = len(data) if end < 0 else end
        if end - offset > LONGEST_LINE:
            raise BadFile.at(path, len(lines) + 1, "a line of %d bytes" % (end - offset),
                             "%d at most in the header" % LONGEST_LINE)
        lines.append(data[offset:end][:-1] if data[offset:end].endswith(b"\r")
                     else data[offset:end])
        offset = end + 1
    return lines or [b""], offset


def _check_version(path, line):
    if not line.startswith(MAGIC):
        raise BadFile.at(path, 1, "not a sixflip capture", "# sixflip-capture 1")
    version = line[len(MAGIC):].strip()
    if version != b"%d" % VERSION:
        raise BadFile.at(path, 1, "capture format version %s"
                         % quoted(version.decode("utf-8", "replace")), "%d" % VERSION)


def _json_object(path, line):
    """The JSON object of line 2: no NaN, no key twice."""
    def refuse(constant):
        raise ValueError("%s is not a number JSON knows" % constant)

    def once(pairs):
        seen = {}
        for name, value in pairs:
            if name in seen:
                raise ValueError("the key %s stands there twice" % quoted(name))
            seen[name] = value
        return seen

    expected = "a # and one JSON object"
    try:
        text = line.decode("utf-8")
        if not text.startswith("#"):
            raise BadFile.at(path, 2, "no # at the start", expected)
        meta = json.loads(text[1:], parse_constant=refuse, object_pairs_hook=once)
    except (ValueError, RecursionError) as error:
        raise BadFile.at(path, 2, str(error).split(": line")[0], expected)
    if not isinstance(meta, dict):
        raise BadFile.at(path, 2, "JSON, but not an object", expected)
    return meta


def _column_names(path, line):
    """Line 3: known names, none twice, whole triples."""
    try:
        names = [name.strip() for name in line.decode("utf-8").split(",")]
    except UnicodeDecodeError:
        raise BadFile.at(path, 3, "bytes that are not UTF-8 text", "the column names")
    for name in names:
        if name not in COLUMNS:
            raise BadFile.at(path, 3, "unknown column %s" % quoted(name), " ".join(COLUMNS))
        if names.count(name) > 1:
            raise BadFile.at(path, 3, "column %s stands there twice" % name, "every name once")
    for group in (("t_us",), ACCEL, GYRO, MAG):
        there = [name for name in group if name in names]
        wanted = group == ("t_us",) or (group == ACCEL and "gx" not in names)
        if len(there) < len(group) and (there or wanted):
            absent = next(name for name in group if name not in names)
            raise BadFile.at(path, 3, "column %s is missing" % absent, "all of " + " ".join(group))
    return names


def check_meta(meta, columns, fault):
    """Raise fault(found, expected) when a mandatory key is missing or out of its range."""
    needed = ["sensor", "rate_hz"]
    needed += ["accel_lsb_per_g"] if "ax" in columns else []
    needed += ["gyro_lsb_per_dps"] if "gx" in columns else []
    needed += ["temp_lsb_per_c", "temp_offset_c"] if "temp" in columns else []
    needed += ["mag_lsb_per_ut"] if "mx" in columns else []
    for key in needed:
        if key not in meta:
            raise fault("the key %s is missing" % quoted(key), " ".join(needed))
    if meta["sensor"] not in SENSORS:
        raise fault("sensor is %s" % quoted(json.dumps(meta["sensor"])), " ".join(SENSORS))
    for key in POSITIVE + ("temp_offset_c",):
        if key in meta and not _is_number(meta[key], positive=key != "temp_offset_c"):
            raise fault("%s is %s" % (key, quoted(json.dumps(meta[key]))),
                        "a number" if key == "temp_offset_c" else "a number above 0")
    check_sensor(meta, columns, fault)
    if meta.get("rate", RATES[0]) not in RATES:
        raise fault("rate is %s" % quoted(json.dumps(meta["rate"])), " or ".join(RATES))
    by_hand = meta.get("held_by_hand", [])
    if not isinstance(by_hand, list) or not all(isinstance(name, str) for name in by_hand):
        raise fault("held_by_hand is %s" % quoted(json.dumps(by_hand)), "a list of pose names")


def check_sensor(meta, columns, fault):
    """Raise fault(found, expected) for numbers that are not of this sensor, or of no planet."""
    if not G[0] <= meta.get("g", STANDARD_G) <= G[1]:
        raise fault("g is %g m/s²" % meta["g"], "%g to %g" % G)
    if meta["sensor"] == "adxl345":
        for column, what in (("gx", "gyro"), ("temp", "thermometer")):
            if column in columns:
                raise fault("an adxl345 with a column %s, it has no %s" % (column, what),
                            "another sensor, or no such column")
    wrong = chip_scales.wrong(
        meta["sensor"], meta.get("accel_range_g"), meta.get("accel_lsb_per_g"),
        meta.get("gyro_range_dps"), meta.get("gyro_lsb_per_dps"))
    if wrong:
        raise fault(*wrong)


def _is_number(value, positive):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) < 1e300 and math.isfinite(value) and (value > 0 or not positive)
