"""A WebSocket server that Foxglove connects to: the same messages, ROS 2's encoding and schema."""

import contextlib
import time

from ..errors import NoBoard, UsageError
from ..export.export_mcap import IMU
from ..optional import need

HOST, PORT = "127.0.0.1", 8765      # Foxglove's own default port
WAIT_S = 1.0        # for clients that try again and again to connect; for the last messages


class FoxgloveServer:
    """An open server; NoBoard where the port is taken. publish(message), close()."""

    def __init__(self, topic, port=PORT):
        if not 0 <= port <= 65535:
            raise UsageError("--foxglove-port %d: expected 0 to 65535" % port)
        foxglove = need("--foxglove", "foxglove", "foxglove")
        self.context = foxglove.Context()   # the channel is open as long as this is there
        try:
            self.server = foxglove.start_server(name="sixflip", host=HOST, port=port,
                                                context=self.context)
        except Exception as error:      # the library has no narrower one
            raise NoBoard("port %d of %s cannot be opened for Foxglove: %s; expected a free one: "
                          "--foxglove-port" % (port, HOST, error)) from None
        schema = foxglove.Schema(name="sensor_msgs/msg/Imu", encoding="ros2msg",
                                 data=IMU.encode())
        self.channel = foxglove.Channel(topic, schema=schema, message_encoding="cdr",
                                        context=self.context)
        time.sleep(WAIT_S)

    @property
    def url(self):
        """Where Foxglove connects to."""
        return "ws://%s:%d" % (HOST, self.server.port)

    def publish(self, message):
        """Send one ImuMessage to whoever has subscribed; its stamp is the board's, its log time
        that of this computer."""
        self.channel.log(message.cdr(), log_time=time.time_ns())

    def close(self):
        """Say goodbye to the clients, once the last messages had the time to go out: stop()
        drops what still waits."""
        time.sleep(WAIT_S)
        with contextlib.suppress(Exception):    # a client that went away first
            self.channel.close()
        self.server.stop()
