"""A record's whole correction as two matrices and offsets in SI units, for other programs.

true = A measured + o, column vectors. Measured values are what a driver makes of the counts
with the data sheet's numbers: counts / (counts per g) * 9.80665 in m/s², counts / (counts per
deg/s) in deg/s. Everything the board itself applies is in A and o: P, the gyro bias of the
last rest, the mounting; and what drifts with temperature as it is at one temperature. What the
gyro feels of the specific force is no part of A and o but a third matrix: true rate =
A measured + o - C (true specific force).
"""

import numpy as np

from sixflip.record.correction import correction_of

from .. import record_terms
from ..capture.capture_header import STANDARD_G
from ..errors import BadFile


class AffineCorrection:
    """accel, gyro: (A 3 x 3, o [3]) in m/s² and in deg/s; gyro None when the chip has none.

    coupling C (3 x 3, deg/s per m/s²) or None; frozen_c: the temperature (°C) that all this
    holds at, None where it holds at any. temp_c: asked for; default: the calibration's.
    """

    def __init__(self, path, record, temp_c=None):
        if record.accel is None:
            raise BadFile("%s holds no accelerometer correction: nothing to export" % path)
        self.record, self.coupling, self.frozen_c = record, None, None
        self.terms = record_terms.terms(record)
        M = self._linear(temp_c)
        self.accel = _parts(M[[0, 1, 2, 6], :3], record.accel_lsb_per_g / STANDARD_G, 1.0)
        self.gyro = None
        if record.gyro_lsb_per_dps:
            rates = M[:, 3:].copy()
            if "g_sensitivity" in self.terms:
                felt = np.linalg.solve(M[:3, :3], M[:3, 3:])    # rows: m/s² that come out
                rates[6] -= M[6, :3] @ felt
                self.coupling = -np.degrees(felt.T)
            self.gyro = _parts(rates[3:], record.gyro_lsb_per_dps, np.degrees(1.0))

    def _linear(self, temp_c):
        """(7, 6): what comes out for each count of ax … gz, and for none of any."""
        correction = correction_of(self.record)
        count = 0
        thermal = [fields for fields in self.terms.values() if "t0_c" in fields]
        if thermal:
            self.frozen_c = self.record.temp_c if temp_c is None else temp_c
            count = (self.frozen_c - thermal[0]["temp_offset_c"]) * thermal[0]["temp_lsb_per_c"]
        rows = [np.array(correction.apply([float(i == k) for i in range(6)] + [count], [0.0] * 6))
                for k in range(7)]
        return np.array([row - rows[6] for row in rows[:6]] + [rows[6]])

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

    def left_out(self, coupled=False):
        """Sentences about what of the record's terms A and o hold at one temperature only, or not
        at all. coupled: the format has C."""
        names = " and ".join(name for name in self.terms if name != "g_sensitivity")
        lines = []
        if names:
            lines.append("HOLDS AT %.2f degC ONLY, this format knows no temperature: %s; the "
                         "board follows it, and the format c-header" % (self.frozen_c, names))
        if self.coupling is not None and not coupled:
            lines.append("NOT in this file, which has no place for it: g_sensitivity; the board "
                         "applies it, and the formats imucal and c-header")
        return lines


def _parts(M, counts_per_unit, unit_out):
    """A and o from [c 1] M, c in counts, M 4 x 3."""
    M = np.array(M) * unit_out
    return M[:3].T * counts_per_unit, M[3]
