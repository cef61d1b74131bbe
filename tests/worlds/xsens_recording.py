"""imu_tk's Xsens recording as a Capture.

Two gzipped text files of fixed-width columns: time in s, then x y z as unsigned 16 bit counts
around 32768. Nominal scales: 415 counts per m/s² and 4778 per rad/s (the factory's, as Tedaldi
et al. quote it); gravity where it was taken 9.81744 m/s² (imu_tk's own test program).
"""

import gzip

import numpy as np

from sixflip_host.calibrate import multiposition
from sixflip_host.capture.capture_file import Capture

G = 9.81744
OFFSET = 32768
ACCEL_LSB = 415.0  # per m/s²
GYRO_LSB = 4778.0  # per rad/s
INITIAL_REST = 5001  # samples: the 50 s imu_tk's test program is told


def read(recordings):
    """The Capture of the folder `recordings`, without poses."""
    folder = recordings / "imu_tk_xsens_multiposition"
    tables = []
    for name in ("xsens_acc.mat.gz", "xsens_gyro.mat.gz"):
        with gzip.open(folder / name, "rt") as text:
            tables.append(np.loadtxt(text))
    accel, gyro = tables
    meta = {"sensor": "other", "rate_hz": 100, "g": G, "accel_lsb_per_g": ACCEL_LSB * G,
            "gyro_lsb_per_dps": GYRO_LSB * np.pi / 180}
    return Capture(meta, np.rint(accel[:, 0] * 1e6).astype(np.int64),
                   (accel[:, 1:] - OFFSET).astype(np.int16),
                   (gyro[:, 1:] - OFFSET).astype(np.int16))


def measured(capture):
    """Accelerometer of the capture in m/s² by the nominal scale, (n, 3)."""
    return capture.accel / ACCEL_LSB


def leave_one_out(means, start):
    """|a| - g of every pose by the fit of all the others, shape (n,), m/s². means (n, 3) m/s²;
    start: the parameters that every fit begins at."""
    left = np.empty(len(means))
    for k in range(len(means)):
        fit = multiposition.solve(np.delete(means, k, axis=0), G, start)
        left[k] = -multiposition.norm_residual(fit.parameters, means[k : k + 1], G)[0]
    return left
