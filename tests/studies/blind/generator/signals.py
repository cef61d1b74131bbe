"""What the chip feels in a session, sample by sample, before and after its imperfections."""

import copy

import numpy as np
from scipy.signal import lfilter, lfiltic

EARTH_DPS = 360 / 86164.1


class Signals:
    """A session's truth and what becomes of it.

    t (n,) s true time of each sample; f (n, 3) g specific force at the sensor, w (n, 3) deg/s,
    both in the sensor's axes; temp (n,) deg C of the chip, temp_accel (n,) of the
    accelerometer's own die; accel (n, 3) g and gyro (n, 3) deg/s as measured so far.
    """

    def __init__(self, path, warmth, chip, rate, latitude_deg, session, part, clock=None):
        self.path, self.chip, self.rate, self.session = path, chip, rate, session
        n = int(path.duration * rate)
        self.t = np.arange(n) / rate if clock is None else clock(n)
        self.t = self.t[self.t < path.duration]
        self.names, self.placements = path.labels(self.t)
        half = 0.5 / rate
        at = path.attitude(self.t)
        before, after = path.attitude(self.t - half), path.attitude(self.t + half)
        self.w = np.degrees((before.inv() * after).as_rotvec()) * rate
        north, up = np.cos(np.radians(latitude_deg)), np.sin(np.radians(latitude_deg))
        self.w += at.inv().apply([0, EARTH_DPS * north, EARTH_DPS * up])
        self.at = at
        self.f_world = path.acceleration(self.t, 9.80665)
        self.f_world[:, 2] += 1.0
        self.f = at.inv().apply(self.f_world)
        self.temp = warmth.at(self.t)
        lag = part["thermometer_lag_s"]
        self.temp_accel = lagged(self.temp, self.t, lag) if lag > 0 else self.temp
        self.accel = self.f @ part["accel_matrix"].T + part["accel_offset"]
        self.gyro = self.w @ part["gyro_matrix"].T + part["gyro_offset"][session]

    def again(self):
        """A copy whose measured signals an effect may change; the rest is shared."""
        other = copy.copy(self)
        other.accel, other.gyro = self.accel.copy(), self.gyro.copy()
        return other

    def out(self, sensor):
        return self.accel if sensor == "accel" else self.gyro


def lagged(x, t, tau):
    """x behind a first-order lag of tau seconds, settled at the start. x (n,) or (n, k)."""
    if tau <= 0:
        return np.array(x, float)
    k = 1 - np.exp(-np.mean(np.diff(t)) / tau)
    x = np.asarray(x, float)
    columns = x[:, None] if x.ndim == 1 else x
    out = np.empty_like(columns)
    for j in range(columns.shape[1]):
        start = lfiltic([k], [1, k - 1], [columns[0, j]])
        out[:, j] = lfilter([k], [1, k - 1], columns[:, j], zi=start)[0]
    return out[:, 0] if x.ndim == 1 else out
