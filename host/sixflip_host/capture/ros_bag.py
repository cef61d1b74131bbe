"""sensor_msgs/Imu out of a ROS bag: rosbag2 folders, .db3, .mcap, and ROS 1's .bag."""

import os
from pathlib import Path

import numpy as np

from ..errors import BadFile, UsageError
from ..optional import need

ENDINGS = (".db3", ".mcap", ".bag")
IMU = "sensor_msgs/msg/Imu"
NAMES = ("stamp_us", "ax", "ay", "az", "gx", "gy", "gz")
LONGEST_US = 1e16       # of a bag: three centuries


def is_bag(path):
    """True for a name or a folder that only a bag has."""
    path = str(path)
    return path.endswith(ENDINGS) or os.path.isfile(os.path.join(path, "metadata.yaml"))


class BagTable:
    """The messages of one topic, to be read like a csv_table.Table; SI units.

    stamp_us counts from the first message; the stamps are the messages' own, or where they all
    are 0 the times at which they were recorded.
    """

    def __init__(self, path, topic, values):
        self.path = path
        self.topic = topic
        self.values = values            # float (n, 7)
        self.names = [name for k, name in enumerate(NAMES) if np.isfinite(values[:, k]).all()]
        self.rows = values
        self.lines = [0] * len(values)  # a bag has none to name

    def index(self, column):
        """Position of a column given by name."""
        if column in self.names:
            return NAMES.index(column)
        raise BadFile("%s: there is no column %s, expected one of %s" % (
            self.path, column, " ".join(self.names)))

    def numbers(self, column):
        """The column as a list of floats."""
        return self.values[:, self.index(column)].tolist()

    def words(self, column):
        """A bag has no labels."""
        raise UsageError("%s: a bag has no column of labels, expected --sections" % self.path)


def read_bag(path, topic=None):
    """BagTable of the only Imu topic, or of the one that is asked for.

    Raises BadFile for what is no bag, or has no Imu topic; UsageError where the choice is open.
    """
    highlevel, typesys = need("a ROS bag", "data", "rosbags.highlevel", "rosbags.typesys")
    try:
        store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        with highlevel.AnyReader([Path(path)], default_typestore=store) as reader:
            chosen = _chosen(path, topic, reader.connections)
            rows = [_row(reader.deserialize(data, connection.msgtype), at)
                    for connection, at, data in reader.messages(chosen)]
    except (BadFile, UsageError):
        raise
    except OSError as error:
        raise BadFile("%s: cannot be read: %s" % (path, error.strerror or error))
    except Exception as error:      # a library that is fed with whatever the file holds
        raise BadFile("%s: is no ROS bag or a damaged one: %s" % (
            path, (str(error) or type(error).__name__).splitlines()[0][:200]))
    return _table(path, chosen[0].topic, rows)


def _chosen(path, topic, connections):
    """The connections of one Imu topic."""
    imu = [one for one in connections if one.msgtype == IMU]
    topics = sorted({one.topic for one in imu})
    if not topics:
        raise BadFile("%s: no topic of %s in it, expected one beside %s" % (
            path, IMU, ", ".join(sorted({"%s (%s)" % (one.topic, one.msgtype)
                                        for one in connections})) or "nothing"))
    if topic is None and len(topics) > 1:
        raise UsageError("%s: %d Imu topics, expected --topic with one of %s" % (
            path, len(topics), " ".join(topics)))
    if topic is not None and topic not in topics:
        raise UsageError("%s: no Imu topic %s, expected one of %s" % (
            path, topic, " ".join(topics)))
    return [one for one in imu if one.topic == (topic or topics[0])]


def _row(message, at):
    """(stamp ns, recorded ns, ax … gz of a message); NaN where the message says it has none."""
    stamp = message.header.stamp
    a, w = message.linear_acceleration, message.angular_velocity
    accel, gyro = (a.x, a.y, a.z), (w.x, w.y, w.z)
    if message.linear_acceleration_covariance[0] == -1:
        accel = (np.nan,) * 3
    if message.angular_velocity_covariance[0] == -1:
        gyro = (np.nan,) * 3
    return (stamp.sec * 1000000000 + stamp.nanosec, at, *accel, *gyro)


def _table(path, topic, rows):
    if not rows:
        raise BadFile("%s: %s holds no message" % (path, topic))
    stamps = [row[0] for row in rows]
    if not any(stamps):
        stamps = [row[1] for row in rows]
    values = np.array([row[1:] for row in rows], dtype=float)
    values[:, 0] = [(stamp - stamps[0]) / 1000 for stamp in stamps]
    _check(path, topic, values)
    return BagTable(path, topic, values)


def _check(path, topic, values):
    """BadFile for values that are missing here and there: all of them, or none."""
    for group, first in (("linear_acceleration", 1), ("angular_velocity", 4)):
        whole = np.isfinite(values[:, first:first + 3]).all(axis=1)
        if not whole.all() and (group == "linear_acceleration"
                                or not np.isnan(values[:, first:first + 3]).all()):
            raise BadFile("%s: message %d of %s has no %s, expected finite numbers" % (
                path, int(np.argmin(whole)) + 1, topic, group))
    if not np.abs(values[:, 0]).max() < LONGEST_US:
        raise BadFile("%s: the stamps of %s span %.3g s, expected a recording" % (
            path, topic, np.abs(values[:, 0]).max() / 1e6))
