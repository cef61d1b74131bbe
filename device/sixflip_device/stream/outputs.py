"""Roll, pitch and yaw of the corrected samples (sixflip.gyro.heading, Li Eq. 8) in the stream.

Every sample is integrated, not only those that are sent. Angles in degrees, yaw from where the
stream began and not wrapped. "heading" in sixflip.json may hold gain and lever_arm.

Samples as binary frames (sixflip.capture.stream_frame) instead of lines.

Every sample to the host as the blocks of a capture (sixflip.capture.pieces), without a
session: for logs of hours, whose times do not wrap.
"""

import math
from array import array

from sixflip.capture.pieces import PieceWriter
from sixflip.capture.stream_frame import CORRECTED, RAW, FrameWriter
from sixflip.capture.writer import BlockWriter
from sixflip.gyro.heading import Heading

from ..capture.meta import columns, meta_bytes, session_number


class BinaryOutput:
    """Raw counts, or a in m/s2 and w in rad/s; w is NaN where there is no gyro."""

    def __init__(self, unit):
        self._unit = unit
        self._frames = FrameWriter(RAW if unit.raw else CORRECTED)
        self._out = array("f", [0.0] * 6)

    def step(self, sample, dt_us):
        """Nothing happens between two samples that are sent."""

    def send(self, t_us, sample):
        unit = self._unit
        if not unit.raw:
            sample = unit.correction.apply(sample, self._out)
            if not unit.sensor.imu.has_gyro:
                sample[3] = sample[4] = sample[5] = float("nan")
        unit.board.write_bytes(self._frames.frame(t_us, sample))


class BlockOutput:
    """Raw counts at the rate they are read, whatever stream_hz is."""

    def __init__(self, unit):
        self._pieces = PieceWriter(unit.board.write_bytes)
        self._writer = None
        self._writer = BlockWriter(self._write, meta_bytes(unit, session_number(unit.board)),
                                   columns(unit.sensor.imu))

    def _write(self, data):
        self._pieces.send(self._writer.written if self._writer else 0, data)

    def step(self, sample, dt_us):
        self._writer.add(dt_us, sample)

    def send(self, t_us, sample):
        """Nothing beside the blocks."""


class HeadingOutput:
    """As lines, {"event": "heading", "t_us", "roll_deg", "pitch_deg", "yaw_deg"}, or frames."""

    def __init__(self, unit):
        self._unit = unit
        self._heading = _heading(unit)
        self._out = array("f", [0.0] * 6)
        self._angles = (0.0, 0.0, 0.0)
        self._frames = None
        if unit.binary:
            from sixflip.capture.stream_frame import HEADING, FrameWriter
            self._frames = FrameWriter(HEADING)

    def step(self, sample, dt_us):
        out = self._unit.correction.apply(sample, self._out)
        self._angles = self._heading.step(out[:3], out[3:], dt_us * 1e-6)

    def send(self, t_us, sample):
        roll, pitch, yaw = [math.degrees(x) for x in self._angles]
        if self._frames:
            self._unit.board.write_bytes(self._frames.frame(t_us, (roll, pitch, yaw)))
        else:
            self._unit.events.emit("heading", t_us=t_us, roll_deg=roll, pitch_deg=pitch,
                                   yaw_deg=yaw)


def _heading(unit):
    given = unit.settings["heading"] or {}
    g = unit.settings["g"]
    try:
        return Heading(given.get("gain", -0.02), given.get("lever_arm"), g)
    except (TypeError, ValueError) as e:
        unit.events.error("heading in sixflip.json: %s" % e,
                          "a gain above -1 and up to 0; -0.02 is used")
        return Heading(g=g)
