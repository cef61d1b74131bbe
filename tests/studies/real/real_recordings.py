"""The recordings of ../shared/data: the import line of each, and the same samples by numpy alone.

Nothing here knows the diagnosis: a recording is read twice, by `sixflip import` and by the few
lines below, and what is said of the first is held against figures computed from the second.
"""
import gzip
from dataclasses import dataclass, field

import numpy as np

G = 9.80665
TREE = "treeguard_mpu6050_vibration"
TREE_STILL = ("non_event_far_new_sd_v3", "non_event_far_new_sd_v10", "non_event_far_new_sd_v24")
TREE_MOVED = ("ambient_1", "chain_far_new_sd_c39", "chainsaw_1", "machete_1")


@dataclass(frozen=True)
class Plain:
    """t (n,) s; accel (n, 3) mg; gyro (n, 3) deg/s or None; temp (n,) degC or None; counts:
    {"accel": (n, 3), "gyro": (n, 3)} whole numbers as recorded; stamped: t was recorded."""

    t: np.ndarray
    accel: np.ndarray
    gyro: object
    temp: object
    counts: dict
    stamped: bool

    @property
    def rate(self):
        return (len(self.t) - 1) / (self.t[-1] - self.t[0])

    def of(self, sensor):
        return self.accel if sensor == "accel" else self.gyro

    def part(self, first, end):
        def cut(values):
            return None if values is None else values[first:end]
        return Plain(self.t[first:end], self.accel[first:end], cut(self.gyro), cut(self.temp),
                     {k: v[first:end] for k, v in self.counts.items()}, self.stamped)


@dataclass(frozen=True)
class Recording:
    """name; file below the folder; read: function of its path to a Plain; options of `sixflip
    import`, or () where the file is no table; rows: the part that is looked at, None for all;
    short: looked at in `make test`."""

    name: str
    file: str
    read: object
    options: tuple = ()
    rows: tuple = None
    short: bool = False
    others: tuple = field(default=())  # names of recordings diagnosed together with it


def table(path, delimiter=",", skip=0):
    """(n, k) floats of a gzipped text table."""
    with gzip.open(path, "rt") as text:
        for _ in range(skip):
            next(text)
        return np.genfromtxt(text, delimiter=delimiter)


def counted(t, accel, gyro, temp, lsb, stamped):
    """Plain from whole counts; lsb: counts per g and per deg/s."""
    counts = {"accel": np.rint(accel).astype(int)}
    if gyro is not None:
        counts["gyro"] = np.rint(gyro).astype(int)
    return Plain(t, accel * 1000.0 / lsb[0], None if gyro is None else gyro / lsb[1], temp,
                 counts, stamped)


def tree(path):
    rows = table(path, skip=1)
    return counted(rows[:, 0] / 1e3, rows[:, 2:5], None, rows[:, 6], (16384.0, 1.0), True)


def suarez(path):
    rows = table(path, skip=4)
    rows = rows[np.isfinite(rows).all(axis=1)]
    return counted(np.arange(len(rows)) / 100.0, rows[:, :3], rows[:, 3:6], None,
                   (16384.0, 131.0), False)


def tofupilot(path):
    rows = table(path, "\t", 1)
    accel, gyro = rows[:, 4:7] / G * 1000.0, np.degrees(rows[:, 1:4])
    return Plain((rows[:, 0] - rows[0, 0]) / 1e6, accel, gyro, rows[:, 8], {}, True)


def mikoff(path):
    rows = table(path, None)
    accel, gyro = rows[:, :3] / G * 2048.0, np.degrees(rows[:, 3:6]) * 16.4
    return counted(np.arange(len(rows)) / 100.0, accel, gyro, None, (2048.0, 16.4), False)


def ferraris(path):
    rows = table(path, skip=1)
    accel, gyro = rows[:, 4:7] / 0.0047900390625, rows[:, 1:4] / 0.06103515625
    return counted(np.arange(len(rows)) / 102.4, accel, gyro, None,
                   (G / 0.0047900390625, 1.0 / 0.06103515625), False)


