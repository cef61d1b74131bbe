"""Samples as binary frames (sixflip.capture.stream_frame) instead of lines."""

from array import array

from sixflip.capture.stream_frame import CORRECTED, RAW, FrameWriter


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
