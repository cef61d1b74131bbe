"""The real recordings as captures, counts and times as they were recorded.

Scales, formats and rates are those of each recording's README. Where a recording has no times
there is its stated rate; nothing is labelled unless its own files say what was done.
"""

import gzip
import json

import numpy as np

from sixflip.poses.faces import pose_code
from sixflip_host.capture import recordings
from sixflip_host.capture.capture_file import Capture

G = 9.80665
XSENS_G = 9.81744
XSENS_LSB = (415.0, 4778.0)  # per m/s², per rad/s
IMUCAL_LSB = (0.0047900390625, 0.06103515625)  # m/s², deg/s a count
MPU6050 = {"sensor": "mpu6050", "accel_lsb_per_g": 16384, "accel_range_g": 2}
THERMOMETER = {"temp_lsb_per_c": 340, "temp_offset_c": 36.53}
TREE_STILL = ("non_event_far_new_sd_v3", "non_event_far_new_sd_v10", "non_event_far_new_sd_v24")
TREE_MOVED = ("ambient_1", "chain_far_new_sd_c39", "chainsaw_1", "machete_1")
FERRARIS = {"x_p": "X+a", "x_a": "X-a", "y_p": "Y+a", "y_a": "Y-a", "z_p": "Z+a", "z_a": "Z-a"}


def xsens(place):
    """38 poses with motion between; no temperature, no labels."""
    accel, gyro = recordings.xsens(place)
    head = {"sensor": "other", "rate_hz": 100, "g": XSENS_G,
            "accel_lsb_per_g": XSENS_LSB[0] * XSENS_G,
            "gyro_lsb_per_dps": XSENS_LSB[1] * np.pi / 180.0}
    return _even(head, accel, gyro)


def tree(place, name):
    """MPU6050 accelerometer on a tree, 12 s, with the die's temperature and its own times."""
    with gzip.open(place / recordings.TREE / (name + ".csv.gz"), "rt") as text:
        rows = np.genfromtxt(text, delimiter=",", skip_header=1)
    rate = (len(rows) - 1) / (rows[-1, 0] - rows[0, 0]) * 1000.0
    temp = np.rint((rows[:, 6] - THERMOMETER["temp_offset_c"]) * THERMOMETER["temp_lsb_per_c"])
    return Capture(dict(MPU6050, **THERMOMETER, rate_hz=round(rate, 3)),
                   np.rint(rows[:, 0] * 1000.0).astype(np.int64), rows[:, 2:5].astype(np.int16),
                   None, temp.astype(np.int16))


def suarez(place, name="example_data_calibration"):
    """MPU6050, ten poses; no times, no temperature, no labels."""
    path = place / "suarez_mpu6050_multiposition" / (name + ".csv.gz")
    with gzip.open(path, "rt") as text:
        rows = np.genfromtxt((line for line in text if line.count(",") >= 5), delimiter=",")
    rows = rows[np.isfinite(rows).all(axis=1)]
    head = dict(MPU6050, rate_hz=100, gyro_lsb_per_dps=131, gyro_range_dps=250)
    return _even(head, rows[:, :3], rows[:, 3:6])


def ferraris(place):
    """Six faces and three turns, labelled by the recording's own list of sections."""
    folder = place / "imucal_ferraris"
    with gzip.open(folder / "example_ferraris_session.csv.gz", "rt") as text:
        rows = np.genfromtxt(text, delimiter=",", skip_header=1)
    sections = json.loads((folder / "example_ferraris_session_list.json").read_text())
    pose = np.zeros(len(rows), np.int16)
    for name, label in FERRARIS.items():
        pose[sections[name]["start"]:sections[name]["end"]] = pose_code(label)
    head = {"sensor": "other", "rate_hz": 102.4, "accel_lsb_per_g": G / IMUCAL_LSB[0],
            "gyro_lsb_per_dps": 1.0 / IMUCAL_LSB[1]}
    return _even(head, np.rint(rows[:, 4:7] / IMUCAL_LSB[0]), np.rint(rows[:, 1:4]
                                                                     / IMUCAL_LSB[1]), pose)


def botlab(place):
    """MPU on a small robot, 69 s of driving; times are those of arrival at the host."""
    with np.load(place / "botlab_maebot_lidar_imu_odom" / "convex_decoded.npz") as data:
        # arrival times: a few are some microseconds before the one before
        t = np.maximum.accumulate(data["imu_log_us"])
        accel, gyro = data["imu_acc_lsb"], data["imu_gyro_lsb"]
    rate = (len(t) - 1) * 1e6 / float(t[-1] - t[0])  # nobody says what was asked for
    head = dict(MPU6050, rate_hz=round(rate, 2), gyro_lsb_per_dps=131, gyro_range_dps=250)
    return Capture(head, (t - t[0]).astype(np.int64), accel.astype(np.int16),
                   gyro.astype(np.int16))


def _even(head, accel, gyro, pose=None):
    """Capture of a recording without times."""
    t_us = np.rint(np.arange(len(accel)) * 1e6 / head["rate_hz"]).astype(np.int64)
    return Capture(head, t_us, accel.astype(np.int16), gyro.astype(np.int16), None, None, pose)


def part(capture, first, end):
    """A stretch of a capture, from sample to sample."""
    def cut(column):
        return None if column is None else column[first:end]
    return Capture(dict(capture.meta), capture.t_us[first:end] - capture.t_us[first],
                   capture.accel[first:end], cut(capture.gyro), cut(capture.temp), None,
                   cut(capture.pose))
