"""Raw counts to m/s2 and rad/s by what a record holds; with terms by term_correction.py."""

import math


class Correction:
    """Everything in one 4 x 3 matrix for the accelerometer and one for the gyro.

    [c0 c1 c2 1] M, c in raw counts: correction P, unit, gyro bias of the last rest and
    mounting are multiplied out once. A part that was not measured is left nominal. mounting
    False: in the sensor's axes, whatever the mounting. rest: the means of set_rest(), or None.
    """

    def __init__(self, record, mounting=True):
        self.record = record
        self.rest = None
        nominal = [[1.0 if i == j else 0.0 for j in range(3)] for i in range(4)]
        P = record.accel["P"] if record.accel else nominal
        W = record.gyro["P"] if record.gyro else nominal
        offset = W[3]
        if record.gyro_bias:
            # The newest rest wins over the bias of the session: Li finds it differs at each
            # switching-on. [b 1] W must be zero.
            b = [math.radians(x) for x in record.gyro_bias["bias_dps"]]
            offset = [-sum([b[k] * W[k][j] for k in range(3)]) for j in range(3)]
        turn = None
        if record.mounting and mounting:
            from sixflip.record.mounting import compensation  # most boards have none
            turn = compensation(record.mounting)
        lsb = record.accel_lsb_per_g
        self.accel = _multiplied(P, P[3], record.g / lsb if lsb else 0.0, turn)
        lsb = record.gyro_lsb_per_dps
        self.gyro = _multiplied(W, offset, math.radians(1.0) / lsb if lsb else 0.0, turn)

    def apply(self, sample, out):
        """sample: seven counts; out: ax ay az in m/s2, gx gy gz in rad/s. Returns out."""
        for k, M in ((0, self.accel), (3, self.gyro)):
            x = sample[k]
            y = sample[k + 1]
            z = sample[k + 2]
            for j in range(3):
                out[k + j] = x * M[0][j] + y * M[1][j] + z * M[2][j] + M[3][j]
        return out

    def set_rest(self, means):
        """A new rest: the seven mean counts; the corrected rate is zero there from now on."""
        self.rest = means
        self.set_gyro_bias(means[3:6])

    def set_gyro_bias(self, counts):
        """Mean counts of gx gy gz at which the corrected rate is zero."""
        M = self.gyro
        for j in range(3):
            M[3][j] = -sum([counts[k] * M[k][j] for k in range(3)])


def _multiplied(P, offset, unit, turn):
    rows = [[P[i][j] * unit for j in range(3)] for i in range(3)] + [[offset[j] for j in range(3)]]
    if unit == 0.0:
        rows[3] = [0.0] * 3
    if turn is None:
        return rows
    return [[sum([row[k] * turn[j][k] for k in range(3)]) for j in range(3)] for row in rows]


def correction_of(record, tell=None):
    """Correction or TermCorrection, see there for tell; ValueError, a sentence, for terms that
    cannot be."""
    if not record.terms:
        return Correction(record)
    from sixflip.record.term_correction import TermCorrection, fill, numbers
    correction = TermCorrection(record, tell)
    fill(correction, numbers(record))
    return correction
