"""The noise of a capture at rest: how much flicker the sensor has when nothing else acts."""
import numpy as np

from ..errors import BadFile
from ..experiment import blocks, long_rest
from ..experiment.signal_measures import allan

SHORTEST_S = 20.0  # flicker shows from some seconds on


def levels(capture, path):
    """{sensor: flicker level (mg or deg/s)} of the longest rest; BadFile when there is none."""
    session = blocks.of(path, capture)
    rest = long_rest.longest(session)
    if rest is None or (rest[1] - rest[0]) / session.rate < SHORTEST_S:
        raise BadFile("%s: no rest of %g s or more to know the noise by" % (path, SHORTEST_S))
    found = {}
    for sensor in ("accel", "gyro"):
        if getattr(capture, sensor) is None:
            continue
        x = long_rest.scaled(session, sensor)[rest[0]:rest[1]]
        noise = session.noise_accel if sensor == "accel" else session.noise_gyro
        m = max(1, len(x) // 12)
        tau = m / session.rate
        excess = np.maximum(allan(x, m) ** 2 - noise ** 2 / tau, 0.0)
        found[sensor] = float(np.sqrt(excess.mean()))
    return found
