"""Another program on the loopback that reads what sixflip stream publishes, by rosbags' decoder.

second_participant.py dds DOMAIN TOPIC COUNT, or foxglove PORT TOPIC COUNT. It knows no class of
Sixflip. Prints a line of JSON: the messages, when each was stamped by its sender and got here.
"""

import json
import struct
import sys
import time

from rosbags.typesys import Stores, get_typestore

PATIENCE_S = 60.0
KIND = "sensor_msgs/msg/Imu"


class Raw:
    """The bytes of a message instead of an object."""

    def __init__(self, data):
        self.data = bytes(data)


def dds(domain, topic, count):
    """[(bytes, sent ns, received ns)] of a ROS 2 topic; the type is the one the wire tells of."""
    from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
    from cyclonedds.core import Policy, Qos
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.dynamic import get_types_for_typeid
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration
    participant = DomainParticipant(int(domain))
    builtin = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
    print("ready", flush=True)
    end, there = time.monotonic() + PATIENCE_S, []
    while not there and time.monotonic() < end:
        there = [one for one in builtin.take(N=100) if one.topic_name == "rt" + topic]
        time.sleep(0.005)
    assert there[0].type_name == "sensor_msgs::msg::dds_::Imu_", there
    kind, _ = get_types_for_typeid(participant, there[0].type_id, duration(seconds=5))
    kind.deserialize = staticmethod(Raw)
    reader = DataReader(participant, Topic(participant, "rt" + topic, kind), qos=Qos(
        Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepAll,
        Policy.DataRepresentation(use_cdrv0_representation=True)))
    found = []
    while len(found) < count and time.monotonic() < end:
        for one in reader.take(N=100):
            found.append((one.data, one.sample_info.source_timestamp, time.time_ns()))
        time.sleep(0.0005)
    return found


def foxglove(port, topic, count):
    """[(bytes, stamped ns, received ns)] by the protocol of foxglove/ws-protocol."""
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect
    end = time.monotonic() + PATIENCE_S
    print("ready", flush=True)
    while True:
        try:
            link = connect("ws://127.0.0.1:" + port, subprotocols=["foxglove.sdk.v1"])
            break
        except OSError:
            assert time.monotonic() < end
            time.sleep(0.02)
    found = []
    with link:
        while len(found) < count:
            try:
                said = link.recv(timeout=PATIENCE_S)
            except ConnectionClosed:    # the test says how many are missing
                break
            now = time.time_ns()
            if isinstance(said, bytes):
                _, _, stamp = struct.unpack_from("<BIQ", said)
                found.append((said[13:], stamp, now))
                continue
            for channel in json.loads(said).get("channels", []):
                if channel["topic"] == topic:
                    assert channel["encoding"] == "cdr" and channel["schemaName"] == KIND
                    link.send(json.dumps({"op": "subscribe", "subscriptions": [
                        {"id": 1, "channelId": channel["id"]}]}))
    return found


def main(kind, where, topic, count):
    store = get_typestore(Stores.ROS2_HUMBLE)
    rows = []
    for data, sent, received in {"dds": dds, "foxglove": foxglove}[kind](where, topic, int(count)):
        imu = store.deserialize_cdr(data, KIND)
        rows.append({
            "stamp_ns": imu.header.stamp.sec * 10 ** 9 + imu.header.stamp.nanosec,
            "frame_id": imu.header.frame_id, "sent_ns": sent, "received_ns": received,
            "orientation_covariance": imu.orientation_covariance.tolist(),
            "rate": [imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z],
            "force": [imu.linear_acceleration.x, imu.linear_acceleration.y,
                      imu.linear_acceleration.z],
            "rate_covariance": imu.angular_velocity_covariance.tolist(),
            "force_covariance": imu.linear_acceleration_covariance.tolist()})
    print(json.dumps(rows), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
