"""Sessions at rest: one rest, the noise of whose gyro falls with the frequency; six, of a face
each, of an accelerometer alone."""
import numpy as np

from sixflip_host.capture.capture_file import Capture
from sixflip_host.experiment import blocks


def flicker(seed, n=20000):
    """(n, 3) counts whose spectrum falls with the frequency."""
    generator, hz = np.random.default_rng(seed), np.fft.rfftfreq(n, 0.01)
    hz[0] = np.inf
    slow = np.fft.irfft(hz[:, None] ** -0.5 * np.fft.rfft(generator.standard_normal((n, 3)),
                                                          axis=0), n, axis=0)
    return 10.0 * slow / slow.std(axis=0) + 2.0 * generator.standard_normal((n, 3))


def at_rest(gyro):
    n = len(gyro)
    accel = [0.0, 0.0, 16384.0] + 46.0 * np.random.default_rng(1).standard_normal((n, 3))
    meta = {"sensor": "mpu6050", "accel_lsb_per_g": 16384.0, "gyro_lsb_per_dps": 65.5,
            "rate_hz": 100.0}
    return blocks.session_of("s", Capture(
        meta, 10_000 * np.arange(n), np.rint(accel).astype(np.int16),
        np.rint(gyro).astype(np.int16), pose=np.ones(n, np.int16)))


def resting(noise, seed=5, n=200, **meta):
    """A session of six rests of n samples with noise of so many counts."""
    rng = np.random.default_rng(seed)
    accel = np.round(np.repeat(8192.0 * np.vstack([np.eye(3), -np.eye(3)]), n, axis=0)
                     + noise * rng.normal(size=(6 * n, 3))).astype(np.int16)
    head = {"sensor": "other", "rate_hz": 100.0, "accel_lsb_per_g": 8192.0, **meta}
    return blocks.session_of("resting", Capture(
        head, 10_000 * np.arange(6 * n), accel, pose=np.repeat(np.arange(1, 7), n)))
