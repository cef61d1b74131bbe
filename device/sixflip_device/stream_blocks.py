"""Every sample to the host as the blocks of a capture (sixflip.capture.pieces), without a
session: for logs of hours, whose times do not wrap."""

from sixflip.capture.pieces import PieceWriter
from sixflip.capture.writer import BlockWriter

from .capture_meta import columns, meta_bytes, session_number


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
