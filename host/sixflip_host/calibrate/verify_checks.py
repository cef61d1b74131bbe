"""Everything the board said, next to what the host finds from the raw capture."""

import math
import re

import numpy as np

from sixflip.accelerometer.scale_form import scale_form
from sixflip.poses.faces import pose_name

from ..capture import pose_sums
from ..errors import CheckFailed
from . import reference

DOUBLE_REL = 1e-9
DOUBLE_ABS = 1e-13      # below this an element has no digits left to compare
SINGLE_MG = 0.01
STORED_REL = 3e-7       # numbers the record keeps in 32 bits
NUMBER = re.compile(r"\d+(?:\.\d+)?")


class Check:
    """One comparison: what, the board's value, the host's, and whether they agree."""

    def __init__(self, name, board, host, ok, limit=""):
        self.name = name
        self.board = board
        self.host = host
        self.ok = bool(ok)
        self.limit = limit

    def row(self):
        """Name, the board's value, the host's and the limit, as text."""
        return [self.name, *("%.12g" % value if isinstance(value, float) else str(value)
                             for value in (self.board, self.host)), self.limit]


def close(name, board, host, relative, absolute=0.0):
    """A Check of two numbers (or None)."""
    if board is None or host is None:
        return Check(name, board, host, board is host, "both or none")
    limit = relative * abs(host) + absolute
    return Check(name, float(board), float(host), abs(board - host) <= limit, "%.1e" % limit)


def same(name, board, host):
    """A Check of two things that must be equal."""
    return Check(name, board, host, board == host, "equal")


# What the header of a board's capture says besides, by the record's names.
STATED = ("who_am_i", "accel_range_g", "gyro_range_dps", "float_bits")


def belong_together(capture, record):
    """Capture and record: same session, sensor, numbers of the chip, floats of the board."""
    meta = capture.meta
    checks = [same("session", record.session, meta.get("session")),
              same("sensor", record.chip, meta["sensor"]),
              close("g, m/s²", record.g, capture.g, 1e-7),
              close("counts per g", record.accel_lsb_per_g, meta["accel_lsb_per_g"], 0, 5.1e-4),
              close("counts per deg/s", record.gyro_lsb_per_dps,
                    meta.get("gyro_lsb_per_dps", 0), 0, 5.1e-4)]
    for name in STATED:
        if name in meta:
            there = getattr(record, name)
            checks.append(same(name, list(there) if name == "who_am_i" else there, meta[name]))
    return checks


def same_words(name, board, host, float_bits):
    """A Check of two sentences; numbers of a board with short floats may be one off in the last
    digit that is printed."""
    host = host[:200]       # so much of a reason a record keeps
    alike = board == host
    if not alike and float_bits != 64 and NUMBER.sub("#", board) == NUMBER.sub("#", host):
        pairs = zip(NUMBER.findall(board), NUMBER.findall(host))
        alike = all(abs(float(a) - float(b)) <= 1.01 * 10.0 ** -len(b.partition(".")[2])
                    for a, b in pairs)
    return Check(name, board, host, alike, "the same words")


def pose_blocks(capture):
    """The board's own sums of every pose against the raw samples: exactly equal."""
    checks = []
    for block in capture.board_placements or ():
        name = pose_name(block.pose)
        if block.n < 1 or block.first + block.n > len(capture):
            checks.append(Check("%s samples" % name, "%d to %d" % (
                block.first, block.first + block.n - 1), "0 to %d" % (len(capture) - 1), False))
            continue
        host = pose_sums.one(capture, block.pose, block.first, block.first + block.n)
        checks.append(same("%s sums" % name, list(block.sums), host.sums))
        widest = max(abs(a - b) / (b or 1) for a, b in zip(block.noise, host.noise))
        checks.append(Check("%s noise" % name, _short(block.noise), _short(host.noise),
                            widest < 1e-4, "1e-4"))
        if block.first:
            before, last = capture.t_us[block.first - 1], capture.t_us[block.first + block.n - 1]
            checks.append(same("%s duration, us" % name, block.duration_us, int(last - before)))
    return checks


def _short(values):
    return " ".join("%.2f" % value for value in values)


