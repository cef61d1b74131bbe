"""What is streamed, and how: samples as lines or as binary frames
(sixflip/capture/stream_frame.py), angles, or every sample as the blocks of a capture
(sixflip/capture/pieces.py).

Angles are roll, pitch and yaw of the corrected samples (sixflip/gyro/heading.py, Li Eq. 8), in
degrees, yaw from where the stream began and not wrapped; every sample is integrated, not only
those that are sent. The blocks make logs of hours, whose times do not wrap.
"""

import math
from array import array

from sixflip.capture.pieces import PieceWriter
from sixflip.capture.stream_frame import CORRECTED, RAW, FrameWriter
from sixflip.capture.writer import BlockWriter
from sixflip.gyro.heading import Heading

from ..capture.meta import columns, meta_bytes, session_number


class LineOutput:
    """Sample events: a in m/s2 and w in rad/s, or the seven raw counts."""

    def __init__(self, firmware):
        self._firmware = firmware
        self._out = array("f", [0.0] * 6)

    def step(self, sample, dt_us):
        """Nothing happens between two samples that are sent."""

    def send(self, t_us, sample):
        """Sends a sample that is due, at t_us since the stream began."""
        firmware = self._firmware
        if firmware.raw:
            firmware.events.emit("sample", t_us=t_us, raw=sample)
            return
        out = firmware.correction.apply(sample, self._out)
        w = out[3:] if firmware.sensor.imu.has_gyro else None
        firmware.events.emit("sample", t_us=t_us, a=out[:3], w=w)


class BinaryOutput:
    """Raw counts, or a in m/s2 and w in rad/s; w is NaN where there is no gyro."""

    def __init__(self, firmware):
        self._firmware = firmware
        self._frames = FrameWriter(RAW if firmware.raw else CORRECTED)
        self._out = array("f", [0.0] * 6)

    def step(self, sample, dt_us):
        """Nothing happens between two samples that are sent."""

    def send(self, t_us, sample):
        """Sends a sample that is due, at t_us since the stream began."""
        firmware = self._firmware
        if not firmware.raw:
            sample = firmware.correction.apply(sample, self._out)
            if not firmware.sensor.imu.has_gyro:
                sample[3] = sample[4] = sample[5] = float("nan")
        firmware.board.write_bytes(self._frames.frame(t_us, sample))


class BlockOutput:
    """Raw counts at the rate they are read, whatever stream_hz is."""

    def __init__(self, firmware):
        self._pieces = PieceWriter(firmware.board.write_bytes)
        self._writer = None
        meta = meta_bytes(firmware, session_number(firmware.board))
        self._writer = BlockWriter(self._write, meta, columns(firmware.sensor.imu))

    def _write(self, data):
        self._pieces.send(self._writer.written if self._writer else 0, data)

    def step(self, sample, dt_us):
        """Takes every sample, dt_us after the one before."""
        self._writer.add(dt_us, sample)

    def send(self, t_us, sample):
        """Nothing beside the blocks."""


class HeadingOutput:
    """As lines, {"event": "heading", "t_us", "roll_deg", "pitch_deg", "yaw_deg"}, or frames."""

    def __init__(self, firmware):
        self._firmware = firmware
        self._heading = _heading(firmware)
        self._out = array("f", [0.0] * 6)
        self._angles = (0.0, 0.0, 0.0)
        self._frames = None
        if firmware.binary:
            from sixflip.capture.stream_frame import HEADING, FrameWriter
            self._frames = FrameWriter(HEADING)

    def step(self, sample, dt_us):
        """Takes every sample, dt_us after the one before."""
        out = self._firmware.correction.apply(sample, self._out)
        self._angles = self._heading.step(out[:3], out[3:], dt_us * 1e-6)

    def send(self, t_us, sample):
        """Sends a sample that is due, at t_us since the stream began."""
        roll, pitch, yaw = [math.degrees(x) for x in self._angles]
        if self._frames:
            self._firmware.board.write_bytes(self._frames.frame(t_us, (roll, pitch, yaw)))
        else:
            self._firmware.events.emit("heading", t_us=t_us, roll_deg=roll, pitch_deg=pitch,
                                   yaw_deg=yaw)


def _heading(firmware):
    given = firmware.settings["heading"] or {}
    g = firmware.settings["g"]
    try:
        return Heading(given.get("gain", -0.02), given.get("lever_arm"), g)
    except (TypeError, ValueError) as e:
        firmware.events.error("heading in sixflip.json: %s" % e,
                          "a gain above -1 and up to 0; -0.02 is used")
        return Heading(g=g)
