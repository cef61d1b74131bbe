"""Recordings of a vehicle that stands still, or should: the sensor of board_session's captures."""

import numpy as np

from sixflip_host.capture.capture_file import Capture
from tests.worlds.hand_session import Sensor


def rest(meta, force=(0.0, 0.0, 1.0), n=600, rate_dps=(0.0, 0.0, 0.0), shake_mg=0.0, sway_mg=0.0,
         drives_off=False, hangs=False, temp=-3700, sensor=None, seed=9):
    """A Capture of n samples; force in g in the sensor's axes.

    shake_mg  an engine at 23 Hz along x; sway_mg: slow rocking; drives_off: moves from
    the middle on; hangs: the chip repeats its first reading
    """
    rng = np.random.default_rng(seed)
    t = np.arange(n) / 100.0
    f = np.tile(np.asarray(force, float), (n, 1))
    f[:, 0] += 1e-3 * (shake_mg * np.sin(2 * np.pi * 23 * t + 0.3)
                       + sway_mg * np.sin(2 * np.pi * 0.3 * t))
    w = np.tile(np.radians(rate_dps), (n, 1))
    if drives_off:
        f[n // 2 - n // 8:, 0] += 0.2 * np.sin(2 * np.pi * 1.3 * t[n // 2 - n // 8:])
    accel, gyro = (sensor or Sensor(1, 3.0)).counts(f, w, rng)
    if hangs:
        accel[:] = accel[0]
    meta = {key: value for key, value in meta.items() if key != "held_by_hand"}
    return Capture(meta, np.arange(n, dtype=np.int64) * 10000, accel, gyro,
                   (temp + rng.integers(-4, 5, n)).astype(np.int16))
