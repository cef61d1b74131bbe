"""Can a correction record be a sensor's? Its CRC says only that the bytes are what was written.

Asked of a record that comes from flash, from a host or from a file, and of a new one before it
is saved. Limits:

    g        9.7 to 9.9 m/s2: on Earth and above it (gravity.py: 9.718 in 20 km, 9.834 at a pole)
    scale    0.8 to 1.2 (METHOD 1; result_verdict.py and gyro_verdict.py refuse the same)
    turned   0.35: a box within 15 degrees of a face (pose_label.CROOKED_DEG), and 5 more for the
             chip in it. So each diagonal element is larger than the others of its row together,
             and no P is singular
    bias     0.5 g and 80 deg/s: twice the largest zero-g offset and zero-rate output of the data
             sheets (ADXL345 rev. E, table 1: 250 mg; ITG-3205 rev. 1.0, table 3.1: 40 deg/s)
"""


def implausible(record):
    """"" or a sentence: what no sensor's record has."""
    said = _outside("g in m/s2", record.g, 9.7, 9.9)
    if record.float_bits not in (30, 32, 64):
        said = "it was calculated with %d-bit floats: expected 30, 32 or 64" % record.float_bits
    if record.accel is not None:
        said = said or _matrix("accelerometer", record.accel["P"], 0.5 * record.g)
    if record.gyro is not None:
        said = said or _matrix("gyro", record.gyro["P"], 1.4)  # rad/s: 80 deg/s
    if record.gyro_bias is not None:
        for x in record.gyro_bias["bias_dps"]:
            said = said or _outside("the gyro's bias in deg/s", x, -80.0, 80.0)
    if record.mounting is not None:
        for name in ("roll_deg", "pitch_deg"):
            said = said or _outside(name, record.mounting[name], -180.0, 180.0)
        from sixflip.mounting import parse_axes
        try:
            parse_axes(record.mounting["axes"])
        except ValueError as e:
            said = said or "its mounting: %s" % e
    return said


def _outside(name, x, low, high):
    if low <= x <= high:
        return ""
    return "%s is %.4g: expected %.4g to %.4g" % (name, x, low, high)


def _matrix(name, P, most):
    said = ""
    for i in range(4):
        for j in range(3):
            low, high = (-most, most) if i == 3 else (0.8, 1.2) if i == j else (-0.35, 0.35)
            said = said or _outside("P[%d][%d] of the %s" % (i, j, name), P[i][j], low, high)
    return said
