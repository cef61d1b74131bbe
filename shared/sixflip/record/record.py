"""What a calibration leaves: a Record, and whether it can be a sensor's.

A CRC says only that the bytes are what was written. A record is therefore held against what
sensors have when it comes from flash, from a host or from a file, and a new one before it is
saved:

    g        9.7 to 9.9 m/s2: on Earth and above it (9.718 in 20 km, 9.834 at a pole)
    scale    0.8 to 1.2 (METHOD 1; both verdicts refuse the same)
    turned   0.35: a box within 15 degrees of a face (pose_label.CROOKED_DEG), and 5 more for the
             chip in it. So each diagonal element is larger than the others of its row together,
             and no P is singular
    bias     0.5 g and 80 deg/s: twice the largest zero-g offset and zero-rate output of the data
             sheets (ADXL345 rev. E, table 1: 250 mg; ITG-3205 rev. 1.0, table 3.1: 40 deg/s)
"""

from sixflip import STANDARD_G

MEASURED = ("accel", "gyro", "gyro_bias", "mounting")


def newer(sequence, other):
    """Whether one sequence number comes after another: they begin again behind 2^32 - 1
    (serial number arithmetic, RFC 1982, 3.2)."""
    return 0 < (sequence - other) & 0xFFFFFFFF < 0x80000000


def following(sequence):
    """The sequence number of the next record."""
    return (sequence + 1) & 0xFFFFFFFF


class Record:
    """What a board keeps of a calibration; None where nothing was measured.

    sequence, session  u32: counts up with every save; random name of the session
    float_bits         32 or 64 (30 on some ports): how the board calculated
    chip, who_am_i     name, (accelerometer id, gyro id)
    accel_range_g, gyro_range_dps   whole numbers; accel_lsb_per_g, gyro_lsb_per_dps
    temp_c, g, time    chip at calibration (None), m/s2 used, unix seconds or 0
    accel     {"P" 4 x 4, "sigma_P", "tilt_deg", "tilt_spread_deg", "residual_rms_g", "noise_g",
              "level", "verdict", "reason"}
    gyro      {"P" 4 x 3, "sigma_P", "missing" [axes], "verdict", "reason"}
    gyro_bias {"bias_dps" [3], "temp_c"} of the last rest
    flips     {"excess" [6] rad beyond half a turn by which the accelerometer was solved, face by
              face, 0 where 180 degrees were assumed; "scale_sigma" and "sequence" of the
              record whose gyro measured them}; None: 180 degrees everywhere
    mounting  {"roll_deg", "pitch_deg", "order", "axes", "frame"}
    terms     [(tag, bytes)], as stored: term_correction.py takes them apart and checks
              them where they are used
    """

    def __init__(self):
        self.sequence = self.session = self.time = 0
        self.float_bits = 64 if 1.0 + 1e-9 != 1.0 else 32
        self.chip = ""
        self.who_am_i = (0, 0)
        self.accel_range_g = self.gyro_range_dps = 0
        self.accel_lsb_per_g = self.gyro_lsb_per_dps = 0.0
        self.temp_c = None
        self.g = STANDARD_G
        self.accel = self.gyro = self.gyro_bias = self.mounting = self.flips = None
        self.terms = []
        self.unknown = []

    def measured(self):
        """Names of the sections there are."""
        return [name for name in MEASURED if getattr(self, name) is not None]


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
        from sixflip.record.mounting import parse_axes
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
