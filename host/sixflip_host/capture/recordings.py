"""The real recordings the simulator is held against; each as plain arrays.

They are found in SIXFLIP_DATA, or in ../shared/data beside the project.
"""
import gzip
import os
from pathlib import Path

import numpy as np

from ..errors import BadFile

TREE = "treeguard_mpu6050_vibration"
SUAREZ_REST = (50, 3600)  # samples of the first rest of the recording, see its README
XSENS_OFFSET = 32768


def folder():
    """Where the recordings are; BadFile when they are not."""
    root = Path(__file__).resolve().parents[3]
    place = Path(os.environ.get("SIXFLIP_DATA", root.parent / "shared" / "data"))
    if not (place / "README.md").is_file():
        raise BadFile("no recordings at %s: set SIXFLIP_DATA to the folder that holds them"
                      % place)
    return place


def suarez(place):
    """MPU6050 at rest for 35 s: counts (n, 6), 100 Hz, 16384 LSB/g and 131 LSB per deg/s."""
    name = place / "suarez_mpu6050_multiposition" / "example_data_calibration.csv.gz"
    with gzip.open(name, "rt") as text:
        counts = np.loadtxt(text, delimiter=",", skiprows=5, max_rows=SUAREZ_REST[1])
    return counts[SUAREZ_REST[0]:]


def tree(place, name):
    """MPU6050 accelerometer on a tree: (counts (n, 3), temperature (n,), rate in Hz)."""
    with gzip.open(place / TREE / (name + ".csv.gz"), "rt") as text:
        rows = np.genfromtxt(text, delimiter=",", skip_header=1)
    rate = (len(rows) - 1) / (rows[-1, 0] - rows[0, 0]) * 1000.0
    return rows[:, 2:5], rows[:, 6], rate


def xsens(place):
    """38 poses: (accelerometer, gyro) counts (n, 3) each, 100 Hz, 415 LSB per m/s2 and 4778
    LSB per rad/s."""
    tables = []
    for name in ("xsens_acc.mat.gz", "xsens_gyro.mat.gz"):
        with gzip.open(place / "imu_tk_xsens_multiposition" / name, "rt") as text:
            tables.append(np.loadtxt(text)[:, 1:] - XSENS_OFFSET)
    return tables
