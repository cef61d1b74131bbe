"""A whole session with its capture: prints poses, bytes written and the most heap in use."""

import sys

HERE = __file__[: __file__.rindex("/")]
sys.path[:0] = [HERE + "/../shared", HERE + "/../../shared"]

import gc  # noqa: E402  after the path is set

from sixflip.poses.session import COMPLETE, POSE, Session  # noqa: E402

gc.collect()
from sixflip.capture.writer import BlockWriter  # noqa: E402

gc.collect()
from synthetic_operator import Operator  # noqa: E402

written = [0]
most = [0]


def write(data):
    written[0] += len(data)


session = Session(16384, 65.5, 32767, 32767, 100)
writer = BlockWriter(write, b'{"sensor": "mpu6050"}')


def sink(dt_us, sample):
    event = session.feed(dt_us, sample)
    writer.add(dt_us, sample)
    if event in (POSE, COMPLETE):
        writer.pose(session.placements[-1])
        gc.collect()
        most[0] = max(most[0], gc.mem_alloc())
    return event


Operator(sink).six_faces()
writer.end(not session.missing())
print("poses", len(session.placements), "bytes", written[0], "most", most[0])
