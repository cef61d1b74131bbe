"""One sample a period by the board's clock; now and then, whether the chip is awake."""

from .bus_recovery import READ

CHECK_EVERY = 8  # samples between two questions to the chip


def pacer(board, sensor, rate_hz):
    """What gives one sample after the other: by polling, or out of the chip's FIFO."""
    if sensor.imu.fifo is None:
        return Pacer(board, sensor, rate_hz)
    from .fifo_pacer import FifoPacer
    return FifoPacer(board, sensor)


class Pacer:
    """next(sample) waits until the next sample is due and reads it; nothing is allocated.

    Microseconds are small integers throughout: 31 bits hold 17 minutes of them, and
    differences are taken by the board's ticks_diff.
    """

    def __init__(self, board, sensor, rate_hz):
        self._board = board
        self._sensor = sensor
        self._period = 1000000 // int(rate_hz)
        self._ahead = 0
        self._countdown = CHECK_EVERY
        self._last = board.ticks_us()

    def next(self, sample):
        """Microseconds since the sample before, or -1: the chip was set up anew and what is
        in sample must not be used. The interval after a -1 covers the time that was lost.
        """
        board = self._board
        wait = self._period + self._ahead - board.ticks_diff(board.ticks_us(), self._last)
        if wait > 0:
            board.sleep_us(wait)
        found = self._sensor.read_into(sample)
        self._countdown -= 1
        if self._countdown == 0:
            self._countdown = CHECK_EVERY
            if self._sensor.check() != READ:
                found = -1
        if found != READ:
            return -1
        now = board.ticks_us()
        dt = board.ticks_diff(now, self._last)
        self._last = now
        self._ahead += self._period - dt
        if self._ahead < -self._period or self._ahead > self._period:
            self._ahead = 0  # late is late: no burst of samples to catch up
        return dt
