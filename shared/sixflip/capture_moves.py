"""The moves of a session that is in a file, summed up from its samples as while they came."""

from array import array

from sixflip.capture_blocks import US, places
from sixflip.capture_samples import each, start
from sixflip.placement_log import PlacementLog, empty_move
from sixflip.still_window import StillWindow

LENGTH = 32  # samples summed up in one go; any number will do


class CaptureMoves:
    """block() of every block of samples in the file's order; then moves() has them.

    placements  in force in that file; columns: its mask; gyro_rail: |count| at or beyond is
                saturated, 0 without a gyro; lsb_per_dps: its counts
    """

    def __init__(self, placements, columns, period_us, gyro_rail, lsb_per_dps):
        self._to_come = list(placements)
        self._log = PlacementLog(period_us, lsb_per_dps if gyro_rail else 0)
        self._window = StillWindow(LENGTH, US, gyro_rail, period_us)
        self._places = places(columns)
        self._row = array("h", [0] * 10)
        self._counts = array("h", [0] * len(self._places))
        self._last_us = 0
        self._last_s = 0
        self._at = 0

    def block(self, block):
        payload = block[4:-4]
        seconds, us, count = start(payload)
        # in it the first sample has no interval
        before = (seconds - self._last_s) * US + us - self._last_us
        for dt in each(block[0], payload, count, self._counts):
            us += dt
            for k in range(len(self._places)):
                self._row[self._places[k]] = self._counts[k]
            self._sample(before + dt)
            before = 0
        self._last_s = seconds + us // US
        self._last_us = us % US

    def skip(self, n):
        """So many samples are left out: a gap in the move under way."""
        self._at += n

    def _sample(self, dt_us):
        to_come = self._to_come
        if to_come and self._at == to_come[0].first:
            self._flush()
            self._log.accept(to_come.pop(0))
        self._at += 1
        full = self._window.add(dt_us, self._row)
        placements = self._log.placements
        if placements and self._at == placements[-1].first + placements[-1].n:
            self._window.clear()
        elif full and not self._resting():
            self._log.add(self._window)

    def _resting(self):
        placements = self._log.placements
        return placements and self._at < placements[-1].first + placements[-1].n

    def _flush(self):
        if self._window.n < LENGTH:  # a full one is in the move already
            self._log.add(self._window)
        self._window.clear()

    def moves(self):
        """To each of the placements, and the one that was under way at the end. Where samples
        were not kept nothing is known of a move: it has none."""
        if self._to_come:
            return self._log.moves + [empty_move(0) for _ in range(len(self._to_come) + 1)]
        if not self._resting():
            self._flush()
        return self._log.moves + [self._log.open]
