"""The numbers of one calibration as people compare them: scale, bias, angles, uncertainties."""

import math

from sixflip.accelerometer.scale_form import inverse3, scale_form

from ..calibrate.verify_files import decode_record
from ..capture.capture_header import STANDARD_G
from ..errors import BadFile

AXES = "xyz"


def calibration_numbers(happened):
    """dict of a calibration: {name: (value, standard error or None)}; {} when nothing is known.

    Names: accel_scale_x, accel_bias_x_mg, gyro_scale_x, gyro_bias_x_dps and so on. The bias is
    what the sensor reads too much. Raises BadFile for a record that cannot be read.
    """
    if happened.record is not None:
        record = decode_record("history, board %s" % happened.board, happened.record)
        return {**_accelerometer(record), **_gyro(record)}
    return _told(happened)


def _accelerometer(record):
    if record.accel is None:
        return {}
    P, sigma = record.accel["P"], record.accel["sigma_P"]
    _, scale, v, inverse = scale_form(P)
    parameters = {}
    for k, axis in enumerate(AXES):
        parameters["accel_scale_" + axis] = scale[k], sigma[k][k]
        parameters["accel_bias_%s_mg" % axis] = (
            -1e3 * v[k] / record.g, _scaled(1e3 / record.g, _sigma_v(v, inverse, sigma, k)))
    return parameters


def _sigma_v(v, inverse, sigma, i):
    """Standard error of v = A^-1 o from those of P, taken as independent; None when unknown."""
    total = 0.0
    for j in range(3):
        parts = [sigma[3][j]] + [sigma[k][j] and sigma[k][j] * v[k] for k in range(3)]
        if None in parts:
            return None
        total += inverse[i][j] ** 2 * sum(part * part for part in parts)
    return math.sqrt(total)


def _scaled(factor, sigma):
    return None if sigma is None else factor * sigma


def _gyro(record):
    parameters = {}
    if record.gyro is not None:
        P, sigma = record.gyro["P"], record.gyro["sigma_P"]
        bias = gyro_bias_dps(P)
        for k, axis in enumerate(AXES):
            if k not in record.gyro["missing"]:
                parameters["gyro_scale_" + axis] = P[k][k], sigma[k][k]
            parameters["gyro_bias_%s_dps" % axis] = (
                bias[k], _scaled(math.degrees(1.0), sigma[3][k]))
    if record.gyro_bias is not None:
        for axis, bias in zip(AXES, record.gyro_bias["bias_dps"]):
            before = parameters.get("gyro_bias_%s_dps" % axis, (None, None))
            parameters["gyro_bias_%s_dps" % axis] = bias, before[1]
    return parameters


def _told(happened):
    """What `calibrate` heard the board say, before anybody pulled the record."""
    scale, v = happened.answer.get("scale"), happened.answer.get("v")
    parameters = {}
    for k, axis in enumerate(AXES):
        if _three(scale):
            parameters["accel_scale_" + axis] = scale[k], None
        if _three(v):
            parameters["accel_bias_%s_mg" % axis] = -1e3 * v[k] / STANDARD_G, None
    return parameters


def _three(values):
    return isinstance(values, list) and len(values) == 3 and all(
        isinstance(x, (int, float)) and math.isfinite(x) for x in values)


def readable(rows):
    """[(Happened, its parameters)] of all calibrations, sentences for damaged ones."""
    calibrations, remarks = [], []
    for row in rows:
        if row.kind != "calibration":
            continue
        try:
            calibrations.append((row, calibration_numbers(row)))
        except BadFile as error:
            remarks.append(str(error))
    return calibrations, remarks


def gyro_bias_dps(P):
    """The measured rate in deg/s that a gyro's P (4 x 3) maps to zero: b A = -o."""
    A = inverse3([[P[i][j] for j in range(3)] for i in range(3)])
    return [math.degrees(-sum([P[3][k] * A[k][j] for k in range(3)])) for j in range(3)]
