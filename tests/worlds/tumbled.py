"""A thing that is turned about all its axes between stops, read by an MPU-6050."""
import numpy as np
from scipy.spatial.transform import Rotation

from sixflip_host.capture.capture import Capture

RATE_HZ = 100.0
META = {"sensor": "mpu6050", "rate_hz": RATE_HZ, "accel_lsb_per_g": 8192, "accel_range_g": 4,
        "gyro_lsb_per_dps": 65.5, "gyro_range_dps": 500}


def tumbled(seed, seconds=120.0):
    """(t, specific force g, rate deg/s) of a thing that is turned about all its axes between
    stops."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 20.0 - 3.0, 19.5 - t % 20.0) / 1.5, 0.0, 1.0)
    way = way ** 2 * (3.0 - 2.0 * way)
    rate = sum(size * np.sin(2.0 * np.pi * hz * t[:, None] + rng.uniform(0.0, 6.28, 3))
               for size, hz in ((70.0, 0.11), (50.0, 0.29), (25.0, 0.53))) * way[:, None]
    return t, attitudes(rate)[:, 2, :], rate


def attitudes(rate):
    """(n, 3, 3): body to world at each sample, from what turns at rate (n, 3) deg/s between it
    and the next."""
    turn, turns = np.eye(3), []
    for step in Rotation.from_rotvec(np.radians(rate) / RATE_HZ).as_matrix():
        turns.append(turn)
        turn = turn @ step
    return np.array(turns)


def read(t, force, rate, seed):
    """The Capture of readings in g and deg/s with the noise of an MPU-6050."""
    rng = np.random.default_rng(seed)
    accel = np.rint((force + 0.004 * rng.standard_normal(force.shape)) * 8192)
    gyro = np.rint((rate + 0.05 * rng.standard_normal(rate.shape)) * 65.5)
    return Capture(dict(META), np.rint(1e6 * t).astype(np.int64), accel.astype(np.int16),
                   np.clip(gyro, -32768, 32767).astype(np.int16))
