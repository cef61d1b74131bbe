"""sensor_msgs/Imu out of a ROS bag: rosbag2 folders, .db3, .mcap, and ROS 1's .bag."""

import itertools
import os
from pathlib import Path

import numpy as np

from ... import sample_limit
from ...errors import BadFile, UsageError
from ...optional import need
from .csv_table import Block

ENDINGS = (".db3", ".mcap", ".bag")
IMU = "sensor_msgs/msg/Imu"
NAMES = ("stamp_us", "ax", "ay", "az", "gx", "gy", "gz")
LONGEST_US = 1e16       # of a bag: three centuries
ROWS = 10_000           # messages at a time


def is_bag(path):
    """True for a name or a folder that only a bag has."""
    path = str(path)
    return path.endswith(ENDINGS) or os.path.isfile(os.path.join(path, "metadata.yaml"))


class BagTable:
    """The messages of one topic, to be read like a csv_table.Table; SI units, as sensor_msgs/Imu
    says.

    stamp_us counts from the first message; the stamps are the messages' own, or where the first
    ones are 0 the times at which they were recorded.
    """

    units = {"a": "m/s2", "g": "rad/s"}

    def __init__(self, path, topic=None):
        self.path = path
        self.preamble, self.passed_over = (), {}
        self._asked = topic
        first = list(itertools.islice(self._messages(), 2))     # simulated time begins with one 0
        if not first:
            raise BadFile("%s: %s holds no message" % (path, self._topic))
        self._recorded = not any(row[0] for row in first)
        self._start = first[0][self._recorded]
        self.names = [name for name, value in zip(NAMES, first[0][1:]) if np.isfinite(value)]
        self.width = len(self.names)

    def index(self, column):
        """Position of a column given by name."""
        if column in self.names:
            return NAMES.index(column)
        raise BadFile("%s: there is no column %s, expected one of %s" % (
            self.path, column, " ".join(self.names)))

    def holds_numbers(self, column):
        """Every column does."""
        return True

    def blocks(self, columns, label=None):
        """csv_table.Block after Block of columns; BadFile for values missing here and there."""
        if label is not None:
            raise UsageError("%s: a bag has no column of labels, expected --sections" % self.path)
        places = [self.index(column) for column in columns]
        messages = self._messages()
        count = 0
        while rows := list(itertools.islice(messages, ROWS)):
            stamps = [row[self._recorded] - self._start for row in rows]
            values = np.array([row[1:] for row in rows], float)
            values[:, 0] = [stamp / 1000 for stamp in stamps]
            self._check(values, count)
            count += len(rows)
            sample_limit.check_samples(self.path, count)
            yield Block([0] * len(rows), values[:, places], None)

    def _messages(self):
        """(stamp ns, recorded ns, ax … gz) of every message."""
        highlevel, typesys = need("a ROS bag", "data", "rosbags.highlevel", "rosbags.typesys")
        try:
            store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
            with sample_limit.little_memory(), \
                    highlevel.AnyReader([Path(self.path)], default_typestore=store) as reader:
                chosen = _chosen(self.path, self._asked, reader.connections)
                self._topic = chosen[0].topic
                for connection, at, data in reader.messages(chosen):
                    yield _row(reader.deserialize(data, connection.msgtype), at)
        except (BadFile, UsageError):
            raise
        except MemoryError:
            raise BadFile("%s: its messages need more than %d MB, unpacked, expected less, or "
                          "--limit with the number of samples there may be" % (
                              self.path, sample_limit.memory() >> 20)) from None
        except OSError as error:
            raise BadFile("%s: cannot be read: %s" % (self.path, error.strerror or error)) \
                from None
        except Exception as error:      # a library that is fed with whatever the file holds
            raise BadFile("%s: is no ROS bag or a damaged one: %s" % (
                self.path, (str(error) or type(error).__name__).splitlines()[0][:200])) from None

    def _check(self, values, count):
        for group, first in (("linear_acceleration", 1), ("angular_velocity", 4)):
            whole = np.isfinite(values[:, first:first + 3]).all(axis=1)
            there = NAMES[first] in self.names or group == "linear_acceleration"
            if not (whole.all() if there else np.isnan(values[:, first:first + 3]).all()):
                raise BadFile("%s: message %d of %s has no %s, expected finite numbers" % (
                    self.path, count + int(np.argmin(whole)) + 1, self._topic, group))
        if not np.abs(values[:, 0]).max() < LONGEST_US:
            raise BadFile("%s: the stamps of %s span %.3g s, expected a recording" % (
                self.path, self._topic, np.abs(values[:, 0]).max() / 1e6))


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
