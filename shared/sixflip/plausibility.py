"""Can a correction record be a sensor's? Its CRC says only that the bytes are what was written.

Asked wherever a record comes from outside of the calculation: from flash, from a host, from a
file. What a session may end in passes, the same limits decide there.
"""

import math

from sixflip.gyro_verdict import SCALE_OFF as GYRO_SCALE_OFF
from sixflip.mounting import parse_axes
from sixflip.result_verdict import OFF_SQUARE_DEG, SCALE_OFF
from sixflip.scale_form import scale_form

G = (9.7, 9.9)  # m/s2, on Earth and above it (gravity.py: 9.718 in 20 km, 9.834 in the Arctic)
# A box that lies on a face has its chip within 30 degrees of it (pose_label.LEANING_DEG).
TURNED = 0.6
# Twice the largest zero-g offset of the data sheets (ADXL345 rev. E, table 1: Z 250 mg),
BIAS_G = 0.5
# and zero-rate output (ITG-3205 rev. 1.0, table 3.1: 40 deg/s).
BIAS_DPS = 80.0
# Full scale times counts a unit, accelerometer and gyro (MPU-6000 register map 4.2, registers 27
# and 28; ITG-3205, section 3.1). An ADXL345 has 256 counts per g in every range, or 512 over the
# range with FULL_RES off, give or take 10 % (rev. E, table 1).
FULL_SCALE = {"mpu6050": (32768, 32768), "gy85": (0, 28750), "itg3205": (0, 28750)}


def implausible(record):
    """"" or a sentence: what no sensor's record has."""
    if not G[0] <= record.g <= G[1]:
        return "g is %.5g m/s2: expected %s to %s" % (record.g, G[0], G[1])
    if record.float_bits not in (30, 32, 64):
        return "it was calculated with %d-bit floats: expected 30, 32 or 64" % record.float_bits
    said = wrong_scale(record.chip, record.accel_range_g, record.accel_lsb_per_g,
                       record.gyro_range_dps, record.gyro_lsb_per_dps)
    if not said and record.accel is not None:
        said = _accelerometer(record.accel["P"], record.g)
    if not said and record.gyro is not None:
        said = _gyro(record.gyro["P"])
    if not said and record.gyro_bias is not None:
        said = _rate(record.gyro_bias["bias_dps"])
    return said or _mounting(record.mounting)


def wrong_scale(chip, range_g, accel_lsb, range_dps, gyro_lsb):
    """"" or a sentence; 0 or None is a range or scale that is not stated."""
    accel, gyro = FULL_SCALE.get(chip, (0, 0))
    if chip in ("gy85", "adxl345") and accel_lsb and not (
            abs(accel_lsb / 256 - 1) <= 0.1 or abs(accel_lsb * (range_g or 0) / 512 - 1) <= 0.1):
        return "the accelerometer of the %s has %g counts per g: expected 256" % (chip, accel_lsb)
    for what, unit, product, full, lsb in (
            ("accelerometer", "g", accel, range_g, accel_lsb),
            ("gyro", "deg/s", gyro, range_dps, gyro_lsb)):
        if product and full and lsb and not abs(full * lsb / product - 1) <= 0.02:
            return ("the %s of the %s has %g counts per %s at +-%g %s: expected %.6g"
                    % (what, chip, lsb, unit, full, unit, product / full))
    return ""


def _accelerometer(P, g):
    try:
        T, scale, v, _ = scale_form(P)
    except ValueError as e:
        return "the accelerometer's correction cannot be: %s" % e
    return (_scales("accelerometer", scale, SCALE_OFF) or _turned("accelerometer", T)
            or _biased([x / g for x in v]))


def _biased(v):
    for k in range(3):
        if not abs(v[k]) <= BIAS_G:
            return "the accelerometer's bias on %s is %.3g g: expected %s at most" % (
                "xyz"[k], v[k], BIAS_G)
    return ""


def _scales(what, scale, off):
    for k in range(3):
        if not abs(scale[k] - 1.0) <= off:
            return "the %s's scale of axis %s is %.3g: expected %s to %s" % (
                what, "xyz"[k], scale[k], 1 - off, 1 + off)
    return ""


def _turned(what, T):
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if not (abs(T[i][j]) <= TURNED and abs(T[j][i]) <= TURNED):
            return "the %s's axes %s and %s are mixed by %.3g and %.3g: expected %s at most" % (
                what, "xyz"[i], "xyz"[j], T[i][j], T[j][i], TURNED)
        if not math.degrees(abs(T[i][j] + T[j][i])) <= OFF_SQUARE_DEG[1] + 0.01:
            return "the %s's axes %s and %s are %.1f degrees off a right angle: expected %s" % (
                what, "xyz"[i], "xyz"[j], math.degrees(T[i][j] + T[j][i]), OFF_SQUARE_DEG[1])
    return ""


def _gyro(P):
    for row in P:
        for x in row:
            if not abs(x) <= 1e6:
                return "the gyro's correction holds %s" % x
    said = _scales("gyro", [P[k][k] for k in range(3)], GYRO_SCALE_OFF)
    if said:
        return said
    for i in range(3):
        for j in range(3):
            if i != j and not abs(P[i][j]) <= TURNED:
                return "the gyro's axes %s and %s are mixed by %.3g: expected %s at most" % (
                    "xyz"[i], "xyz"[j], P[i][j], TURNED)
    return _rate([math.degrees(x) for x in P[3]])


def _rate(dps):
    for k in range(3):
        if not abs(dps[k]) <= BIAS_DPS:
            return "the gyro's bias on %s is %.3g deg/s: expected %s at most" % (
                "xyz"[k], dps[k], BIAS_DPS)
    return ""


def _mounting(mounting):
    if mounting is None:
        return ""
    for name in ("roll_deg", "pitch_deg"):
        if not abs(mounting[name]) <= 180.0:
            return "the mounting's %s is %.4g: expected -180 to 180" % (name, mounting[name])
    try:
        parse_axes(mounting["axes"])
    except ValueError as e:
        return "the mounting's %s" % e
    return ""
