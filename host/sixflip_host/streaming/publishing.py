"""A board's corrected stream, sample by sample to the publishers that were asked for."""

import contextlib

from sixflip.record import correction_record

from ..calibrate.verify_files import newest_of
from ..errors import UsageError
from ..file_arguments import add_input
from .imu_message import FRAME, TOPIC, ImuMessages

RECORDS = ("record_a.bin", "record_b.bin")


def add_arguments(parser):
    """The options of sixflip stream that are about robots."""
    group = parser.add_argument_group("for robots")
    group.add_argument("--ros2", action="store_true",
                       help="publish sensor_msgs/msg/Imu for ROS 2, by Cyclone DDS without ROS")
    group.add_argument("--foxglove", action="store_true",
                       help="serve the same to Foxglove over a WebSocket of this computer")
    group.add_argument("--topic", help="default: %s" % TOPIC)
    group.add_argument("--frame-id", metavar="NAME", help="of the sensor (default: %s)" % FRAME)
    group.add_argument("--domain", metavar="N",
                       help="DDS domain (default: $ROS_DOMAIN_ID, or 0)")
    group.add_argument("--foxglove-port", type=int, metavar="N", help="default: 8765")
    add_input(group, "--record", metavar="FILE",
              help="the record the covariances are from (default: the board's, which is read "
                   "first, and its firmware started anew)")


def asked(args):
    """Whether anything is to be published; UsageError for options that do not go together."""
    wanted = args.ros2 or args.foxglove
    for name in ("topic", "frame_id", "record", "domain", "foxglove_port"):
        if getattr(args, name) is None:
            continue
        needs = {"domain": args.ros2, "foxglove_port": args.foxglove}.get(name, wanted)
        if not needs:
            raise UsageError("--%s is an option of %s" % (name.replace("_", "-"), {
                "domain": "--ros2", "foxglove_port": "--foxglove"}.get(
                    name, "--ros2 and --foxglove")))
    if wanted and args.what != "corrected":
        raise UsageError("--%s cannot be published: --ros2 and --foxglove take the corrected "
                         "samples" % args.what)
    return wanted


class Publishing:
    """The open publishers of a stream; publish(t_us, values) to all of them.

    say(text) hears where they are and what the board's clock does
    """

    def __init__(self, args, record, stack, say):
        from .foxglove_server import PORT, FoxgloveServer
        from .ros2_publisher import Ros2Publisher, domain_id, topic_name
        topic = topic_name(args.topic or TOPIC)
        self.messages = ImuMessages(record, args.frame_id or FRAME, say)
        self.open, self.taken = [], 0
        if args.ros2:
            domain = domain_id(args.domain)
            self._add(Ros2Publisher(topic, domain), stack)
            say("publishing %s in DDS domain %d" % (topic, domain))
        if args.foxglove:
            server = FoxgloveServer(topic, PORT if args.foxglove_port is None
                                    else args.foxglove_port)
            self._add(server, stack)
            say("serving %s at %s" % (topic, server.url))
        if record is None:
            say("there is no correction record: the covariances are unknown, all zero")

    def _add(self, publisher, stack):
        stack.callback(publisher.close)
        self.open.append(publisher)

    def publish(self, t_us, values):
        """One corrected sample to everybody."""
        message = self.messages.message(t_us, values)
        for publisher in self.open:
            publisher.publish(message)
        self.taken += 1


def record_of(link):
    """The Record a board uses, or None; its firmware is started anew when it has been read."""
    records, there = [], link.files()
    for name in RECORDS:
        if name in there:
            with contextlib.suppress(ValueError):   # a slot torn by a power cut
                records.append(correction_record.decode(link.get(name)))
    link.restart_firmware()
    return newest_of(records) if records else None
