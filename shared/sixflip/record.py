"""What a calibration leaves: a Record. correction_record.py turns it into bytes and back."""

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
    terms     [(tag, bytes)], as stored: record_terms.py takes them apart, and checks them,
              where they are used; a session has no heap to spare for that
    """

    def __init__(self):
        self.sequence = self.session = self.time = 0
        self.float_bits = 64 if 1.0 + 1e-9 != 1.0 else 32
        self.chip = ""
        self.who_am_i = (0, 0)
        self.accel_range_g = self.gyro_range_dps = 0
        self.accel_lsb_per_g = self.gyro_lsb_per_dps = 0.0
        self.temp_c = None
        self.g = 9.80665
        self.accel = self.gyro = self.gyro_bias = self.mounting = self.flips = None
        self.terms = []
        self.unknown = []

    def measured(self):
        """Names of the sections there are."""
        return [name for name in MEASURED if getattr(self, name) is not None]
