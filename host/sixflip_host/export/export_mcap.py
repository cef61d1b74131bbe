"""A capture, raw or corrected, as MCAP with ROS 2 messages: Foxglove, rosbag2, PlotJuggler.

Every sample is a sensor_msgs/Imu on /imu/data_raw (REP 145: no orientation in it), m/s² and
rad/s; without a record by the data sheet's numbers: counts / LSB * 9.80665 and counts / LSB *
pi / 180. The temperature goes to /imu/temperature. Stamps are the capture's own time, from 0.
"""

import io
import math

import numpy as np

from .. import atomic_write
from ..capture.capture_header import STANDARD_G
from ..optional import need
from .corrected_rows import corrected
from .export_tables import KEY, about

TOPIC = "/imu/data_raw"
TEMPERATURE_TOPIC = "/imu/temperature"
FRAME = "imu_link"
UNKNOWN = [0.0] * 9                     # sensor_msgs/Imu: all zeros, covariance unknown
ABSENT = [-1.0] + [0.0] * 8             # and -1 first: there is no such measurement
RULE = "=" * 80 + "\n"
HEADER = RULE + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + \
    RULE + "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
IMU = ("std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
       "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
       "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
       "float64[9] linear_acceleration_covariance\n" + HEADER + RULE +
       "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" + RULE +
       "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n")
TEMPERATURE = "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n" + HEADER


def mcap(output, capture, record=None, tell=None):
    """Write MCAP; the header of the capture is metadata of the name `sixflip`."""
    ros2 = need("format mcap", "data", "mcap_ros2.writer")
    t_us, accel, gyro, celsius = in_units(capture, record, tell)
    data = io.BytesIO()
    writer = ros2.Writer(data)
    imu = writer.register_msgdef("sensor_msgs/msg/Imu", IMU)
    temperature = writer.register_msgdef("sensor_msgs/msg/Temperature", TEMPERATURE) \
        if celsius is not None else None
    for k, t in enumerate(t_us):
        header = {"stamp": {"sec": t // 1000000, "nanosec": t % 1000000 * 1000},
                  "frame_id": FRAME}
        writer.write_message(TOPIC, imu, {
            "header": header, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            "orientation_covariance": ABSENT,
            "angular_velocity": _vector(gyro[k] if gyro else (0.0, 0.0, 0.0)),
            "angular_velocity_covariance": UNKNOWN if gyro else ABSENT,
            "linear_acceleration": _vector(accel[k]),
            "linear_acceleration_covariance": UNKNOWN}, log_time=t * 1000, sequence=k)
        if celsius:
            writer.write_message(TEMPERATURE_TOPIC, temperature, {
                "header": header, "temperature": celsius[k], "variance": 0.0},
                log_time=t * 1000, sequence=k)
    writer.add_metadata(KEY, {"about": about(capture, record)})
    writer.finish()
    atomic_write.write_bytes(output, data.getvalue())


def _vector(values):
    return dict(zip("xyz", values))


def in_units(capture, record=None, tell=None):
    """(t_us, accel m/s², gyro rad/s, °C) as lists, gyro and °C None where there is none.

    Times begin at 0 where the capture's are negative: MCAP has no time before 1970.
    """
    t_us = (capture.t_us - min(0, int(capture.t_us[0]))).tolist()
    celsius = None if capture.temp is None else (
        capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]).tolist()
    if record is not None:
        values, names = corrected(record, capture, tell)
        gyro = values[:, 3:6].tolist() if "gx_radps" in names else None
        return t_us, values[:, :3].tolist(), gyro, celsius
    accel = capture.accel * (STANDARD_G / capture.meta["accel_lsb_per_g"])
    gyro = None if capture.gyro is None else np.asarray(
        capture.gyro * (math.radians(1.0) / capture.meta["gyro_lsb_per_dps"])).tolist()
    return t_us, accel.tolist(), gyro, celsius