def xsens(path):
    accel = table(path, None)
    gyro = table(path.parent / "xsens_gyro.mat.gz", None)
    return counted(accel[:, 0] - accel[0, 0], accel[:, 1:] - 32768.0, gyro[:, 1:] - 32768.0,
                   None, (415.0 * 9.81744, 4778.0 * np.pi / 180.0), True)


def botlab(path):
    with np.load(path) as data:
        t = np.maximum.accumulate(data["imu_log_us"])
        return counted((t - t[0]) / 1e6, data["imu_acc_lsb"].astype(float),
                       data["imu_gyro_lsb"].astype(float), None, (16384.0, 131.0), True)


TREE_OPTIONS = ("--sensor", "mpu6050", "--accel-lsb", "16384", "--time-column", "timestamp_ms",
                "--time-unit", "ms", "--map", "temp=temp_c", "--temp-units", "c")
SUAREZ_OPTIONS = ("--sensor", "mpu6050", "--skip", "4", "--columns", "ax,ay,az,gx,gy,gz",
                  "--rate", "100", "--accel-lsb", "16384", "--gyro-lsb", "131")
TOFU_OPTIONS = ("--sensor", "mpu6050", "--units", "si,rad/s", "--time-column", "timestamp",
                "--time-unit", "us", "--accel-lsb", "16384", "--gyro-lsb", "131", "--map",
                "ax=imu.acc.x,ay=imu.acc.y,az=imu.acc.z,gx=imu.gyro.x,gy=imu.gyro.y,"
                "gz=imu.gyro.z,temp=imu.temperature", "--temp-units", "c")
MIKOFF_OPTIONS = ("--delimiter", "blank", "--columns", "ax,ay,az,gx,gy,gz", "--rate", "100",
                  "--units", "si,rad/s", "--accel-lsb", "2048", "--gyro-lsb", "16.4")

RECORDINGS = [
    Recording("tofupilot, one rest", "tofupilot_thermal_sweep/imu_raw_data.csv.gz", tofupilot,
              TOFU_OPTIONS, short=True),
    Recording("tofupilot, cooling half", "tofupilot_thermal_sweep/imu_raw_data.csv.gz",
              tofupilot, TOFU_OPTIONS, (0, 3000)),
    *[Recording("tree, " + name, "%s/%s.csv.gz" % (TREE, name), tree, TREE_OPTIONS,
                short=name == TREE_STILL[0])
      for name in TREE_STILL + TREE_MOVED],
    Recording("tree, three still files", "%s/%s.csv.gz" % (TREE, TREE_STILL[0]), tree,
              TREE_OPTIONS, None, True, ("tree, " + TREE_STILL[1], "tree, " + TREE_STILL[2])),
    Recording("Xsens, first rest", "imu_tk_xsens_multiposition/xsens_acc.mat.gz", xsens, (),
              (0, 5000), True),
    Recording("Suarez, first rest",
              "suarez_mpu6050_multiposition/example_data_calibration.csv.gz", suarez,
              SUAREZ_OPTIONS, (50, 3700), True),
    Recording("botlab, driving", "botlab_maebot_lidar_imu_odom/convex_decoded.npz", botlab, (),
              None, True),
    Recording("Xsens, 38 poses", "imu_tk_xsens_multiposition/xsens_acc.mat.gz", xsens),
    Recording("Suarez, ten poses",
              "suarez_mpu6050_multiposition/example_data_calibration.csv.gz", suarez,
              SUAREZ_OPTIONS),
    Recording("Suarez, one turn", "suarez_mpu6050_multiposition/imu_90_x_rot.csv.gz", suarez,
              SUAREZ_OPTIONS),
    Recording("Ferraris, six faces", "imucal_ferraris/example_ferraris_session.csv.gz",
              ferraris, ("--units", "si,dps", "--rate", "102.4")),
    Recording("mikoff, imu1", "mikoff_mpu9150_multiposition/imu1.log.gz", mikoff,
              MIKOFF_OPTIONS),
    Recording("mikoff, imu3", "mikoff_mpu9150_multiposition/imu3.log.gz", mikoff,
              MIKOFF_OPTIONS),
]
