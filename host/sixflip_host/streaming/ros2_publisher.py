"""A publisher of sensor_msgs/msg/Imu that ROS 2 sees, by Eclipse Cyclone DDS without ROS.

How ROS 2 names things on DDS (its design article "Topic and service name mapping"): /imu/data_raw
is the topic rt/imu/data_raw, and the type is sensor_msgs::msg::dds_::Imu_. Its publishers are
reliable, volatile and keep ten.
"""

import os
import re
import time

from ..errors import CheckFailed, NoBoard, UsageError
from ..optional import need
from .imu_message import ABSENT

DOMAINS = 232               # ROS 2: domain ids 0 to 232 have UDP ports of their own
DEPTH = 10
DISCOVERY_S = 1.0           # for publishers and readers that are there already to be found
DELIVERY_S = 5.0            # at the end, for the last messages to arrive
NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")


def domain_id(asked=None):
    """The domain asked for, or ROS_DOMAIN_ID, or 0; UsageError where it is none."""
    text = str(asked) if asked is not None else os.environ.get("ROS_DOMAIN_ID") or "0"
    if not re.fullmatch(r"\d{1,9}", text) or int(text) > DOMAINS:
        raise UsageError("DDS domain %s: expected 0 to %d (--domain, or ROS_DOMAIN_ID)"
                         % (text, DOMAINS))
    return int(text)


def topic_name(name):
    """A ROS topic's name as it is; UsageError where ROS would not take it."""
    if not NAME.fullmatch(name):
        raise UsageError("--topic %s: expected a name like /imu/data_raw: letters, digits and _ "
                         "between slashes" % name)
    return name


class Ros2Publisher:
    """An open publisher; NoBoard where the domain cannot be opened, CheckFailed where another
    one publishes on the topic. publish(message), close()."""

    def __init__(self, topic, domain):
        need("--ros2", "ros2", "cyclonedds.domain")
        from cyclonedds.core import DDSException

        from . import imu_idl
        self.idl = imu_idl
        try:
            self._open(topic, domain)
        except DDSException as error:
            raise NoBoard("DDS domain %d cannot be opened: %s; expected a network interface, and "
                          "a CYCLONEDDS_URI that fits where there is one" % (
                              domain, " ".join(str(error).split()))) from None

    def _open(self, topic, domain):
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import Policy, Qos
        from cyclonedds.domain import DomainParticipant
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration
        participant = DomainParticipant(domain)
        others = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
        time.sleep(DISCOVERY_S)
        if any(publication.topic_name == "rt" + topic for publication in others.take(N=1000)):
            raise CheckFailed("%s has a publisher already in domain %d, expected none: --topic "
                              "names another" % (topic, domain))
        qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.Volatile,
                  Policy.History.KeepLast(DEPTH),
                  Policy.DataRepresentation(use_cdrv0_representation=True))
        self.writer = DataWriter(participant, Topic(participant, "rt" + topic, self.idl.Imu_),
                                 qos=qos)
        time.sleep(DISCOVERY_S)

    def publish(self, message):
        """Write one ImuMessage."""
        idl, (sec, nanosec) = self.idl, divmod(message.stamp_ns, 10 ** 9)
        self.writer.write(idl.Imu_(
            idl.Header_(idl.Time_(sec, nanosec), message.frame_id),
            idl.Quaternion_(0.0, 0.0, 0.0, 1.0), list(ABSENT),
            idl.Vector3_(*(message.rate or (0.0,) * 3)), list(message.rate_covariance),
            idl.Vector3_(*message.force), list(message.force_covariance)))

    def close(self):
        """Wait a moment for the last messages to arrive."""
        from cyclonedds.util import duration
        self.writer.wait_for_acks(duration(seconds=DELIVERY_S))