def accelerometer(record, placements, lsb_per_g, angles=None):
    """The record's accelerometer section against the reference; angles {face: rad}."""
    section = record.accel
    try:
        host = reference.solve(placements, lsb_per_g, record.g, section["level"], angles)
    except (CheckFailed, np.linalg.LinAlgError, ValueError, IndexError) as error:
        return [Check("accelerometer", section["level"], str(error), False)]
    double = record.float_bits == 64
    P = np.array(section["P"])
    checks = matrix_checks("P", P[:, :3], host.P[:, :3], double, record.g)
    checks.append(vector_check(P, host.P, double, record.g))
    relative, absolute = (STORED_REL, 1e-12) if double else (2e-3, 2e-6)
    T, scale, v, _ = scale_form(section["P"])
    limit = 1e-9 if double else 1e-3 * SINGLE_MG
    for k in range(3):
        checks.append(close("scale %s" % "xyz"[k], scale[k], host.scale[k], 0, limit))
        checks.append(close("v %s, m/s²" % "xyz"[k], v[k], host.v[k], 0, 2 * limit * record.g))
    off = np.abs(np.array(T) - host.T).max()
    checks.append(Check("T", "", "differs by %.1e" % off, off <= 2 * limit, "%.1e" % (2 * limit)))
    for i in range(4):
        for j in range(3):
            checks.append(close("sigma P[%d][%d]" % (i, j), section["sigma_P"][i][j],
                                host.sigma_P[i, j], 1e-4 if double else 0.05, absolute))
    degrees = 1e-6 if double else 2 * math.degrees(1e-3 * SINGLE_MG)
    return checks + [
        close("table tilt, deg", section["tilt_deg"], host.tilt_deg, relative, degrees),
        close("its spread, deg", section["tilt_spread_deg"], host.tilt_spread_deg, relative,
              degrees),
        close("residual, g rms", section["residual_rms_g"], host.residual_rms_g, relative,
              1e-9 if double else 1e-3 * SINGLE_MG),
        close("noise, g", section["noise_g"], host.noise_g, 1e-4)]


def matrix_checks(name, board, host, double, unit_of_last_row):
    """One Check for every number of a matrix whose last row carries a unit."""
    checks = []
    for i, j in np.ndindex(*host.shape):
        unit = unit_of_last_row if i == len(host) - 1 else 1.0
        relative, absolute = (DOUBLE_REL, DOUBLE_ABS * unit) if double else \
            (0.0, 1e-3 * SINGLE_MG * unit)
        checks.append(close("%s[%d][%d]" % (name, i, j), board[i, j], host[i, j], relative,
                            absolute))
    return checks


def vector_check(P, host, double, g):
    """RMS over all directions of gravity of the difference of the corrected vectors, mg."""
    D = P - host
    error = 1e3 * math.sqrt((D[:3, :3] ** 2).sum() / 3 + (D[3, :3] ** 2).sum() / g ** 2)
    limit = 1e-6 if double else SINGLE_MG
    return Check("vectors", "", "differ by %.1e mg rms" % error, error <= limit, "%.0e mg" % limit)


def gyro_bias(record, placements):
    """The mean rate at rest over all placements, deg/s, and the temperature it was at."""
    if record.gyro_bias is None:
        return [Check("gyro bias", "not in the record", "the capture has a gyro", False)]
    n = sum(one.n for one in placements)
    relative = DOUBLE_REL if record.float_bits == 64 else 1e-5
    return [close("gyro bias %s, deg/s" % "xyz"[k], record.gyro_bias["bias_dps"][k],
                  sum(one.sums[3 + k] for one in placements) / n / record.gyro_lsb_per_dps,
                  relative, 1e-12 if record.float_bits == 64 else 1e-6) for k in range(3)] + [
        close("temperature of the gyro bias, °C", record.gyro_bias["temp_c"], record.temp_c,
              1e-6, 1e-5)]


def temperature(record, capture, placements):
    """Mean temperature over all placements, °C."""
    if "temp_lsb_per_c" not in capture.meta or capture.temp is None and not capture.sums_only:
        return [same("temperature, °C", record.temp_c, None)]
    n = sum(one.n for one in placements)
    host = sum(one.sums[6] for one in placements) / n / capture.meta["temp_lsb_per_c"] \
        + capture.meta["temp_offset_c"]
    return [close("temperature, °C", record.temp_c, host, 1e-5, 1e-5)]
