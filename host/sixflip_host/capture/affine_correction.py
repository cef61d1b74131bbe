"""A record's whole correction as two matrices and offsets in SI units, for other programs.

true = A measured + o, column vectors. Measured values are what a driver makes of the counts
with the data sheet's numbers: counts / (counts per g) * 9.80665 in m/s², counts / (counts per
deg/s) in deg/s. Everything the board itself applies is in A and o: P, the gyro bias of the
last rest, the mounting.
"""

import numpy as np

from sixflip.correction import Correction
from sixflip.record import TERMS

from ..errors import BadFile
from .capture_header import STANDARD_G


class AffineCorrection:
    """accel, gyro: (A 3 x 3, o [3]) in m/s² and in deg/s; gyro None when the chip has none."""

    def __init__(self, path, record):
        if record.accel is None:
            raise BadFile("%s holds no accelerometer correction: nothing to export" % path)
        correction = Correction(record)
        self.record = record
        self.accel = _parts(correction.accel, record.accel_lsb_per_g / STANDARD_G, 1.0)
        self.gyro = None
        if record.gyro_lsb_per_dps:
            self.gyro = _parts(correction.gyro, record.gyro_lsb_per_dps, np.degrees(1.0))

    def origin(self):
        """Sentences about where the numbers come from, for a comment in the file."""
        record = self.record
        lines = ["sixflip export: %s, record %d, session %d, verdict %s" % (
            record.chip, record.sequence, record.session, record.accel["verdict"]),
            "raw acceleration = counts / %.10g * 9.80665 m/s^2; local gravity then: %.6g m/s^2"
            % (record.accel_lsb_per_g, record.g)]
        if self.gyro:
            what = "calibrated" if record.gyro else "nominal, only its bias was measured" \
                if record.gyro_bias else "nominal, nothing was measured"
            lines.append("raw rate = counts / %.10g deg/s; the gyro is %s" % (
                record.gyro_lsb_per_dps, what))
        if record.mounting:
            lines.append("turned into the robot's axes: roll %.4f deg, pitch %.4f deg, order %s"
                         % tuple(record.mounting[key]
                                 for key in ("roll_deg", "pitch_deg", "order")))
        return lines

    def left_out(self):
        """A sentence, in a list, about what of the record A and o cannot hold; [] for nothing."""
        names = [name for tag, name in TERMS if tag in [one for one, _ in self.record.terms]]
        if not names:
            return []
        return ["NOT in this file, which has no place for them: the record's terms %s; the board "
                "applies them, and the format c-header" % ", ".join(names)]


def _parts(M, counts_per_unit, unit_out):
    """A and o from [c 1] M, c in counts, M 4 x 3."""
    M = np.array(M) * unit_out
    return M[:3].T * counts_per_unit, M[3]
